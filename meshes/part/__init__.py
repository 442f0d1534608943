"""Parts from CAD files and meshes: faces, interfaces, and a sequence of refined meshes.

Input: STEP, BREP and mesh files. Output: faces from which interfaces are selected, and volume
meshes with these faces.
"""
