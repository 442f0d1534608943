"""Maps of stiffness, frequency and model error over the workspace, with the worst posture of each.

Input: a robot whose path is a grid in two or three directions. Output: values at the grid points,
and the worst posture, which is also searched between grid points.
"""
