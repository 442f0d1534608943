"""Meshes of cross-sections.

Input: shapes and numbers of divisions. Output: plane meshes with the symmetry of the shape.
"""
