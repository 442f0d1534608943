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
    view = (ctypes.c_int64 * count).from_address(address)
    return np.array(np.ctypeslib.as_array(view), dtype=np.int64)


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
