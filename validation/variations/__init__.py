"""Parameter variations: all models over the values of one number of the robot file.

In: a robot file and ranges of its numbers. Out: curves and decisions, computed on this machine or
on a cluster.
"""
