"""`run --vary`: all models of robots that differ from the run's in one number of their file.

In: a robot file and ranges of its numbers. Out: curves, computed here or on a cluster.
"""
