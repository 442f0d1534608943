"""The one table of what a robot file may contain, and everything that is made from it.

In: values as read from TOML. Out: faults, the values as models need them, a JSON schema, lists of
keys.
"""
