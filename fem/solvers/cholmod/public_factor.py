"""CHOLMOD by nothing but what cvxopt documents: slower, and its factor shows no separators.

It is used where cvxopt's factor is not laid out as `fem.solvers.cholmod.supernodes` reads it, which
a small factorisation shows before the first large one. Modes are then counted front by front.
"""

from dataclasses import dataclass, field
from functools import cache, partial
from importlib.metadata import version
from typing import Any

import numpy as np
from cvxopt import cholmod
from cvxopt import matrix as cvxopt_matrix
from scipy.sparse import csr_array, diags_array, kron

from fem.solvers.cholmod import library, supernodes, whole_factor
from fem.solvers.factor import NotPositiveDefiniteError, Symbolic, out_of_memory, upper_triangle
from fem.solvers.ordering import Elimination
from lumped.arrays import Array, IntArray

# Those whose factor has been read; another layout might crash the reader before it can be compared.
_READ = ("1.3.",)
_ROUNDING = 1e-12
# Rough: entries of the factor over n^(4/3) (see validation.solve.cost).
_ENTRIES, _BYTES_PER_ENTRY = 14.0, 30
_SINGULAR_PIVOT = 100.0 * np.finfo(np.float64).eps


@dataclass(frozen=True, eq=False)
class PublicFactor:
    """Numeric factor of CHOLMOD that solves and shows nothing else."""

    size: int
    handle: Any = field(repr=False)

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        if not right_hand_sides.size:
            return np.zeros_like(right_hand_sides, dtype=np.float64)
        columns = np.asarray(right_hand_sides, dtype=np.float64).reshape(self.size, -1)
        solution = cvxopt_matrix(np.asfortranarray(columns))
        cholmod.solve(self.handle, solution)
        return np.array(solution).reshape(right_hand_sides.shape)


def analyse(pointers: IntArray, columns: IntArray, elimination: Elimination) -> Symbolic:
    """An upper triangle's pattern with what its factor will cost, roughly."""
    n = len(pointers) - 1
    entries = _ENTRIES * n ** (4.0 / 3.0)
    return Symbolic(
        backend="cholmod",
        size=n,
        pointers=pointers,
        columns=columns,
        elimination=elimination,
        peak_bytes=int(_BYTES_PER_ENTRY * entries),
        numeric=partial(_numeric, pointers, columns, elimination.order),
    )


def _numeric(
    pointers: IntArray, columns: IntArray, order: IntArray, values: Array, part: str
) -> PublicFactor:
    n = len(pointers) - 1
    triangle = csr_array((values, columns, pointers), shape=(n, n))
    handle, matrix = whole_factor.symbolic_factor(triangle, order)
    try:
        cholmod.numeric(matrix, handle)
    except ArithmeticError as error:
        # CHOLMOD's own order differs from the one given among branches of the elimination tree.
        raise NotPositiveDefiniteError(part, int(order[error.args[0]])) from None
    except MemoryError:
        raise out_of_memory(part, n) from None
    pivots = np.array(cholmod.diag(handle)).ravel() ** 2
    lost = int(np.argmin(pivots))
    # Of which unknown a pivot is stays unknown, so that only all diagonal entries can be asked.
    if pivots[lost] < _SINGULAR_PIVOT * triangle.diagonal().min():
        raise NotPositiveDefiniteError(part, int(order[lost]))
    return PublicFactor(n, handle)


@cache
def factors_are_readable() -> bool:
    """Whether cvxopt's factor is what is read here: its version, and a small one beside the public.

    Compared are its order, its count of entries, a solution and WᵀA⁻¹W.
    """
    if not version("cvxopt").startswith(_READ):
        return False
    matrix, order = _small()
    triangle = upper_triangle(matrix)
    handle, values = whole_factor.symbolic_factor(triangle, order)
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
    solution = library.solve_columns(handle, columns)
    gram = whole_factor.CholmodFactor(n, handle).gram(csr_array(columns))
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
