"""CHOLMOD from cvxopt as a backend of fem.solvers.cholesky: one matrix, one thread.

A small factorisation shows, before the first large one, whether cvxopt's factor can be called and
read as it is done here. Where it cannot, CHOLMOD is reached by nothing but what cvxopt documents:
slower, and modes are counted front by front.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from importlib.metadata import version
from typing import Any

import numpy as np
from cvxopt import cholmod, spmatrix
from cvxopt import matrix as cvxopt_matrix
from scipy.sparse import csc_array, csr_array, diags_array, kron, kronsum

from fem.solvers.cholmod.library import library, solve_columns
from fem.solvers.cholmod.supernodes import (
    elimination_order,
    entry_count,
    factor_head,
    largest_supernodes,
    solve_paths,
)
from fem.solvers.factor import (
    NotPositiveDefiniteError,
    Symbolic,
    out_of_memory,
    refuse_lost_pivots,
    upper_triangle,
)
from fem.solvers.ordering import Elimination
from lumped.arrays import Array, IntArray, SparseMatrix

# Right-hand sides solved together: beyond some thirty the time per solve no longer falls.
_COLUMNS_AT_ONCE = 32
# Of a factor that is not read, roughly: its entries over n^(4/3), and bytes for each.
_ENTRIES, _BYTES_PER_ENTRY = 14.0, 30
# cvxopt's matrix, its packed copy and CHOLMOD's permuted one; row (8 bytes) and value of each.
_MATRIX_COPIES = 3
# Those whose factor has been read; another layout might crash the reader before it can be compared.
_READ = ("1.3.",)
_ROUNDING = 1e-12

# The order given is the one wanted: no second ordering is tried. CHOLMOD's options are global to
# the process, so they are set once, here.
cholmod.options["supernodal"] = 2
cholmod.options["nmethods"] = 1


def in_blocks(solve: Callable[[Array], Array], right_hand_sides: Array) -> Array:
    """One (n) or several (n×k) right-hand sides solved some at once, in the same shape."""
    columns = np.asfortranarray(right_hand_sides, dtype=np.float64)
    columns = columns.reshape(len(columns), -1, order="F")
    solution = np.empty(columns.shape, order="F")
    for start in range(0, columns.shape[1], _COLUMNS_AT_ONCE):
        some = slice(start, start + _COLUMNS_AT_ONCE)
        solution[:, some] = solve(columns[:, some])
    return solution.reshape(right_hand_sides.shape)


@dataclass(frozen=True, eq=False)
class PublicFactor:
    """Numeric factor of CHOLMOD by nothing but what cvxopt documents."""

    handle: Any = field(repr=False)

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        return in_blocks(self._solved, right_hand_sides)

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
        ordered = csc_array(columns[elimination_order(self.handle)])
        _, reduced = solve_paths(self.handle, ordered)
        return np.asarray(reduced.T @ reduced)


def peak_bytes(factor: Any, matrix_entries: int) -> int:
    """Memory at the height of the factorisation of a triangle with `matrix_entries`."""
    head = factor_head(factor)
    numbers: int = head.stored_entries + head.index_entries + head.update_entries
    return 8 * numbers + _MATRIX_COPIES * 16 * matrix_entries


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
    n, diagonal = triangle.shape[0], triangle.diagonal()
    # The analysed factor serves the first factorisation, later ones make their own.
    unused = [symbolic_factor(triangle, elimination.order)]
    if readable:
        peak = peak_bytes(unused[0][0], triangle.nnz)
    else:
        peak = int(_BYTES_PER_ENTRY * _ENTRIES * n ** (4.0 / 3.0))

    def numeric(part: str) -> PublicFactor:
        handle, matrix = unused.pop() if unused else symbolic_factor(triangle, elimination.order)
        # CHOLMOD's own order differs from the one given among branches of the elimination tree.
        order = elimination_order(handle) if readable else elimination.order
        try:
            cholmod.numeric(matrix, handle)
        except ArithmeticError as error:
            raise NotPositiveDefiniteError(part, int(order[error.args[0]])) from None
        except MemoryError:
            raise out_of_memory(part, n) from None
        pivots = np.array(cholmod.diag(handle)).ravel() ** 2
        # Where it is unknown of which unknown a pivot is, the least diagonal entry tells.
        of_pivots = diagonal[order] if readable else np.full(n, diagonal.min())
        refuse_lost_pivots(pivots, of_pivots, order, part)
        return (CholmodFactor if readable else PublicFactor)(handle)

    return Symbolic(n, elimination, peak, numeric)


@cache
def factors_are_readable() -> bool:
    """Whether cvxopt's factor is what is read here: its version, and a small one beside the public.

    Compared are its order, its count of entries, a solution and WᵀA⁻¹W.
    """
    if not (version("cvxopt").startswith(_READ) and library() is not None):
        return False
    matrix, order = _small()
    triangle = upper_triangle(matrix)
    handle, values = symbolic_factor(triangle, order)
    cholmod.numeric(values, handle)
    n = len(order)
    numbers = cvxopt_matrix(np.arange(float(n)))
    cholmod.solve(handle, numbers, sys=7)
    if not (
        factor_head(handle).n == n
        and np.array_equal(elimination_order(handle), np.array(numbers).ravel())
    ):
        return False
    columns = np.asfortranarray(np.random.default_rng(1).standard_normal((n, 3)))
    expected = PublicFactor(handle).solve(columns)
    read = CholmodFactor(handle)
    solution, gram = read.solve(columns), read.gram(csr_array(columns))
    # Last: cvxopt turns the factor into one without supernodes to hand out its entries.
    entries, blocks = entry_count(handle), factor_head(handle).stored_entries
    return (
        _equal(solution, expected)
        and _equal(gram, columns.T @ expected)
        # Supernodes store some zeros, and their blocks half of a square for nothing.
        and entries <= len(cholmod.getfactor(handle)) <= blocks
    )


def _equal(read: Array, expected: Array) -> bool:
    size = np.abs(expected).max()
    return read.shape == expected.shape and bool(np.abs(read - expected).max() < _ROUNDING * size)


def _small() -> tuple[Any, IntArray]:
    """A grid of springs, 12 × 12 nodes of three unknowns, and an order of elimination."""
    line = diags_array([-1.0, 2.5, -1.0], offsets=[-1, 0, 1], shape=(12, 12))
    coupled = np.array([[3.0, 0.5, 0.0], [0.5, 4.0, 0.2], [0.0, 0.2, 5.0]])
    return csr_array(kron(kronsum(line, line), coupled)), np.random.default_rng(2).permutation(432)
