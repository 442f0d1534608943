"""Solid models of one body, a prismatic leg or a part: statics, and modes of which none is missing.

Input: legs and meshes. Output: compliances, modes, matrices on the interfaces.
"""
