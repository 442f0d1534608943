"""Lumped models of the bodies of any mechanism, and the virtual joint method on serial chains.

Input: a mechanism. Output: stiffness and mass of its bodies for the assembly, or the compliance of
the robot from its chains.
"""
