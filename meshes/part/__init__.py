"""Parts from CAD files and meshes: their faces, the interfaces among them, a ladder of meshes.

In: STEP, BREP and mesh files. Out: faces to pick from, and volume meshes that know their faces.
"""
