"""Table of rules for robot files, and everything that is derived from it.

In: values as read from TOML. Out: faults, the values as models need them, a JSON schema, lists of
keys.
"""
