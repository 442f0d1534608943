"""Variations of one number of the robot file, for all models: curves and design decisions.

Input: a robot file and values of one of its numbers. Output: curves of deflection and frequency
over the number, and the design that each model would choose. The computation runs on this machine
or on a cluster.
"""
