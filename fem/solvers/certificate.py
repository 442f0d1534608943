"""How many eigenvalues of K x = λ M x lie below σ: the certificate that no mode was missed.

By Sylvester's law of inertia the signs of the pivots of K − σM are those of its eigenvalues. The
cheaper of two counts is one Cholesky factorisation: the leg with supports, then without them.

Supports W (n×r) on a few cross-sections make Ã = K − σM + WWᵀ positive definite as soon as the
pieces of leg between them have no mode below σ. That the factorisation of Ã succeeds proves it, and
Haynsworth's theorem (Linear Algebra Appl. 1 (1968) 73) on [Ã W; Wᵀ I] gives the inertia without
them: K − σM has as many negative eigenvalues as the r×r matrix I − WᵀÃ⁻¹W. The supports rest on
separators of the elimination order, which fill in anyway: the cost is that of factorising K.

Where they give no sign, the matrix is eliminated front by front along a nested dissection of its
graph (the multifrontal method of Duff and Reid). A front is a dense matrix, pivoted by Bunch and
Kaufman where it is not positive definite; its pivots are counted and nothing of the factor is kept.
"""

from collections.abc import Iterator
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
from scipy.sparse import block_array, csc_array, csr_array, hstack

from fem.solvers.cholesky import RenewableFactor, analyse, backend
from fem.solvers.factor import (
    NotPositiveDefiniteError,
    SeparatedFactor,
    upper_triangle,
    whole_matrix,
)
from fem.solvers.ordering import BlockGraph, block_graph, separate
from lumped.arrays import Array, IntArray, SparseMatrix

# Blocks below which a part is one dense front: smaller fronts cost more in calls than in flops.
_LEAF_BLOCKS = 100
# A pivot below this part of the front's largest is rounding error: it has no sign.
_ZERO_PIVOT = 100.0 * np.finfo(np.float64).eps
# Separators that carry supports, one number after the other until Ã is positive definite.
_SEPARATORS = (31, 63)
# Most nodes of a patch of a separator that has supports of its own, and of those that carry them.
_PATCH, _NODES = 400, 75
# Part of the largest that a shape of support must keep to count as independent of the others.
_INDEPENDENT = 1e-3
# An eigenvalue of I − WᵀÃ⁻¹W below this is rounding: those lie below 1, and their errors, measured
# on a leg 87 diameters long, are some 1e-15.
_ZERO = 500.0 * np.finfo(np.float64).eps


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

    Their upper triangles are enough. `negative` eigenvalues of K x = λ M x lie below σ: the
    certificate of a set of modes. `zero` above zero means that σ is too near an eigenvalue, of the
    whole or of a part eliminated first; move it. `leading` as in fem.solvers.ordering. With
    `constraints` B (n×c, of full rank) only vectors with Bᵀx = 0 count. MKL PARDISO counts where it
    is the backend.
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


def inertia_below(
    factor: RenewableFactor,
    K: SparseMatrix,
    M: SparseMatrix,
    sigma: float,
    points: Array,
    leading: tuple[int, ...] = (),
    constraints: Array | None = None,
) -> Inertia:
    """Inertia of K − σM (csr n×n, σ in rad²/s²), on Bᵀx = 0 where `constraints` B (n×c) are given.

    `factor` is of K or of K with springs, of one pattern with both; `points` (N×3, m) are the nodes
    of the last 3N unknowns, `leading` the blocks before them (fem.solvers.ordering). By supports on
    the separators of the factor or, where these give no sign, by fronts. `zero` above zero: move σ.
    """
    K, M = upper_triangle(K), upper_triangle(csr_array(M))
    found = supported_count(factor, K, M, sigma, points, constraints)
    if found is not None and not found.zero:
        return found
    factor.make_room()
    return count_below(K, M, sigma, leading, constraints)


