"""How many eigenvalues of K x = λ M x lie below σ, by the cheaper count that gives their signs.

That is one Cholesky factorisation: the leg with supports, then without them.

Supports W (n×r) on a few cross-sections make Ã = K − σM + WWᵀ positive definite as soon as the
pieces of leg between them have no mode below σ. That the factorisation of Ã succeeds proves it, and
Haynsworth's theorem (Linear Algebra Appl. 1 (1968) 73) on [Ã W; Wᵀ I] gives the inertia without
them: K − σM has as many negative eigenvalues as the r×r matrix I − WᵀÃ⁻¹W. The supports rest on
separators of the elimination order, which fill in anyway: the cost is that of factorising K.
"""

from collections.abc import Iterator

import numpy as np
from scipy.sparse import csc_array, csr_array, hstack

from fem.solvers.certificate.sturm import Inertia, count_below
from fem.solvers.cholesky import RenewableFactor, analyse
from fem.solvers.factor import NotPositiveDefiniteError, SeparatedFactor, upper_triangle
from lumped.arrays import Array, IntArray, SparseMatrix

# Separators that carry supports, one number after the other until Ã is positive definite.
_SEPARATORS = (31, 63)
# Most nodes of a patch of a separator that has supports of its own, and of those that carry them.
_PATCH, _NODES = 400, 75
# Part of the largest that a shape of support must keep to count as independent of the others.
_INDEPENDENT = 1e-3
# An eigenvalue of I − WᵀÃ⁻¹W below this is rounding: those lie below 1, and their errors, measured
# on a leg 87 diameters long, are some 1e-15.
_ZERO = 500.0 * np.finfo(np.float64).eps


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
    of the last 3N unknowns, `leading` the blocks before them (fem.solvers.ordering). It is
    counted with supports on the separators of the factor and, where there are none or these give no
    sign, by LDLᵀ (fem.solvers.certificate.sturm). `zero` above zero: move σ.
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
