"""How nodes of a solid move with an interface of six components, and take its loads.

In: faces of meshes. Out: matrices between nodes and twists, and their transposes for wrenches.
"""
