"""Meshes of cross-sections, prismatic legs and CAD parts, made by gmsh, as numpy arrays."""
