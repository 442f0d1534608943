"""Couplings between the nodes of a solid and the six components of an interface.

Input: faces of meshes. Output: matrices between nodal displacements and twists, and their
transposes for wrenches.
"""
