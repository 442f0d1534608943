"""Meshes of cross-sections.

In: shapes and divisions. Out: plane meshes with the symmetry of the shape.
"""
