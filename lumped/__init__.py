"""Lumped models of parallel robots, and the robot data from which all models are built.

Lumped models consist of rigid bodies, springs and beams, without meshes: the virtual joint method,
matrix structural analysis and rigid segments.
"""
