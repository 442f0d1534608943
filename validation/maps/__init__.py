"""Maps over a workspace: values on the grid of a path, and worst postures between grid points.

In: a robot whose path is a grid in two or three directions. Out: maps, each with its worst posture.
"""
