"""Tables of robot files: each key with its rule and its meaning, and the record that is read.

A dataclass named …Entry declares a table: each field is a key, annotated with its rule and meaning.
Tables whose record exists elsewhere list their keys instead.
"""
