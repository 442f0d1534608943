"""MUMPS through PETSc, in processes of their own.

In: the lower triangle of a symmetric matrix. Out: its factor, signs, solutions. `client` belongs to
this program. `keeper` and `server` are programs: the server runs outside this environment, the
keeper ends it when the client is gone.
"""
