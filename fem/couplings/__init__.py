"""Couplings of the nodes of a solid with the six components of an interface.

In: faces of meshes. Out: matrices between nodes and twists, and their transposes for wrenches.
"""
