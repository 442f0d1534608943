"""Parts from CAD files and meshes: faces, interfaces, and a sequence of refined meshes.

In: STEP, BREP and mesh files. Out: faces for selection, and volume meshes with these faces.
"""
