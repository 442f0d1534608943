"""Sparse factorisations, searches for modes, and counts that prove none is missing.

In: symmetric matrices as arrays. Out: solutions, modes, numbers of eigenvalues; nothing of bodies.
"""
