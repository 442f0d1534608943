"""CHOLMOD from cvxopt as a backend of fem.solvers.cholesky: one matrix, one thread."""

from collections import deque
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from cvxopt import cholmod, spmatrix
from cvxopt import matrix as cvxopt_matrix
from scipy.sparse import csc_array, csr_array

from fem.solvers.cholmod.library import solve_columns
from fem.solvers.cholmod.supernodes import (
    FactorStatistics,
    elimination_order,
    largest_supernodes,
    solve_paths,
    statistics,
)
from fem.solvers.factor import NotPositiveDefiniteError, Symbolic, out_of_memory, refuse_lost_pivots
from fem.solvers.ordering import Elimination
from lumped.arrays import Array, IntArray, SparseMatrix

# Right-hand sides solved together: beyond some thirty the time per solve no longer falls.
COLUMNS_AT_ONCE = 32
# Of a factor that is not read, roughly: its entries over n^(4/3), and bytes for each.
_ENTRIES, _BYTES_PER_ENTRY = 14.0, 30
# cvxopt's matrix, its packed copy and CHOLMOD's permuted one; row (8 bytes) and value of each.
_MATRIX_COPIES = 3

# The order given is the one wanted: no second ordering is tried. CHOLMOD's options are global to
# the process, so they are set once, here.
cholmod.options["supernodal"] = 2
cholmod.options["nmethods"] = 1


@dataclass(frozen=True, eq=False)
class PublicFactor:
    """Numeric factor of CHOLMOD by nothing but what cvxopt documents."""

    size: int
    handle: Any = field(repr=False)

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        columns = np.asfortranarray(right_hand_sides, dtype=np.float64).reshape(
            self.size, -1, order="F"
        )
        blocks = [
            self._solved(columns[:, start : start + COLUMNS_AT_ONCE])
            for start in range(0, columns.shape[1], COLUMNS_AT_ONCE)
        ]
        if not blocks:
            return np.zeros_like(right_hand_sides, dtype=np.float64)
        return np.hstack(blocks).reshape(right_hand_sides.shape)

    def _solved(self, columns: Array) -> Array:
        solution = cvxopt_matrix(columns)
        cholmod.solve(self.handle, solution)
        return np.array(solution)


@dataclass(frozen=True, eq=False)
class CholmodFactor(PublicFactor):
    """The same of a layout that is read: it solves faster and shows its separators."""

    def _solved(self, columns: Array) -> Array:
        return solve_columns(self.handle, columns)

    def separators(self, count: int) -> list[IntArray]:
        """Unknowns of the `count` largest supernodes, the largest first."""
        return largest_supernodes(self.handle, count)

    def gram(self, columns: SparseMatrix) -> Array:
        """WᵀA⁻¹W (k×k) of `columns` W (csr n×k): see fem.solvers.factor."""
        reduced = solve_paths(
            self.handle, csc_array(columns[elimination_order(self.handle)])
        ).values
        return np.asarray(reduced.T @ reduced)


def peak_bytes(counts: FactorStatistics, matrix_entries: int) -> int:
    """Memory at the height of a factorisation of a triangle with `matrix_entries`."""
    factor = counts.stored_entries + counts.index_entries + counts.update_entries
    return 8 * factor + _MATRIX_COPIES * 16 * matrix_entries


def symbolic_factor(triangle: SparseMatrix, order: IntArray) -> tuple[Any, Any]:
    """CHOLMOD's analysed factor of an upper `triangle` (csr), and the matrix as cvxopt has it."""
    n = triangle.shape[0]
    # Read by columns the triangle is the lower one.
    column_of = np.repeat(np.arange(n, dtype=np.int64), np.diff(triangle.indptr))
    matrix = spmatrix(
        cvxopt_matrix(np.ascontiguousarray(triangle.data)),
        cvxopt_matrix(triangle.indices.astype(np.int64)),
        cvxopt_matrix(column_of),
        (n, n),
    )
    return cholmod.symbolic(matrix, cvxopt_matrix(order)), matrix


def analyse(triangle: SparseMatrix, elimination: Elimination, *, readable: bool = True) -> Symbolic:
    """Analyse an upper `triangle` (csr) for its elimination as a whole.

    `readable`: whether cvxopt's factor is laid out as `fem.solvers.cholmod.supernodes` reads it.
    """
    n = triangle.shape[0]
    handle, matrix = symbolic_factor(triangle, elimination.order)
    # The analysed factor serves the first factorisation, later ones make their own.
    unused = deque([(handle, matrix)])
    if readable:
        peak = peak_bytes(statistics(handle), triangle.nnz)
    else:
        peak = int(_BYTES_PER_ENTRY * _ENTRIES * n ** (4.0 / 3.0))
    pointers, columns = triangle.indptr, triangle.indices

    def numeric(values: Array, part: str) -> PublicFactor:
        whole = csr_array((values, columns, pointers), shape=(n, n))
        if unused:
            handle, matrix = unused.pop()
            matrix.V = cvxopt_matrix(np.ascontiguousarray(values))
        else:
            handle, matrix = symbolic_factor(whole, elimination.order)
        # CHOLMOD's own order differs from the one given among branches of the elimination tree.
        order = elimination_order(handle) if readable else elimination.order
        try:
            cholmod.numeric(matrix, handle)
        except ArithmeticError as error:
            raise NotPositiveDefiniteError(part, int(order[error.args[0]])) from None
        except MemoryError:
            raise out_of_memory(part, n) from None
        pivots = np.array(cholmod.diag(handle)).ravel() ** 2
        diagonal = whole.diagonal()
        # Where it is unknown of which unknown a pivot is, the least diagonal entry tells.
        of_pivots = diagonal[order] if readable else np.full(n, diagonal.min())
        refuse_lost_pivots(pivots, of_pivots, order, part)
        return (CholmodFactor if readable else PublicFactor)(n, handle)

    return Symbolic(
        backend="cholmod",
        size=n,
        pointers=pointers,
        columns=columns,
        elimination=elimination,
        peak_bytes=peak,
        numeric=numeric,
    )
