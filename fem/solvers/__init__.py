"""Sparse factorisations, searches for modes, and counts that prove none is missing.

Four verbs: `analyse` a pattern, `factorise` values on it, `solve` (cholesky), count what lies below
a shift (certificate.count). In: symmetric matrices as arrays. Out: solutions, modes, numbers of
eigenvalues; nothing of bodies.
"""
