"""CHOLMOD on two cores: both halves of a matrix are factorised at once, then their separator.

With the separator S last, the matrix is [A₁ 0 B₁; 0 A₂ B₂; B₁ᵀ B₂ᵀ C]. One thread each factorises
[A_i B_i; B_iᵀ C], half i with the other half held, which is positive definite as the whole is. The
end of its factor gives S_i = C − B_iᵀA_i⁻¹B_i; that of the whole is S₁ + S₂ − C, a dense matrix.
Solves run in two threads as well.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, NamedTuple, TypeVar

import numpy as np
from cvxopt import cholmod
from scipy.linalg import cho_solve, solve_triangular
from scipy.linalg.lapack import dpotrf
from scipy.sparse import csc_array, csr_array

from fem.solvers.cholmod.library import SYSTEM_L, SYSTEM_LT, factorise_beside, solve_columns
from fem.solvers.cholmod.supernodes import (
    detach_end,
    elimination_order,
    largest_supernodes,
    solve_paths,
)
from fem.solvers.cholmod.whole_factor import in_blocks, peak_bytes, symbolic_factor
from fem.solvers.factor import (
    NotPositiveDefiniteError,
    Symbolic,
    out_of_memory,
    refuse_lost_pivots,
    whole_matrix,
)
from fem.solvers.ordering import Elimination
from lumped.arrays import Array, IntArray, SparseMatrix

_In = TypeVar("_In")
_Out = TypeVar("_Out")


def _at_once(function: Callable[[_In], _Out], halves: Sequence[_In]) -> list[_Out]:
    with ThreadPoolExecutor(len(halves)) as threads:
        return list(threads.map(function, halves))


class _Analysed(NamedTuple):
    """CHOLMOD's symbolic factor of a half and the separator, for one factorisation.

    `triangle` (csr m×m): the upper one of these; `unknowns` (m, ascending): their numbers in the
    whole.
    """

    handle: Any
    triangle: SparseMatrix
    unknowns: IntArray


@dataclass(frozen=True, eq=False)
class _Half:
    """A half's factor without its end.

    `unknowns` (m): numbers in the whole of the factor's own; `order` (m): the same in the order of
    elimination, the separator's s at the end; `separator` (s): the places of these in it.
    """

    handle: Any = field(repr=False)
    unknowns: IntArray
    order: IntArray
    separator: IntArray

    @property
    def own(self) -> int:
        """Number of unknowns before the separator's."""
        return len(self.order) - len(self.separator)


@dataclass(frozen=True, eq=False)
class BisectedFactor:
    """Factors of two halves and the dense Cholesky factor `lower` (s×s) of their `separator`."""

    halves: tuple[_Half, ...]
    separator: IntArray
    lower: Array = field(repr=False)

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        return in_blocks(self._solved, right_hand_sides)

    def _solved(self, columns: Array) -> Array:
        solution = np.empty_like(columns)

        def forward(half: _Half) -> Array:
            own = np.asfortranarray(columns[half.order])
            own[half.own :] = 0.0
            return solve_columns(half.handle, own, SYSTEM_L)

        def backward(both: tuple[_Half, Array]) -> None:
            half, own = both
            own[half.own :] = between[half.separator]
            found = solve_columns(half.handle, own, SYSTEM_LT)
            solution[half.order[: half.own]] = found[: half.own]

        forwards = _at_once(forward, self.halves)
        between = columns[self.separator]
        for half, own in zip(self.halves, forwards, strict=True):
            between[half.separator] += own[half.own :]
        between = cho_solve((self.lower, True), between, check_finite=False)
        solution[self.separator] = between
        _at_once(backward, list(zip(self.halves, forwards, strict=True)))
        return solution

    def separators(self, count: int) -> list[IntArray]:
        """Unknowns of the separator and of the halves' supernodes, the largest first."""
        found = [self.separator]
        for half in self.halves:
            largest = largest_supernodes(half.handle, count, half.own)
            found += [half.unknowns[own] for own in largest]
        return sorted(found, key=len, reverse=True)[:count]

    def gram(self, columns: SparseMatrix) -> Array:
        """WᵀA⁻¹W (k×k) of `columns` W (csr n×k): see fem.solvers.factor."""
        between = columns[self.separator].toarray()
        gram = np.zeros((columns.shape[1], columns.shape[1]))
        for half in self.halves:
            own = columns[half.order[: half.own]]
            own.resize((len(half.order), columns.shape[1]))
            places, values = solve_paths(half.handle, csc_array(own))
            inner = int(np.searchsorted(places, half.own))
            gram += values[:inner].T @ values[:inner]
            between[half.separator[places[inner:] - half.own]] += values[inner:]
        last = solve_triangular(self.lower, between, lower=True, check_finite=False)
        return np.asarray(gram + last.T @ last)


