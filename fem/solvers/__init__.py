"""Sparse factorisations, searches for modes, and counts that prove none is missing.

Four verbs: `analyse` a matrix, `factorise` it, `solve` (factor), count what lies below a shift
(certificate). In: symmetric matrices as arrays. Out: solutions, modes, numbers of eigenvalues.
"""
