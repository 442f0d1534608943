"""What cvxopt's CHOLMOD knows and can do but does not pass on: statistics, block solves.

cvxopt hands a factor over as a capsule around CHOLMOD's `cholmod_factor`, whose leading members
have kept their places since CHOLMOD 3.0. cvxopt solves several right-hand sides one by one, each
reading the whole factor again; `cholmod_l_solve` of the same shared library reads it once. Where
a build of cvxopt does not let that symbol be found, cvxopt's own solve is used.
"""

import ctypes
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple

import numpy as np
from cvxopt import cholmod
from cvxopt import matrix as cvxopt_matrix
from scipy.linalg import solve_triangular

from lumped.arrays import Array, IntArray

_CAPSULE_NAME = b"CHOLMOD FACTOR D L"
_SYSTEM_A = 0
_REAL, _DOUBLE = 1, 0
# `cholmod_common` is some 3 kB; its members are never touched from here.
_COMMON_BYTES = 1 << 16


class _FactorHead(ctypes.Structure):
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


class _Dense(ctypes.Structure):
    _fields_ = (
        ("nrow", ctypes.c_size_t),
        ("ncol", ctypes.c_size_t),
        ("nzmax", ctypes.c_size_t),
        ("d", ctypes.c_size_t),
        ("x", ctypes.c_void_p),
        ("z", ctypes.c_void_p),
        ("xtype", ctypes.c_int),
        ("dtype", ctypes.c_int),
    )


class _Library(NamedTuple):
    """The shared library and CHOLMOD's own workspace, which must outlive every call."""

    functions: Any
    common: Any


@dataclass(frozen=True)
class FactorStatistics:
    """Size of a supernodal factor, known before its numbers.

    `entries` of L; `stored_entries` with the zeros that supernodes store; `index_entries`;
    `update_entries`, the largest update block; `flops` of the factorisation.
    """

    entries: int
    stored_entries: int
    index_entries: int
    update_entries: int
    flops: float


def _head(factor: Any) -> _FactorHead:
    pointer_of = ctypes.pythonapi.PyCapsule_GetPointer
    pointer_of.restype = ctypes.c_void_p
    pointer_of.argtypes = [ctypes.py_object, ctypes.c_char_p]
    return _FactorHead.from_address(pointer_of(factor, _CAPSULE_NAME))


def _long_array(address: int, count: int) -> IntArray:
    # A copy into a new array has numpy's own int64, which cvxopt takes; ctypes' long long has not.
    copy = np.empty(count, dtype=np.int64)
    copy[:] = np.ctypeslib.as_array((ctypes.c_int64 * count).from_address(address))
    return copy


def statistics(factor: Any) -> FactorStatistics:
    """Statistics of a symbolic or numeric supernodal factor."""
    head = _head(factor)
    counts = _long_array(head.column_counts, head.n)
    return FactorStatistics(
        entries=int(counts.sum()),
        stored_entries=head.stored_entries,
        index_entries=head.index_entries,
        update_entries=head.update_entries,
        flops=float((counts.astype(np.float64) ** 2).sum()),
    )


def elimination_order(factor: Any) -> IntArray:
    """Order (n) in which a factor eliminates the unknowns, after CHOLMOD's postordering."""
    head = _head(factor)
    return _long_array(head.perm, head.n)


def supernodes(factor: Any) -> IntArray:
    """First places of the supernodes in the order of elimination, and n: dense columns of L."""
    head = _head(factor)
    return _long_array(head.super, head.supernodes + 1)


@dataclass(frozen=True, eq=False)
class Elimination:
    """The `order` (n) in which a factor eliminates unknowns, and its supernodes' `starts` (s+1)."""

    order: IntArray
    starts: IntArray


def elimination(factor: Any) -> Elimination:
    """Order and supernodes of a symbolic or numeric supernodal factor."""
    return Elimination(elimination_order(factor), supernodes(factor))


def solve_lower_end(factor: Any, first: int, columns: Array) -> Array:
    """L₂₂⁻¹ times `columns` (m×k, in the order of elimination), L₂₂ the supernodes from `first` on.

    Columns of zeros above make it the end of L⁻¹ times them, without reading the rest of L. A
    column costs nothing before its first entry that is not zero; give these in ascending order.
    """
    head = _head(factor)
    starts = supernodes(factor)
    rows_from = _long_array(head.index_pointers, head.supernodes + 1)
    values_from = _long_array(head.value_pointers, head.supernodes + 1)
    solution = np.array(columns, dtype=np.float64, order="C")
    reached = np.searchsorted((columns != 0.0).argmax(axis=0), starts - starts[first])
    offset = starts[first]
    for k in range(first, head.supernodes):
        height, width = rows_from[k + 1] - rows_from[k], starts[k + 1] - starts[k]
        rows = _long_array(head.indices + 8 * int(rows_from[k]), int(height))[width:] - offset
        values = (ctypes.c_double * int(height * width)).from_address(
            head.x + 8 * int(values_from[k])
        )
        L = np.ctypeslib.as_array(values).reshape(width, height).T
        own, active = slice(starts[k] - offset, starts[k + 1] - offset), slice(reached[k + 1])
        solved = solve_triangular(L[:width], solution[own, active], lower=True, check_finite=False)
        solution[own, active] = solved
        solution[rows, active] -= L[width:] @ solved
    return solution


@cache
def _library() -> _Library | None:
    try:
        # PyDLL keeps Python's lock, so that two threads never share the workspace.
        functions = ctypes.PyDLL(cholmod.__file__)
        solve, free, start = (
            functions.cholmod_l_solve,
            functions.cholmod_l_free_dense,
            functions.cholmod_l_start,
        )
    except (AttributeError, OSError):
        return None
    dense = ctypes.POINTER(_Dense)
    solve.restype = dense
    solve.argtypes = [ctypes.c_int, ctypes.c_void_p, dense, ctypes.c_void_p]
    free.argtypes = [ctypes.POINTER(dense), ctypes.c_void_p]
    common = ctypes.create_string_buffer(_COMMON_BYTES)
    start(common)
    return _Library(functions, common)


def solve_columns(factor: Any, columns: Array) -> Array:
    """A⁻¹ times `columns` (n×k, Fortran order) with a numeric factor of A, all k at once."""
    library = _library()
    n, k = columns.shape
    if library is None:
        solution = cvxopt_matrix(columns)
        cholmod.solve(factor, solution)
        return np.array(solution)
    right = _Dense(n, k, n * k, n, columns.ctypes.data, None, _REAL, _DOUBLE)
    found = library.functions.cholmod_l_solve(
        _SYSTEM_A, ctypes.addressof(_head(factor)), ctypes.byref(right), library.common
    )
    if not found:
        raise MemoryError("no memory for the solution vectors of a sparse factor")
    view = (ctypes.c_double * (n * k)).from_address(found.contents.x)
    solution = np.array(np.ctypeslib.as_array(view)).reshape(k, n).T
    library.functions.cholmod_l_free_dense(ctypes.byref(found), library.common)
    return solution
