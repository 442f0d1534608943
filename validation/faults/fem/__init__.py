"""Mistakes in finite elements: beams, meshes and solids, couplings of ends, reductions.

Each is a function under the place where it is put in; the catalogue gathers them.
"""
