"""Meshes of cross-sections and of legs: gmsh in, numpy arrays out."""
