"""Kinematics of any mechanism: loop closure, mobility, idle motions and overconstraint.

Input: a mechanism and poses of its tool. Output: postures with closed loops, and their mobility.
"""
