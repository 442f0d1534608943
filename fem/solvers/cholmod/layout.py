"""Whether cvxopt's factor can be called and read as `fem.solvers.cholmod` does it.

A small factorisation shows it before the first large one. Where it is not, CHOLMOD is reached by
nothing but what cvxopt documents: slower, and modes are counted front by front.
"""

from functools import cache
from importlib.metadata import version
from typing import Any

import numpy as np
from cvxopt import cholmod
from cvxopt import matrix as cvxopt_matrix
from scipy.sparse import csr_array, diags_array, kron

from fem.solvers.cholmod import supernodes
from fem.solvers.cholmod.library import symbols_are_found
from fem.solvers.cholmod.whole_factor import CholmodFactor, PublicFactor, symbolic_factor
from fem.solvers.factor import upper_triangle
from lumped.arrays import Array, IntArray

# Those whose factor has been read; another layout might crash the reader before it can be compared.
_READ = ("1.3.",)
_ROUNDING = 1e-12


@cache
def factors_are_readable() -> bool:
    """Whether cvxopt's factor is what is read here: its version, and a small one beside the public.

    Compared are its order, its count of entries, a solution and WᵀA⁻¹W.
    """
    if not (version("cvxopt").startswith(_READ) and symbols_are_found()):
        return False
    matrix, order = _small()
    triangle = upper_triangle(matrix)
    handle, values = symbolic_factor(triangle, order)
    cholmod.numeric(values, handle)
    n = len(order)
    numbers = cvxopt_matrix(np.arange(float(n)))
    cholmod.solve(handle, numbers, sys=7)
    if not (
        supernodes.factor_head(handle).n == n
        and np.array_equal(supernodes.elimination_order(handle), np.array(numbers).ravel())
    ):
        return False
    columns = np.asfortranarray(np.random.default_rng(1).standard_normal((n, 3)))
    expected = PublicFactor(n, handle).solve(columns)
    read = CholmodFactor(n, handle)
    solution, gram = read.solve(columns), read.gram(csr_array(columns))
    # Last: cvxopt turns the factor into one without supernodes to hand out its entries.
    counts, stored = supernodes.statistics(handle), len(cholmod.getfactor(handle))
    return (
        _equal(solution, expected)
        and _equal(gram, columns.T @ expected)
        # Supernodes store some zeros, and their blocks half of a square for nothing.
        and counts.entries <= stored <= counts.stored_entries
    )


def _equal(read: Array, expected: Array) -> bool:
    size = np.abs(expected).max()
    return read.shape == expected.shape and bool(np.abs(read - expected).max() < _ROUNDING * size)


def _small() -> tuple[Any, IntArray]:
    """A grid of springs, 12 × 12 nodes of three unknowns, and an order of elimination."""
    line = diags_array([-1.0, 2.5, -1.0], offsets=[-1, 0, 1], shape=(12, 12))
    one = diags_array(np.ones(12))
    plane = kron(line, one) + kron(one, line)
    coupled = np.array([[3.0, 0.5, 0.0], [0.5, 4.0, 0.2], [0.0, 0.2, 5.0]])
    return csr_array(kron(plane, coupled)), np.random.default_rng(2).permutation(432)
