"""What a CHOLMOD factor holds: its size, its order of elimination, its supernodes.

cvxopt hands a factor over as a capsule around CHOLMOD's `cholmod_factor`, whose leading members
have kept their places since CHOLMOD 3.0. A supernode is a dense block of columns of L.
"""

import ctypes
from heapq import heappop, heappush
from typing import Any

import numpy as np
from scipy.linalg import solve_triangular
from scipy.linalg.blas import dgemm

from lumped.arrays import Array, IntArray, SparseMatrix

_CAPSULE_NAME = b"CHOLMOD FACTOR D L"


class FactorHead(ctypes.Structure):
    """The leading members of CHOLMOD's `cholmod_factor`."""

    _fields_ = (
        ("n", ctypes.c_size_t),
        ("minor", ctypes.c_size_t),
        ("perm", ctypes.c_void_p),
        ("column_counts", ctypes.c_void_p),
        ("inverse_perm", ctypes.c_void_p),
        ("nzmax", ctypes.c_size_t),
        ("p", ctypes.c_void_p),
        ("i", ctypes.c_void_p),
        ("x", ctypes.c_void_p),
        ("z", ctypes.c_void_p),
        ("nz", ctypes.c_void_p),
        ("next", ctypes.c_void_p),
        ("prev", ctypes.c_void_p),
        ("supernodes", ctypes.c_size_t),
        ("index_entries", ctypes.c_size_t),
        ("stored_entries", ctypes.c_size_t),
        ("update_entries", ctypes.c_size_t),
        ("largest_index_block", ctypes.c_size_t),
        ("super", ctypes.c_void_p),
        ("index_pointers", ctypes.c_void_p),
        ("value_pointers", ctypes.c_void_p),
        ("indices", ctypes.c_void_p),
    )


def factor_head(factor: Any) -> FactorHead:
    """The members of the factor in cvxopt's capsule, which must be kept as long as they are.

    Of a supernodal factor: `stored_entries` of L with the zeros that supernodes store,
    `index_entries`, and `update_entries`, those of the largest update block.
    """
    pointer_of = ctypes.pythonapi.PyCapsule_GetPointer
    pointer_of.restype = ctypes.c_void_p
    pointer_of.argtypes = [ctypes.py_object, ctypes.c_char_p]
    return FactorHead.from_address(pointer_of(factor, _CAPSULE_NAME))


def _long_array(address: int, count: int) -> IntArray:
    # A copy into a new array has numpy's own int64, which cvxopt takes; ctypes' long long has not.
    copy = np.empty(count, dtype=np.int64)
    copy[:] = np.ctypeslib.as_array((ctypes.c_int64 * count).from_address(address))
    return copy


def entry_count(factor: Any) -> int:
    """Entries of L, known before its numbers."""
    head = factor_head(factor)
    return int(_long_array(head.column_counts, head.n).sum())


def elimination_order(factor: Any) -> IntArray:
    """Order (n) in which a factor eliminates the unknowns, after CHOLMOD's postordering."""
    head = factor_head(factor)
    return _long_array(head.perm, head.n)


def supernodes(factor: Any) -> IntArray:
    """First places of the supernodes in the order of elimination, and n: dense columns of L."""
    head = factor_head(factor)
    return _long_array(head.super, head.supernodes + 1)


def largest_supernodes(factor: Any, count: int, end: int | None = None) -> list[IntArray]:
    """Unknowns of the `count` largest supernodes, the largest first; places from `end` on apart."""
    order, starts = elimination_order(factor), supernodes(factor)
    last = len(order) if end is None else end
    starts = starts[starts < last]
    stops = np.append(starts[1:], last)
    largest = np.argsort(starts - stops, kind="stable")[:count]
    return [order[starts[number] : stops[number]] for number in largest]


class _Lower:
    """L by supernodes; `starts` (s+1) as `supernodes` gives them."""

    def __init__(self, factor: Any) -> None:
        self.head, self.starts = factor_head(factor), supernodes(factor)
        self.rows_from = _long_array(self.head.index_pointers, len(self.starts))
        self.values_from = _long_array(self.head.value_pointers, len(self.starts))

    def number(self, place: Any) -> Any:
        """The supernode of a place or of several."""
        return np.searchsorted(self.starts, place, side="right") - 1

    def parent(self, k: int) -> int | None:
        """The next supernode that depends on number k."""
        below = int(self.rows_from[k] + self.starts[k + 1] - self.starts[k])
        if below == self.rows_from[k + 1]:
            return None
        return int(self.number(_long_array(self.head.indices + 8 * below, 1)[0]))

    def __getitem__(self, k: int) -> tuple[IntArray, Array]:
        """The places (h) of the rows of supernode k, and its columns (h×w, a view)."""
        height = int(self.rows_from[k + 1] - self.rows_from[k])
        width = int(self.starts[k + 1] - self.starts[k])
        rows = _long_array(self.head.indices + 8 * int(self.rows_from[k]), height)
        values = (ctypes.c_double * (height * width)).from_address(
            self.head.x + 8 * int(self.values_from[k])
        )
        return rows, np.ctypeslib.as_array(values).reshape(width, height).T


def solve_paths(factor: Any, columns: SparseMatrix) -> tuple[IntArray, Array]:
    """L⁻¹ times `columns` W (csc n×k, rows in the order of elimination), without rows of zeros.

    The places (m, ascending) of the other rows in that order, and their values (m×k).
    A column reaches no more than the supernodes of its own rows and those that depend on them, the
    path to the root of the elimination tree: only these are read.
    """
    L = _Lower(factor)
    reached: dict[int, set[int]] = {}
    for column in range(columns.shape[1]):
        own = columns.indices[columns.indptr[column] : columns.indptr[column + 1]]
        for k in np.unique(L.number(own)):
            reached.setdefault(int(k), set()).add(column)
    # A parent has a higher number, so each is seen after all of its children.
    path: list[int] = []
    waiting = sorted(reached)
    while waiting:
        k = heappop(waiting)
        path.append(k)
        parent = L.parent(k)
        if parent is not None:
            if parent not in reached:
                reached[parent] = set()
                heappush(waiting, parent)
            reached[parent] |= reached[k]
    places = np.concatenate(
        [np.arange(L.starts[k], L.starts[k + 1]) for k in path] or [np.empty(0, dtype=np.int64)]
    )
    values = columns.tocsr()[places].toarray()
    for k in path:
        (rows, block), active = L[k], np.array(sorted(reached[k]))
        width = block.shape[1]
        at = np.searchsorted(places, rows)
        own = np.ix_(at[:width], active)
        solved = solve_triangular(block[:width], values[own], lower=True, check_finite=False)
        values[own] = solved
        # scipy's BLAS as for the line before: numpy's has threads of its own, which would wait.
        values[np.ix_(at[width:], active)] -= dgemm(1.0, block[width:], solved)
    return places, values


def detach_end(factor: Any, first: int) -> Array:
    """Take the end of L from place `first` on (m×m, lower) out and leave the identity there.

    The factor of [A B; Bᵀ C] then solves with [L 0; BᵀL⁻ᵀ I], L that of A: its end gives and takes
    what the rest of a larger matrix needs of A.
    """
    L = _Lower(factor)
    end = np.zeros((int(L.starts[-1]) - first, int(L.starts[-1]) - first), order="F")
    for k in range(int(L.number(first)), len(L.starts) - 1):
        (rows, block), start = L[k], int(L.starts[k])
        for column in range(max(0, first - start), block.shape[1]):
            below, own = rows[column:] - first, block[column:, column]
            end[below, start + column - first] = own
            own[:] = 0.0
            own[0] = 1.0
    return end
