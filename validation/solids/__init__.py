"""Solid legs in a run: choice of meshes, and uncertainty of their results.

In: legs. Out: compliances, modes and energies of solids with their discretisation uncertainty.
"""
