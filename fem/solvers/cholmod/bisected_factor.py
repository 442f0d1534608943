"""CHOLMOD on two cores: both halves of a matrix are factorised at once, then their separator.

With the separator S last, the matrix is [A₁ 0 B₁; 0 A₂ B₂; B₁ᵀ B₂ᵀ C]. One thread each factorises
[A_i B_i; B_iᵀ C], half i with the other half held, which is positive definite as the whole is. The
end of its factor gives S_i = C − B_iᵀA_i⁻¹B_i; that of the whole is S₁ + S₂ − C, a dense matrix.
Solves run in two threads as well.
"""

from collections import deque
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from typing import Any, TypeVar

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
    statistics,
)
from fem.solvers.cholmod.whole_factor import COLUMNS_AT_ONCE, peak_bytes, symbolic_factor
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


def _at_once(function: Callable[[_In], _Out], halves: tuple[_In, ...]) -> list[_Out]:
    with ThreadPoolExecutor(len(halves)) as threads:
        return list(threads.map(function, halves))


@dataclass(frozen=True, eq=False)
class _Pattern:
    """Upper triangle (csr m×m) of a half and the separator, and where its values come from.

    `unknowns` (m, ascending): numbers in the whole; `sources`: places in the values of the whole's
    triangle, negative for zeros that are stored to have the separator last.
    """

    unknowns: IntArray
    pointers: IntArray
    columns: IntArray
    sources: IntArray

    def values(self, whole: Array) -> Array:
        """Values on the pattern from those of the whole."""
        own = whole[self.sources]
        own[self.sources < 0] = 0.0
        return own

    def analysed(self, eliminated: IntArray) -> Any:
        """CHOLMOD's symbolic factor, for one factorisation that eliminates in the given order."""
        m = len(self.unknowns)
        triangle = csr_array((np.ones(len(self.columns)), self.columns, self.pointers), (m, m))
        return symbolic_factor(triangle, np.searchsorted(self.unknowns, eliminated))[0]


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

    size: int
    halves: tuple[_Half, ...]
    separator: IntArray
    lower: Array = field(repr=False)

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        columns = np.asarray(right_hand_sides, dtype=np.float64).reshape(self.size, -1)
        solution = np.empty(columns.shape, order="F")
        for start in range(0, columns.shape[1], COLUMNS_AT_ONCE):
            some = slice(start, start + COLUMNS_AT_ONCE)
            self._solve(columns[:, some], solution[:, some])
        return solution.reshape(right_hand_sides.shape)

    def _solve(self, columns: Array, solution: Array) -> None:
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
        _at_once(backward, tuple(zip(self.halves, forwards, strict=True)))

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
            found = solve_paths(half.handle, csc_array(own))
            inner = int(np.searchsorted(found.places, half.own))
            gram += found.values[:inner].T @ found.values[:inner]
            between[half.separator[found.places[inner:] - half.own]] += found.values[inner:]
        last = solve_triangular(self.lower, between, lower=True, check_finite=False)
        return np.asarray(gram + last.T @ last)