def _shapes(points: Array) -> Array:
    """Orthonormal linear displacement fields (3m×r) at `points` (m×3): rigid motions, strains."""
    centred = (points - points.mean(axis=0)) / np.ptp(points, axis=0).max()
    fields = np.column_stack([np.ones(len(points)), centred])
    shapes, sizes, _ = np.linalg.svd(fields, full_matrices=False)
    return np.kron(shapes[:, sizes > _INDEPENDENT * sizes[0]], np.eye(3))


def _patches(points: Array, nodes: IntArray) -> Iterator[IntArray]:
    """The `nodes` in patches of neighbours, halved across their greatest extent."""
    if len(nodes) <= _PATCH:
        yield nodes
        return
    at = points[nodes]
    order = np.argsort(at[:, np.argmax(np.ptp(at, axis=0))], kind="stable")
    for half in np.array_split(order, 2):
        yield from _patches(points, nodes[half])


def _supports(separators: list[IntArray], points: Array, n: int) -> list[SparseMatrix]:
    """Supports on separators of the elimination of n unknowns: orthonormal shapes (csc n×r).

    Each rests on one patch of a separator. `points` (N×3) are the places of the nodes, to which the
    last 3N unknowns belong.
    """
    leading = n - 3 * len(points)
    supports = []
    for own in separators:
        nodes, components = np.unique((own[own >= leading] - leading) // 3, return_counts=True)
        for patch in _patches(points, nodes[components == 3]):
            chosen = patch[:: max(1, -(-len(patch) // _NODES))]
            if len(chosen) > 1:
                unknowns = leading + (3 * chosen[:, None] + np.arange(3)).ravel()
                shapes = _shapes(points[chosen])
                m, r = shapes.shape
                columns = (shapes.T.ravel(), np.tile(unknowns, r), m * np.arange(r + 1))
                supports.append(csc_array(columns, shape=(n, r)))
    return supports


def supported_count(
    factor: RenewableFactor,
    K: SparseMatrix,
    M: SparseMatrix,
    sigma: float,
    points: Array,
    constraints: Array | None = None,
) -> Inertia | None:
    """Inertia of K − σM (upper triangles, csr n×n) on the separators of the `factor` of K.

    On the vectors with Bᵀx = 0 where `constraints` B (n×c) are given. `zero` above zero: move σ.
    None where the factor has no separators or no supports on them made it positive definite, which
    says nothing about K − σM.
    """
    n = K.shape[0]
    scale = np.sqrt(np.abs(K.diagonal() - sigma * M.diagonal()).mean())
    if not isinstance(factor.numeric, SeparatedFactor):
        return None
    largest = factor.numeric.separators(_SEPARATORS[-1])
    for count in _SEPARATORS:
        supports = _supports(largest[:count], points, n)
        if not supports:
            return None
        W = csr_array(hstack(supports)) * scale
        triangle = csr_array(csr_array(K - sigma * M) + upper_triangle(csr_array(W @ W.T)))
        factor.make_room()
        try:
            # What couples unknowns of one separator fills in anyway.
            symbolic = analyse(triangle, elimination=factor.symbolic.elimination)
            supported = symbolic.factorise("supported leg")
        except NotPositiveDefiniteError:
            continue
        if isinstance(supported, SeparatedFactor):
            return _without_supports(supported, W, constraints)
    return None


def _without_supports(
    factor: SeparatedFactor, W: SparseMatrix, constraints: Array | None
) -> Inertia:
    n, rank = W.shape
    remaining = np.eye(rank) - factor.gram(W)
    c = 0
    if constraints is not None:
        c = constraints.shape[1]
        solved = factor.solve(constraints)
        compliance = constraints.T @ solved
        scale = 1.0 / np.sqrt(np.diag(compliance))
        across = -(W.T @ solved) * scale
        own = -compliance * scale * scale[:, None]
        remaining = np.block([[remaining, across], [across.T, (own + own.T) / 2.0]])
    values = np.linalg.eigvalsh(remaining)
    zero = int((np.abs(values) <= _ZERO).sum())
    negative = int((values < -_ZERO).sum()) - c
    return Inertia(negative, zero, n - c - zero - negative)
