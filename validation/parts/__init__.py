"""CAD parts: faces, meshes, and identification of stiffness and mass on their interfaces.

Input: STEP, BREP or mesh files. Output: lists and pictures of faces, identified matrices with
uncertainties as text, JSON and arrays, and TOML tables for robot files.
"""
