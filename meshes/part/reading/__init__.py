"""Files of parts: CAD through gmsh's kernel, volume meshes through meshio, units of length.

In: a path. Out: faces in metres, and a mesh if the file contains one.
"""
