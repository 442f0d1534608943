"""What cvxopt's CHOLMOD can do but does not pass on: block solves, and threads.

cvxopt solves several right-hand sides one by one, each reading the whole factor again;
`cholmod_l_solve` of the same shared library reads it once. cvxopt keeps Python's lock while it
computes; called from here, each in a workspace of its own, factorisations and solves run beside
each other (the wheels' BLAS has one thread and locks its buffers).
"""

import ctypes
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

import numpy as np
from cvxopt import cholmod

from fem.solvers.cholmod.supernodes import factor_head
from lumped.arrays import Array, SparseMatrix

SYSTEM_A, SYSTEM_L, SYSTEM_LT = 0, 4, 5
_REAL, _DOUBLE = 1, 0
_LOWER, _LONG = -1, 2
# `cholmod_common` is some 3 kB; how much it prints stands at this byte of it.
_COMMON_BYTES, _PRINT_AT = 1 << 16, 144
_PRINTS_WARNINGS = 3


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


class _Sparse(ctypes.Structure):
    _fields_ = (
        ("nrow", ctypes.c_size_t),
        ("ncol", ctypes.c_size_t),
        ("nzmax", ctypes.c_size_t),
        ("p", ctypes.c_void_p),
        ("i", ctypes.c_void_p),
        ("nz", ctypes.c_void_p),
        ("x", ctypes.c_void_p),
        ("z", ctypes.c_void_p),
        ("stype", ctypes.c_int),
        ("itype", ctypes.c_int),
        ("xtype", ctypes.c_int),
        ("dtype", ctypes.c_int),
        ("sorted", ctypes.c_int),
        ("packed", ctypes.c_int),
    )


@cache
def library() -> Any:
    """The shared library, called without Python's lock; None where its symbols are hidden."""
    try:
        functions = ctypes.CDLL(cholmod.__file__)
        solve, free = functions.cholmod_l_solve, functions.cholmod_l_free_dense
        factorise = functions.cholmod_l_factorize
        start, finish = functions.cholmod_l_start, functions.cholmod_l_finish
    except (AttributeError, OSError):
        return None
    pointer, dense = ctypes.c_void_p, ctypes.POINTER(_Dense)
    solve.restype = dense
    solve.argtypes = [ctypes.c_int, pointer, dense, pointer]
    free.argtypes = [ctypes.POINTER(dense), pointer]
    factorise.argtypes = [ctypes.POINTER(_Sparse), pointer, pointer]
    start.argtypes = finish.argtypes = [pointer]
    return functions


@contextmanager
def _workspace(functions: Any) -> Iterator[Any]:
    """CHOLMOD's own `cholmod_common`, one for each call: two threads must not share it."""
    common = ctypes.create_string_buffer(_COMMON_BYTES)
    functions.cholmod_l_start(common)
    prints = ctypes.c_int.from_buffer(common, _PRINT_AT)
    # Otherwise a matrix that is not positive definite is announced on the terminal.
    if prints.value == _PRINTS_WARNINGS:
        prints.value = 0
    try:
        yield common
    finally:
        functions.cholmod_l_finish(common)


def factorise_beside(factor: Any, triangle: SparseMatrix) -> int:
    """Fill an analysed `factor` with that of an upper triangle (csr), without Python's lock.

    Returns the place in the order of elimination where a pivot was not positive, n where none
    was. Raises MemoryError.
    """
    functions, head = library(), factor_head(factor)
    # Read by columns the triangle is the lower one.
    pointers, rows = (a.astype(np.int64) for a in (triangle.indptr, triangle.indices))
    values = np.ascontiguousarray(triangle.data, dtype=np.float64)
    matrix = _Sparse(
        nrow=head.n,
        ncol=head.n,
        nzmax=len(values),
        p=pointers.ctypes.data,
        i=rows.ctypes.data,
        x=values.ctypes.data,
        stype=_LOWER,
        itype=_LONG,
        xtype=_REAL,
        dtype=_DOUBLE,
        sorted=1,
        packed=1,
    )
    with _workspace(functions) as common:
        done = functions.cholmod_l_factorize(ctypes.byref(matrix), ctypes.addressof(head), common)
    if not done:
        raise MemoryError("no memory for a sparse factor")
    return int(head.minor)


def solve_columns(factor: Any, columns: Array, system: int = SYSTEM_A) -> Array:
    """A⁻¹, L⁻¹ or L⁻ᵀ times `columns` (n×k, Fortran order) with a numeric factor, all k at once.

    By L the rows are in the order of elimination.
    """
    functions = library()
    n, k = columns.shape
    right = _Dense(n, k, n * k, n, columns.ctypes.data, None, _REAL, _DOUBLE)
    with _workspace(functions) as common:
        found = functions.cholmod_l_solve(
            system, ctypes.addressof(factor_head(factor)), ctypes.byref(right), common
        )
        if not found:
            raise MemoryError("no memory for the solution vectors of a sparse factor")
        view = (ctypes.c_double * (n * k)).from_address(found.contents.x)
        solution = np.array(np.ctypeslib.as_array(view)).reshape(k, n).T
        functions.cholmod_l_free_dense(ctypes.byref(found), common)
    return solution
