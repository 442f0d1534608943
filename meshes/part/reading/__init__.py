"""Files of parts: CAD files through gmsh's kernel, mesh files through meshio, units of length.

Input: a path. Output: faces in metres, and a mesh if the file contains one.
"""
