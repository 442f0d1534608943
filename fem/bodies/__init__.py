"""Solid models of one body: prisms and parts, their statics and certified modes.

In: legs and meshes. Out: compliances, modes, matrices on the interfaces.
"""
