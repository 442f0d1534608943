"""`solve --vary`: one model of many robots that differ in some numbers of their file.

In: a robot file and ranges of numbers by their keys. Out: a table of deflections and frequencies.
"""
