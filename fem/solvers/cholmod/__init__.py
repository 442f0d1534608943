"""CHOLMOD from cvxopt, whole or in two halves on two cores, and what its factors hold.

In: analysed patterns and upper triangles. Out: factors as `fem.solvers.factor` describes them.
"""
