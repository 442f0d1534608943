"""MUMPS through PETSc, in separate processes.

Input: the lower triangle of a symmetric matrix. Output: factor, signs of eigenvalues, solutions.
`client` belongs to this program. `keeper` and `server` are programs: the server runs outside this
environment, and the keeper ends it when the client is gone.
"""
