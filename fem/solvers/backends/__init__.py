"""Libraries for sparse factorisation, one module each, and the choice between them.

Input: the lower triangle of a symmetric matrix. Output: order of elimination, factor, signs of
eigenvalues, solutions. `rslab` computes on the processor, `cudss` on a graphics card, `petsc` in
processes outside this environment. `superlu` is used if rslab cannot be loaded.
"""
