"""Tables of robot files: each key with its rule and its meaning, and the record that is read.

A dataclass named …Entry declares a table and is the record into which the table is read. Each field
is a key, annotated with its rule and meaning. For tables that are read into records of other
modules, the keys are listed one by one.
"""
