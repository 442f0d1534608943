"""Which comparisons rest on two sides that share nothing but the robot's data and named basics.

In: cases. Out: what both sides of each rest on, heard at run time, by the number that they compare.
"""
