"""Kinematics of any mechanism: loops closed, mobility, what idles and what is held twice.

In: a mechanism and poses of its tool. Out: postures, which nobody else makes.
"""
