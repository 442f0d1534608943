"""Inertia of K − σM by one Cholesky factorisation: the leg with supports, then without them.

Supports W (n×r) on a few cross-sections make Ã = K − σM + WWᵀ positive definite as soon as the
pieces of leg between them have no mode below σ. That the factorisation of Ã succeeds proves it, and
Haynsworth's theorem (Linear Algebra Appl. 1 (1968) 73) on [Ã W; Wᵀ I] gives the inertia without
them: K − σM has as many negative eigenvalues as the r×r matrix I − WᵀÃ⁻¹W. The supports rest on
separators of the elimination order, which fill in anyway: the cost is that of factorising K.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from cvxopt import cholmod
from cvxopt import matrix as cvxopt_matrix
from scipy.sparse import csr_array

from fem.cholesky import cvxopt_triangle, upper_triangle
from fem.cholmod_library import Elimination, solve_columns, solve_lower_end
from fem.cholmod_library import elimination as elimination_of
from fem.sturm import Inertia
from lumped.arrays import Array, IntArray, SparseMatrix

# Separators that carry supports, one number after the other until Ã is positive definite.
_SEPARATORS = (15, 31)
# Most nodes of a patch of a separator that has supports of its own, and of those that carry them.
_PATCH, _NODES = 400, 75
# Part of the largest that a shape of support must keep to count as independent of the others.
_INDEPENDENT = 1e-3
# An eigenvalue of I − WᵀÃ⁻¹W below this is rounding: those lie below 1, and their errors, measured
# on a leg 87 diameters long, are some 1e-15.
_ZERO = 500.0 * np.finfo(np.float64).eps


@dataclass(frozen=True, eq=False)
class Supports:
    """Orthonormal shapes (m×r) of supports on the unknowns of one patch of a separator (m)."""

    unknowns: IntArray
    shapes: Array


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


def separator_supports(elimination: Elimination, points: Array, count: int) -> list[Supports]:
    """Supports on the `count` largest separators of an elimination.

    `points` (N×3) are the places of the nodes, to which the last 3N unknowns belong.
    """
    order, starts = elimination.order, elimination.starts
    leading = len(order) - 3 * len(points)
    largest = np.argsort(-np.diff(starts), kind="stable")[:count]
    supports = []
    for number in np.sort(largest):
        own = order[starts[number] : starts[number + 1]]
        nodes, components = np.unique((own[own >= leading] - leading) // 3, return_counts=True)
        for patch in _patches(points, nodes[components == 3]):
            chosen = patch[:: max(1, -(-len(patch) // _NODES))]
            if len(chosen) > 1:
                unknowns = leading + (3 * chosen[:, None] + np.arange(3)).ravel()
                supports.append(Supports(unknowns, _shapes(points[chosen])))
    return supports


def supported_count(
    elimination: Elimination,
    shifted: SparseMatrix,
    points: Array,
    constraints: Array | None = None,
) -> Inertia | None:
    """Inertia of K − σM (`shifted`, csr n×n) with the `elimination` of the factor of K.

    On the vectors with Bᵀx = 0 where `constraints` B (n×c) are given. `zero` above zero: move σ.
    None where no supports made it positive definite, which says nothing about K − σM.
    """
    for count in _SEPARATORS:
        supports = separator_supports(elimination, points, count)
        if not supports:
            return None
        stiffness = float(np.abs(shifted.diagonal()).mean())
        handle = _supported_factor(elimination.order, shifted, supports, stiffness)
        if handle is not None:
            return _without_supports(handle, supports, stiffness, shifted.shape[0], constraints)
    return None


def _supported_factor(
    order: IntArray, shifted: SparseMatrix, supports: list[Supports], stiffness: float
) -> Any:
    """CHOLMOD's factor of the supported matrix, None where it is not positive definite."""
    blocks = [stiffness * (s.shapes @ s.shapes.T) for s in supports]
    rows = np.concatenate([np.repeat(s.unknowns, len(s.unknowns)) for s in supports])
    columns = np.concatenate([np.tile(s.unknowns, len(s.unknowns)) for s in supports])
    values = np.concatenate([block.ravel() for block in blocks])
    added = csr_array((values, (rows, columns)), shape=shifted.shape)
    triangle = cvxopt_triangle(upper_triangle(csr_array(shifted + added)))
    del blocks, rows, columns, values, added
    handle = cholmod.symbolic(triangle, cvxopt_matrix(order))
    try:
        cholmod.numeric(triangle, handle)
    except ArithmeticError:
        return None
    return handle


def _without_supports(
    handle: Any, supports: list[Supports], stiffness: float, n: int, constraints: Array | None
) -> Inertia:
    own_elimination = elimination_of(handle)
    order, starts = own_elimination.order, own_elimination.starts
    place = np.empty(n, dtype=np.int64)
    place[order] = np.arange(n)
    first_place = min(int(place[s.unknowns].min()) for s in supports)
    first = int(np.searchsorted(starts, first_place, side="right")) - 1
    rank = sum(s.shapes.shape[1] for s in supports)
    W = np.zeros((n - int(starts[first]), rank), order="F")
    column = 0
    # In the order of elimination, so that a column of W is nothing but zeros until its turn.
    for s in sorted(supports, key=lambda one: int(place[one.unknowns].min())):
        rows = (place[s.unknowns] - starts[first])[:, None]
        W[rows, np.arange(column, column + s.shapes.shape[1])] = np.sqrt(stiffness) * s.shapes
        column += s.shapes.shape[1]
    reduced = solve_lower_end(handle, first, W)
    remaining = np.eye(rank) - reduced.T @ reduced
    c = 0
    if constraints is not None:
        c = constraints.shape[1]
        solved = solve_columns(handle, np.asfortranarray(constraints))
        compliance = constraints.T @ solved
        scale = 1.0 / np.sqrt(np.diag(compliance))
        across = -(W.T @ solved[order][starts[first] :]) * scale
        own = -compliance * scale * scale[:, None]
        remaining = np.block([[remaining, across], [across.T, (own + own.T) / 2.0]])
    values = np.linalg.eigvalsh(remaining)
    zero = int((np.abs(values) <= _ZERO).sum())
    negative = int((values < -_ZERO).sum()) - c
    return Inertia(negative, zero, n - c - zero - negative)
