"""Inertia of a symmetric indefinite matrix: how many eigenvalues of K x = λ M x lie below σ.

By Sylvester's law the signs of the pivots of K − σM are those of its eigenvalues. The matrix is
eliminated front by front along a nested dissection of its graph (the multifrontal method of Duff
and Reid). A front is a dense matrix, pivoted by Bunch and Kaufman where it is not positive
definite; its pivots are counted and nothing of the factor is kept.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.linalg import (
    LinAlgError,
    cholesky,
    eigvalsh_tridiagonal,
    ldl,
    solve_banded,
    solve_triangular,
)
from scipy.linalg.blas import dsyrk
from scipy.sparse import block_array, csr_array

from fem.solvers.cholesky import backend
from fem.solvers.factor import upper_triangle, whole_matrix
from fem.solvers.ordering import BlockGraph, block_graph, separate
from lumped.arrays import Array, IntArray, SparseMatrix

# Blocks below which a part is one dense front: smaller fronts cost more in calls than in flops.
_LEAF_BLOCKS = 100
# A pivot below this part of the front's largest is rounding error: it has no sign.
_ZERO_PIVOT = 100.0 * np.finfo(np.float64).eps


class Inertia(NamedTuple):
    """Numbers of negative, zero (to rounding) and positive eigenvalues."""

    negative: int
    zero: int
    positive: int


@dataclass(frozen=True, eq=False)
class Front:
    """A separator or an undivided part: its `unknowns`, eliminated after those of its children."""

    unknowns: IntArray
    children: tuple[int, ...]


def dissect(graph: BlockGraph) -> list[Front]:
    """Fronts of a recursive bisection of the graph, in order of elimination (children first)."""
    fronts: list[Front] = []

    def add(couplings: SparseMatrix, blocks: IntArray) -> int:
        """Append the fronts of a part and return the number of its last."""
        children: tuple[int, ...] = ()
        if len(blocks) > _LEAF_BLOCKS and couplings.nnz:
            first, second, between = separate(couplings)
            children = tuple(
                add(couplings[half][:, half].tocsr(), blocks[half])
                for half in (first, second)
                if len(half)
            )
            blocks = blocks[between]
        fronts.append(Front(graph.unknowns(blocks), children))
        return len(fronts) - 1

    add(graph.couplings, np.arange(len(graph.sizes)))
    return fronts


def _signs(pivots: Array, couplings: Array) -> Inertia:
    """Inertia of the block-diagonal D of an LDLᵀ, its 2×2 blocks marked by `couplings`."""
    values = eigvalsh_tridiagonal(pivots, couplings, check_finite=False)
    least = _ZERO_PIVOT * np.abs(values).max()
    negative, positive = int((values < -least).sum()), int((values > least).sum())
    return Inertia(negative, len(values) - negative - positive, positive)


def _gram(columns: Array) -> Array:
    """AᵀA by scipy's BLAS alone: numpy's has threads of its own, which would wait beside them."""
    if not columns.size:
        return np.zeros((columns.shape[1], columns.shape[1]))
    half = dsyrk(1.0, columns, trans=1, lower=1)
    return np.asarray(half + np.tril(half, -1).T)


def _eliminate(own: Array, border: Array) -> tuple[Inertia, Array]:
    """Inertia of a pivot block F_II (p×p) and F_BI F_II⁻¹ F_IB (q×q) of its `border` F_IB (p×q)."""
    try:
        lower = cholesky(own, lower=True, check_finite=False)
    except LinAlgError:
        pass
    else:
        reduced = solve_triangular(lower, border, lower=True, check_finite=False)
        return Inertia(0, 0, len(own)), _gram(reduced)
    lower, pivots, order = ldl(own, lower=True, check_finite=False)
    diagonal, couplings = np.diag(pivots), np.diag(pivots, 1)
    inertia = _signs(diagonal, couplings)
    if inertia.zero or not border.shape[1]:
        return inertia, np.zeros((border.shape[1], border.shape[1]))
    reduced = solve_triangular(
        lower[order], border[order], lower=True, unit_diagonal=True, check_finite=False
    )
    bands = np.zeros((3, len(own)))
    bands[0, 1:], bands[1], bands[2, :-1] = couplings, diagonal, couplings
    removed = reduced.T @ solve_banded((1, 1), bands, reduced, check_finite=False)
    return inertia, (removed + removed.T) / 2.0


def inertia(matrix: SparseMatrix, fronts: list[Front]) -> Inertia:
    """Inertia of a symmetric matrix (csr n×n) by elimination along `fronts` (see `dissect`).

    The fronts may come from any matrix whose pattern contains this one's. Where a zero pivot is
    met the elimination ends and the numbers add up to less than n: σ is an eigenvalue of the
    matrix or of one of its parts, and no sign can be given.
    """
    n = matrix.shape[0]
    front_of = np.empty(n, dtype=np.int64)
    for number, front in enumerate(fronts):
        front_of[front.unknowns] = number
    place = np.empty(n, dtype=np.int64)
    updates: dict[int, tuple[IntArray, Array]] = {}
    total = np.zeros(3, dtype=np.int64)
    for number, front in enumerate(fronts):
        own = front.unknowns
        rows = matrix[own].tocoo()
        later = front_of[rows.col] >= number
        row, column, value = rows.row[later], rows.col[later], rows.data[later]
        children = [updates.pop(child) for child in front.children]
        reached = np.unique(np.concatenate([column, *(child[0] for child in children)]))
        border = reached[front_of[reached] > number]
        p, q = len(own), len(border)
        place[own], place[border] = np.arange(p), np.arange(p, p + q)
        dense = np.zeros((p + q, p + q))
        dense[row, place[column]] = value
        for unknowns, update in children:
            at = place[unknowns]
            dense[np.ix_(at, at)] += update
        counted, removed = _eliminate(dense[:p, :p], dense[:p, p:])
        total += counted
        if counted.zero:
            break
        updates[number] = (border, dense[p:, p:] - removed)
    return Inertia(*(int(count) for count in total))


def count_below(
    K: SparseMatrix,
    M: SparseMatrix,
    sigma: float,
    leading: tuple[int, ...] = (),
    constraints: Array | None = None,
) -> Inertia:
    """Inertia of K − σM (csr n×n, K and M symmetric, M positive definite, σ in rad²/s²).

    Their upper triangles are enough.
    `negative` eigenvalues of K x = λ M x lie below σ: the certificate of a set of modes. `zero`
    above zero means that σ is too near an eigenvalue, of the whole or of a part eliminated
    first; move it. `leading` as in fem.solvers.ordering. With `constraints` B (n×c, of full rank)
    only vectors with Bᵀx = 0 count. MKL PARDISO counts where it is the backend.
    """
    triangle = upper_triangle(csr_array(K - sigma * M))
    if backend() == "mkl":
        from fem.solvers import pardiso  # noqa: PLC0415  the extra is optional

        return Inertia(*pardiso.inertia(triangle, constraints))
    shifted = whole_matrix(triangle)
    fronts = dissect(block_graph(shifted, leading))
    if constraints is None:
        return inertia(shifted, fronts)
    # [A B; Bᵀ 0] has the inertia of A on Bᵀx = 0 and c eigenvalues of either sign (Gould, Math.
    # Prog. 32 (1985) 90). The constraints come last, when their pivots are no longer zero.
    n, c = constraints.shape
    columns = csr_array(constraints)
    bordered = csr_array(block_array([[shifted, columns], [columns.T, None]], format="csr"))
    last = Front(np.arange(n, n + c), (len(fronts) - 1,))
    found = inertia(bordered, [*fronts, last])
    return Inertia(found.negative - c, found.zero, found.positive - c)
