"""Solid meshes of constant section.

In: section meshes and lengths. Out: hexahedra and tetrahedra with their end faces.
"""