def analyse(triangle: SparseMatrix, elimination: Elimination) -> Symbolic | None:
    """Analyse an upper `triangle` (csr) for its elimination in halves.

    None where there is nothing between the halves, or where one of them falls to pieces in such a
    way that the separator does not come last.
    """
    n, sizes = triangle.shape[0], elimination.halves
    pointers, columns = triangle.indptr, triangle.indices
    first, second, last = np.split(elimination.order, np.cumsum(sizes))
    separator = np.sort(last)
    if not (len(first) and len(second) and len(separator)):
        return None
    orders = [np.concatenate([own, separator]) for own in (first, second)]

    def analysed() -> tuple[list[_Pattern], list[Any]]:
        patterns = []
        for order in orders:
            unknowns = np.sort(order)
            places = _places(pointers, columns, unknowns)
            local = np.searchsorted(unknowns, order)
            patterns.append(_pattern(unknowns, _separator_last(places, local, len(separator))))
        return patterns, [p.analysed(order) for p, order in zip(patterns, orders, strict=True)]

    patterns, handles = analysed()
    for pattern, handle, size in zip(patterns, handles, sizes, strict=True):
        end = pattern.unknowns[elimination_order(handle)[size:]]
        if not np.array_equal(np.sort(end), separator):
            return None
    counts = [statistics(handle) for handle in handles]
    # They serve the first factorisation, later ones make their own.
    unused = deque([(patterns, handles)])
    del patterns, handles

    def numeric(values: Array, part: str) -> BisectedFactor:
        whole = csr_array((values, columns, pointers), shape=(n, n))
        return _eliminated(whole, *(unused.pop() if unused else analysed()), separator, part)

    # The ends of both factors and of the whole, as dense matrices.
    dense = 3 * 8 * len(separator) ** 2
    return Symbolic(
        backend="cholmod",
        size=n,
        pointers=pointers,
        columns=columns,
        elimination=elimination,
        peak_bytes=dense + sum(peak_bytes(one, triangle.nnz // 2) for one in counts),
        numeric=numeric,
    )


def _places(pointers: IntArray, columns: IntArray, unknowns: IntArray) -> SparseMatrix:
    """Places, from 1, in the values of an upper triangle (csr) of those on some `unknowns` (m×m).

    `unknowns` ascend.
    """
    n = len(pointers) - 1
    numbers = np.arange(1, len(columns) + 1, dtype=pointers.dtype)
    places = csr_array((numbers, columns, pointers), shape=(n, n))[unknowns][:, unknowns]
    return csr_array(places)


def _separator_last(places: SparseMatrix, order: IntArray, separator: int) -> SparseMatrix:
    """The places with negative ones that couple a half's last unknown to its `separator` last ones.

    CHOLMOD reorders so that each unknown comes after those that it depends on. All of the separator
    then depends on the half, so it stays at the end, where it is a dense block. `order` (m): own
    numbers as they are to be eliminated.
    """
    own, between = order[:-separator], order[-separator:]
    pairs = np.sort(np.column_stack([np.full(separator, own[-1]), between]), axis=1)
    absent = pairs[np.asarray(places[pairs[:, 0], pairs[:, 1]]).ravel() == 0]
    zeros = np.full(len(absent), -1, dtype=places.dtype)
    return csr_array(places + csr_array((zeros, tuple(absent.T)), shape=places.shape))


def _pattern(unknowns: IntArray, places: SparseMatrix) -> _Pattern:
    places.sort_indices()
    return _Pattern(unknowns, places.indptr, places.indices, places.data - 1)


def _eliminated(
    triangle: SparseMatrix,
    patterns: list[_Pattern],
    handles: list[Any],
    separator: IntArray,
    part: str,
) -> BisectedFactor:
    n, diagonal = triangle.shape[0], triangle.diagonal()

    def eliminate(both: tuple[_Pattern, Any]) -> tuple[_Half, Array]:
        pattern, handle = both
        own = pattern.values(triangle.data)
        place = factorise_beside(handle, pattern.pointers, pattern.columns, own)
        order = pattern.unknowns[elimination_order(handle)]
        if place < len(order):
            raise NotPositiveDefiniteError(part, int(order[place]))
        pivots = np.array(cholmod.diag(handle)).ravel() ** 2
        refuse_lost_pivots(pivots, diagonal[order], order, part)
        first = len(order) - len(separator)
        lower = detach_end(handle, first)
        at = np.searchsorted(separator, order[first:])
        return _Half(handle, pattern.unknowns, order, at), lower @ lower.T

    try:
        halves = _at_once(eliminate, tuple(zip(patterns, handles, strict=True)))
    except MemoryError:
        raise out_of_memory(part, n) from None
    between = whole_matrix(csr_array(triangle[separator][:, separator]))
    remaining = -between.toarray(order="F")
    for half, schur in halves:
        remaining[np.ix_(half.separator, half.separator)] += schur
    lower, failed = dpotrf(remaining, lower=1, overwrite_a=1)
    if failed:
        raise NotPositiveDefiniteError(part, int(separator[failed - 1]))
    refuse_lost_pivots(np.diag(lower) ** 2, diagonal[separator], separator, part)
    return BisectedFactor(n, tuple(half for half, _ in halves), separator, lower)
