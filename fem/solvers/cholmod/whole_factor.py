"""CHOLMOD from cvxopt as a backend of fem.solvers.cholesky: one matrix, one thread."""

from collections import deque
from dataclasses import dataclass, field
from functools import partial
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
# cvxopt's matrix, its packed copy and CHOLMOD's permuted one; row (8 bytes) and value of each.
_MATRIX_COPIES = 3

# The order given is the one wanted: no second ordering is tried. CHOLMOD's options are global to
# the process, so they are set once, here.
cholmod.options["supernodal"] = 2
cholmod.options["nmethods"] = 1


@dataclass(frozen=True, eq=False)
class CholmodFactor:
    """Numeric factor of CHOLMOD."""

    size: int
    handle: Any = field(repr=False)

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        columns = np.asfortranarray(right_hand_sides, dtype=np.float64).reshape(
            self.size, -1, order="F"
        )
        blocks = [
            solve_columns(self.handle, columns[:, start : start + COLUMNS_AT_ONCE])
            for start in range(0, columns.shape[1], COLUMNS_AT_ONCE)
        ]
        if not blocks:
            return np.zeros_like(right_hand_sides, dtype=np.float64)
        return np.hstack(blocks).reshape(right_hand_sides.shape)

    def separators(self, count: int) -> list[IntArray]:
        """Unknowns of the `count` largest supernodes, the largest first."""
        return largest_supernodes(self.handle, count)

    def gram(self, columns: SparseMatrix) -> Array:
        """WᵀA⁻¹W (k×k) of `columns` W (csr n×k): see fem.solvers.factor."""
        reduced = solve_paths(
            self.handle, csc_array(columns[elimination_order(self.handle)])
        ).values
        return np.asarray(reduced.T @ reduced)

    def renewed(self, triangle: SparseMatrix, part: str) -> "CholmodFactor":
        """The factor of another matrix in the memory of this one: see fem.solvers.factor."""
        matrix = _cvxopt_matrix(triangle.indptr, triangle.indices, triangle.data)
        return _eliminated(self.handle, matrix, triangle.diagonal(), part)


def peak_bytes(counts: FactorStatistics, matrix_entries: int) -> int:
    """Memory at the height of a factorisation of a triangle with `matrix_entries`."""
    factor = counts.stored_entries + counts.index_entries + counts.update_entries
    return 8 * factor + _MATRIX_COPIES * 16 * matrix_entries


def symbolic_factor(triangle: SparseMatrix, order: IntArray) -> tuple[Any, Any]:
    """CHOLMOD's analysed factor of an upper `triangle` (csr), and the matrix as cvxopt has it."""
    matrix = _cvxopt_matrix(triangle.indptr, triangle.indices, triangle.data)
    return cholmod.symbolic(matrix, cvxopt_matrix(order)), matrix


def _cvxopt_matrix(pointers: IntArray, columns: IntArray, values: Array) -> Any:
    """Cvxopt's matrix whose lower triangle is the transpose of the given upper one."""
    n = len(pointers) - 1
    column_of = np.repeat(np.arange(n, dtype=np.int64), np.diff(pointers))
    return spmatrix(
        cvxopt_matrix(np.ascontiguousarray(values)),
        cvxopt_matrix(columns.astype(np.int64)),
        cvxopt_matrix(column_of),
        (n, n),
    )


def analyse(triangle: SparseMatrix, elimination: Elimination) -> Symbolic:
    """Analyse an upper `triangle` (csr) for its elimination as a whole."""
    handle, matrix = symbolic_factor(triangle, elimination.order)
    counts = statistics(handle)
    pointers, columns = triangle.indptr, triangle.indices
    # The analysed factor serves the first factorisation, later ones make their own.
    unused = deque([(handle, matrix)])
    return Symbolic(
        backend="cholmod",
        size=triangle.shape[0],
        pointers=pointers,
        columns=columns,
        elimination=elimination,
        peak_bytes=peak_bytes(counts, triangle.nnz),
        numeric=partial(_numeric, pointers, columns, elimination.order, unused),
    )


def _numeric(
    pointers: IntArray,
    columns: IntArray,
    order: IntArray,
    unused: deque[tuple[Any, Any]],
    values: Array,
    part: str,
) -> CholmodFactor:
    n = len(pointers) - 1
    triangle = csr_array((values, columns, pointers), shape=(n, n))
    try:
        handle, matrix = unused.pop()
    except IndexError:
        handle, matrix = symbolic_factor(triangle, order)
    else:
        matrix.V = cvxopt_matrix(np.ascontiguousarray(values))
    return _eliminated(handle, matrix, triangle.diagonal(), part)


def _eliminated(handle: Any, matrix: Any, diagonal: Array, part: str) -> CholmodFactor:
    n = len(diagonal)
    try:
        cholmod.numeric(matrix, handle)
    except ArithmeticError as error:
        unknown = int(elimination_order(handle)[error.args[0]])
        raise NotPositiveDefiniteError(part, unknown) from None
    except MemoryError:
        raise out_of_memory(part, n) from None
    eliminated = elimination_order(handle)
    pivots = np.array(cholmod.diag(handle)).ravel() ** 2
    refuse_lost_pivots(pivots, diagonal[eliminated], eliminated, part)
    return CholmodFactor(n, handle)
