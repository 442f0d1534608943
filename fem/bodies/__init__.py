"""Solid models of one body, a prismatic leg or a part: statics and certified modes.

Input: legs and meshes. Output: compliances, modes, matrices on the interfaces.
"""
