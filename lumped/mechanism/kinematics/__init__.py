"""Kinematics of any mechanism: loop closure, mobility, idle motions and overconstraint.

In: a mechanism and poses of its tool. Out: postures, which only this package creates.
"""