def analyse(triangle: SparseMatrix, elimination: Elimination) -> Symbolic | None:
    """Analyse an upper `triangle` (csr) for its elimination in halves.

    None where there is nothing between the halves, or where one of them falls to pieces in such a
    way that the separator does not come last.
    """
    n, sizes = triangle.shape[0], elimination.halves
    first, second, last = np.split(elimination.order, np.cumsum(sizes))
    separator = np.sort(last)
    if not (len(first) and len(second) and len(separator)):
        return None

    def analysed() -> list[_Analysed]:
        return [_analysed(triangle, half, separator) for half in (first, second)]

    # They serve the first factorisation, later ones make their own.
    unused = [analysed()]
    for half, size in zip(unused[0], sizes, strict=True):
        end = half.unknowns[elimination_order(half.handle)[size:]]
        if not np.array_equal(np.sort(end), separator):
            return None
    # The ends of both factors and of the whole, as dense matrices.
    dense = 3 * 8 * len(separator) ** 2
    peak = dense + sum(peak_bytes(half.handle, triangle.nnz // 2) for half in unused[0])

    def numeric(part: str) -> BisectedFactor:
        return _eliminated(triangle, unused.pop() if unused else analysed(), separator, part)

    return Symbolic(n, elimination, peak, numeric)


def _analysed(triangle: SparseMatrix, half: IntArray, separator: IntArray) -> _Analysed:
    """A half, its unknowns in their order of elimination, and the separator behind it.

    CHOLMOD reorders so that each unknown comes after those that it depends on. The half's last one
    is coupled to all of the separator, by zeros where it is not, so that the separator stays at the
    end, where it is a dense block.
    """
    eliminated = np.concatenate([half, separator])
    unknowns = np.sort(eliminated)
    order = np.searchsorted(unknowns, eliminated)
    own = csr_array(triangle[unknowns][:, unknowns]).tocoo()
    last, end = order[len(half) - 1], order[len(half) :]
    rows, columns = np.hstack([own.coords, [np.minimum(last, end), np.maximum(last, end)]])
    values = np.concatenate([own.data, np.zeros(len(end))])
    coupled = csr_array((values, (rows, columns)), shape=own.shape)
    return _Analysed(symbolic_factor(coupled, order)[0], coupled, unknowns)


def _eliminated(
    triangle: SparseMatrix, analysed: list[_Analysed], separator: IntArray, part: str
) -> BisectedFactor:
    n, diagonal = triangle.shape[0], triangle.diagonal()

    def eliminate(half: _Analysed) -> tuple[_Half, Array]:
        handle, own, unknowns = half
        place = factorise_beside(handle, own)
        order = unknowns[elimination_order(handle)]
        if place < len(order):
            raise NotPositiveDefiniteError(part, int(order[place]))
        pivots = np.array(cholmod.diag(handle)).ravel() ** 2
        refuse_lost_pivots(pivots, diagonal[order], order, part)
        first = len(order) - len(separator)
        lower = detach_end(handle, first)
        at = np.searchsorted(separator, order[first:])
        return _Half(handle, unknowns, order, at), lower @ lower.T

    try:
        halves = _at_once(eliminate, analysed)
    except MemoryError:
        raise out_of_memory(part, n) from None
    remaining = -whole_matrix(csr_array(triangle[separator][:, separator])).toarray(order="F")
    for half, schur in halves:
        remaining[np.ix_(half.separator, half.separator)] += schur
    lower, failed = dpotrf(remaining, lower=1, overwrite_a=1)
    if failed:
        raise NotPositiveDefiniteError(part, int(separator[failed - 1]))
    refuse_lost_pivots(np.diag(lower) ** 2, diagonal[separator], separator, part)
    return BisectedFactor(tuple(half for half, _ in halves), separator, lower)
