"""Models of one body: beams, prisms as solids, their statics and certified modes.

In: legs and meshes. Out: compliances, modes, matrices on the interfaces.
"""
