"""CHOLMOD from cvxopt, whole or in two halves on two cores, and what its factors hold.

In: analysed patterns and upper triangles. Out: factors as `fem.solvers.factor` describes them.
"""

from fem.solvers.cholmod.kernel import naming_the_kernel

with naming_the_kernel():
    import cvxopt.cholmod  # noqa: F401  loads OpenBLAS, whoever asks for it later
