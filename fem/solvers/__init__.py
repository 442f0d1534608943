"""Sparse factorisations, searches for modes, and counts that prove that no mode is missing.

Input: symmetric matrices as arrays. Output: solutions, modes, numbers of eigenvalues. The steps
are: `analyse` the sparsity pattern of a matrix, `factorise` the matrix, `solve` with the factor,
and count the eigenvalues below a shift (certificate).
"""
