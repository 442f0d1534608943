"""What the backends of fem.solvers.cholesky have in common: analysed patterns, factors, errors."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol, runtime_checkable

import numpy as np
from scipy.sparse import csr_array, diags_array

from fem.machine import available_memory
from fem.solvers.ordering import Elimination
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.errors import ComputationError

# A pivot that lost this part of its diagonal entry is rounding error: the matrix is singular.
_SINGULAR_PIVOT = 100.0 * np.finfo(np.float64).eps


class NotPositiveDefiniteError(ComputationError):
    """A Cholesky factorisation met a pivot that is not positive; `unknown` is its number."""

    def __init__(self, part: str, unknown: int) -> None:
        self.unknown = unknown
        super().__init__(
            f"{part}: the matrix is not positive definite at unknown {unknown} (a part free to "
            "move as a rigid body, a negative material constant, stiffnesses that differ by more "
            "than rounding allows, or a shift above the first eigenvalue)"
        )


def out_of_memory(part: str, unknowns: int) -> ComputationError:
    """The error of a factorisation that was refused memory although it had been foretold."""
    return ComputationError(f"{part}: memory ran out in the factorisation of {unknowns} unknowns")


class Factor(Protocol):
    """A factorised symmetric positive definite matrix."""

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        ...


@runtime_checkable
class SeparatedFactor(Factor, Protocol):
    """A factor A = L Lᵀ that shows its separators."""

    def separators(self, count: int) -> list[IntArray]:
        """Unknowns of the `count` largest separators, the largest first."""
        ...

    def gram(self, columns: SparseMatrix) -> Array:
        """WᵀA⁻¹W (k×k) of `columns` W (csr n×k).

        Little of L is read where W has entries on large separators only.
        """
        ...


@dataclass(frozen=True, eq=False)
class Symbolic:
    """An analysed symmetric matrix, with what its factor will cost.

    `peak_bytes`: the memory that the factorisation takes at its height. `elimination` is None for
    backends that keep their own. `numeric` factorises the matrix; its argument names it in errors.
    """

    size: int
    elimination: Elimination | None
    peak_bytes: int
    numeric: Callable[[str], Factor] = field(repr=False)

    def factorise(self, part: str = "stiffness matrix") -> Factor:
        """The factor of the matrix, which errors call `part`.

        Raises NotPositiveDefiniteError, a ComputationError, where a pivot is not positive or is
        lost in rounding, and ComputationError, before it starts, where memory will not suffice.
        """
        available = available_memory()
        if available is not None and self.peak_bytes > available:
            raise ComputationError(
                f"{part}: factorising {self.size} unknowns needs about "
                f"{self.peak_bytes / 1e9:.1f} GB and {available / 1e9:.1f} GB are available: use "
                "fewer divisions, a shorter leg, or condensation by doubling (statics)"
            )
        return self.numeric(part)


def upper_triangle(matrix: SparseMatrix) -> SparseMatrix:
    """Upper triangle of a symmetric matrix (csr, sorted columns, explicit zeros kept).

    Read by columns, the same three arrays are the lower triangle.
    """
    matrix = csr_array(matrix)
    if not matrix.has_canonical_format:
        matrix = matrix.copy()
        matrix.sum_duplicates()
    n = matrix.shape[0]
    rows = np.repeat(np.arange(n, dtype=matrix.indices.dtype), np.diff(matrix.indptr))
    upper = matrix.indices >= rows
    if upper.all():
        return matrix.astype(np.float64, copy=False)
    pointers = np.concatenate([[0], np.cumsum(np.bincount(rows[upper], minlength=n))])
    triangle = csr_array(
        (
            matrix.data[upper].astype(np.float64, copy=False),
            matrix.indices[upper],
            pointers.astype(matrix.indptr.dtype),
        ),
        shape=(n, n),
    )
    triangle.has_canonical_format = True
    return triangle


def whole_matrix(triangle: SparseMatrix) -> SparseMatrix:
    """The symmetric matrix (csr n×n) of an upper triangle."""
    return csr_array(triangle + triangle.T - diags_array(triangle.diagonal(), format="csr"))


def refuse_lost_pivots(pivots: Array, diagonal: Array, unknowns: IntArray, part: str) -> None:
    """Raise NotPositiveDefiniteError where a pivot (m) is rounding error of its diagonal entry.

    `unknowns` (m): to which the pivots belong.
    """
    shares = pivots / diagonal
    smallest = int(np.argmin(shares))
    if shares[smallest] < _SINGULAR_PIVOT:
        raise NotPositiveDefiniteError(part, int(unknowns[smallest]))
