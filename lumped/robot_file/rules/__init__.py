"""Table of rules for robot files, and everything that is derived from it.

Input: values as read from TOML. Output: faults, values as models need them, a JSON schema, and
lists of keys.
"""
