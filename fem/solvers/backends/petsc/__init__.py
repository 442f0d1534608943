"""MUMPS through PETSc, in separate processes.

Input: the lower triangle of a symmetric matrix. Output: factor, signs of eigenvalues, solutions.
`client` is the module that the calling program uses. `server` and `keeper` run as processes
separate from the caller: `server` calls MUMPS, with a Python that has PETSc, and `keeper` ends the
server when the client has ended.
"""
