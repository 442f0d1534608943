"""Joints as in catalogues of machine elements: stiffness and damping along named directions.

`directions` contains the names of the directions of each kind of joint, and converts values along
them to matrices.
"""
