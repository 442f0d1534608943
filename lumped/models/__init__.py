"""Lumped models of the bodies of any mechanism, and chains of them.

In: a mechanism. Out: models of its bodies for the assembly, or the robot's compliance by chains.
"""
