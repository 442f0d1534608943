"""Sparse Cholesky factorisation K = L Lᵀ behind one small interface.

Two backends: CHOLMOD from cvxopt with METIS orderings (the default), and MKL PARDISO (optional
extra `mkl`). The environment variable FLEXPROOF_SOLVER (`cholmod` or `mkl`) chooses the default.
One order of elimination serves all matrices of one pattern.
"""

import os
from collections import deque
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, Protocol, TypeAlias

import numpy as np
from cvxopt import cholmod, spmatrix
from cvxopt import matrix as cvxopt_matrix
from scipy.sparse import csr_array

from fem.cholmod_library import (
    FactorStatistics,
    elimination_order,
    solve_columns,
    statistics,
)
from fem.ordering import block_graph, nested_dissection
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.errors import ComputationError, InputError

Backend: TypeAlias = Literal["cholmod", "mkl"]

# Right-hand sides solved together: beyond some thirty the time per solve no longer falls.
_COLUMNS_AT_ONCE = 32
# A pivot that lost this part of its diagonal entry is rounding error: the matrix is singular.
_SINGULAR_PIVOT = 100.0 * np.finfo(np.float64).eps
# cvxopt's matrix, its packed copy and CHOLMOD's permuted one; row (8 bytes) and value of each.
_MATRIX_COPIES = 3

# The order given is the one wanted: no second ordering is tried. CHOLMOD's options are global to
# the process, so they are set once, here.
cholmod.options["supernodal"] = 2
cholmod.options["nmethods"] = 1


class NotPositiveDefiniteError(ComputationError):
    """A Cholesky factorisation met a pivot that is not positive; `unknown` is its number."""

    def __init__(self, part: str, unknown: int, cause: str) -> None:
        self.unknown = unknown
        super().__init__(f"{part}: {cause} at unknown {unknown}")


class Factor(Protocol):
    """A factorised symmetric positive definite matrix."""

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        ...


@dataclass(frozen=True, eq=False)
class Symbolic:
    """Pattern and elimination order of a symmetric matrix, with what its factor will cost.

    `pointers`, `columns`: the upper triangle (csr). `factor_entries` of L; `flops` of the
    factorisation; `peak_bytes`, the memory it takes at its height. `order` is empty for backends
    that keep their own.
    """

    backend: Backend
    size: int
    pointers: IntArray
    columns: IntArray
    order: IntArray
    factor_entries: int
    flops: float
    peak_bytes: int
    # The analysed factor and its matrix: taken by the first factorisation, made anew by later ones.
    unused: deque[Any] = field(repr=False)


@dataclass(frozen=True, eq=False)
class CholmodFactor:
    """Numeric factor of CHOLMOD."""

    size: int
    handle: Any = field(repr=False)

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        columns = np.asfortranarray(right_hand_sides, dtype=np.float64).reshape(
            self.size, -1, order="F"
        )
        blocks = [
            solve_columns(self.handle, columns[:, start : start + _COLUMNS_AT_ONCE])
            for start in range(0, columns.shape[1], _COLUMNS_AT_ONCE)
        ]
        if not blocks:
            return np.zeros_like(right_hand_sides, dtype=np.float64)
        return np.hstack(blocks).reshape(right_hand_sides.shape)


def default_backend() -> Backend:
    """`cholmod`, unless the environment variable FLEXPROOF_SOLVER says `mkl`.

    Raises InputError for any other value.
    """
    name = os.environ.get("FLEXPROOF_SOLVER", "cholmod")
    if name == "cholmod":
        return "cholmod"
    if name == "mkl":
        return "mkl"
    raise InputError(f"FLEXPROOF_SOLVER = {name!r}: must be 'cholmod' or 'mkl'")


def backend_name(backend: Backend) -> str:
    """What a report calls the backend."""
    return {"cholmod": "CHOLMOD (cvxopt) with METIS", "mkl": "MKL PARDISO"}[backend]


def upper_triangle(matrix: SparseMatrix) -> SparseMatrix:
    """Upper triangle of a symmetric matrix (csr, sorted columns, explicit zeros kept).

    Read by columns, the same three arrays are the lower triangle.
    """
    matrix = csr_array(matrix)
    if not matrix.has_canonical_format:
        matrix = matrix.copy()
        matrix.sum_duplicates()
    n = matrix.shape[0]
    rows = np.repeat(np.arange(n, dtype=matrix.indices.dtype), np.diff(matrix.indptr))
    upper = matrix.indices >= rows
    pointers = np.concatenate([[0], np.cumsum(np.bincount(rows[upper], minlength=n))])
    triangle = csr_array(
        (
            matrix.data[upper].astype(np.float64, copy=False),
            matrix.indices[upper],
            pointers.astype(matrix.indptr.dtype),
        ),
        shape=(n, n),
    )
    triangle.has_canonical_format = True
    return triangle


def values_on_pattern(symbolic: Symbolic, triangle: SparseMatrix) -> Array:
    """Values of an upper `triangle` at the places of the analysed pattern, zero where absent.

    Raises ComputationError for an entry outside the pattern.
    """
    if np.array_equal(triangle.indptr, symbolic.pointers) and np.array_equal(
        triangle.indices, symbolic.columns
    ):
        return np.asarray(triangle.data)
    n, count = symbolic.size, len(symbolic.columns)
    if triangle.shape != (n, n):
        raise ComputationError(
            f"matrix of order {triangle.shape[0]} given to the analysis of one of order {n}"
        )
    places = csr_array((np.arange(1.0, count + 1.0), symbolic.columns, symbolic.pointers), (n, n))
    ones = csr_array((np.ones(triangle.nnz), triangle.indices, triangle.indptr), (n, n))
    common = csr_array(places.multiply(ones))
    common.sort_indices()
    if common.nnz != triangle.nnz:
        raise ComputationError("matrix has entries outside the pattern that was analysed")
    values = np.zeros(count)
    values[common.data.astype(np.int64) - 1] = triangle.data
    return values


def available_memory() -> int | None:
    """Bytes that a new computation may take on this machine, None where it cannot be told."""
    limits = []
    meminfo = Path("/proc/meminfo")
    if meminfo.exists():
        fields = dict(line.split(":", 1) for line in meminfo.read_text().splitlines())
        if "MemAvailable" in fields:
            limits.append(1024 * int(fields["MemAvailable"].split()[0]))
    group = Path("/sys/fs/cgroup")
    if (group / "memory.max").exists() and (group / "memory.current").exists():
        limit = (group / "memory.max").read_text().strip()
        if limit != "max":
            limits.append(int(limit) - int((group / "memory.current").read_text()))
    if not limits and "SC_PHYS_PAGES" in os.sysconf_names:
        limits.append(os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE"))
    return min(limits) if limits else None


def refuse_beyond_memory(symbolic: Symbolic, part: str) -> None:
    """Raise ComputationError where the factorisation would take more memory than there is."""
    available = available_memory()
    if available is not None and symbolic.peak_bytes > available:
        raise ComputationError(
            f"{part}: factorising {symbolic.size} unknowns needs about "
            f"{symbolic.peak_bytes / 1e9:.1f} GB and {available / 1e9:.1f} GB are available: use "
            "fewer divisions, a shorter leg, or condensation by doubling (statics)"
        )


def _peak_bytes(counts: FactorStatistics, matrix_entries: int) -> int:
    factor = counts.stored_entries + counts.index_entries + counts.update_entries
    return 8 * factor + _MATRIX_COPIES * 16 * matrix_entries


def cvxopt_triangle(triangle: SparseMatrix) -> Any:
    """Cvxopt's matrix whose lower triangle is the transpose of an upper `triangle` (csr)."""
    return _cvxopt_matrix(triangle.indptr, triangle.indices, triangle.data)


def _cvxopt_matrix(pointers: IntArray, columns: IntArray, values: Array) -> Any:
    """Cvxopt's matrix whose lower triangle is the transpose of the given upper one."""
    n = len(pointers) - 1
    column_of = np.repeat(np.arange(n, dtype=np.int64), np.diff(pointers))
    return spmatrix(
        cvxopt_matrix(np.ascontiguousarray(values)),
        cvxopt_matrix(columns.astype(np.int64)),
        cvxopt_matrix(column_of),
        (n, n),
    )


def analyse(
    matrix: SparseMatrix, leading: tuple[int, ...] = (), backend: Backend | None = None
) -> Symbolic:
    """Order the unknowns of a symmetric matrix (csr n×n) and count the entries of its factor.

    `leading`: sizes of the blocks of unknowns before the nodes of three (see fem.ordering).
    `backend` None means `default_backend()`. Raises ComputationError where the backend is missing.
    """
    chosen = backend or default_backend()
    triangle = upper_triangle(matrix)
    if chosen == "mkl":
        from fem import pardiso  # noqa: PLC0415  the extra is optional

        return pardiso.analyse(triangle)
    order = nested_dissection(block_graph(csr_array(matrix), leading))
    template = cvxopt_triangle(triangle)
    factor = cholmod.symbolic(template, cvxopt_matrix(order))
    counts = statistics(factor)
    return Symbolic(
        backend="cholmod",
        size=matrix.shape[0],
        pointers=triangle.indptr,
        columns=triangle.indices,
        order=order,
        factor_entries=counts.entries,
        flops=counts.flops,
        peak_bytes=_peak_bytes(counts, triangle.nnz),
        unused=deque([(factor, template)]),
    )


def factorise(symbolic: Symbolic, matrix: SparseMatrix, part: str = "stiffness matrix") -> Factor:
    """Factorise a symmetric positive definite matrix (csr n×n) of the analysed pattern.

    Entries may be missing from the pattern, none may lie outside. `part` names the matrix in
    errors. Raises NotPositiveDefiniteError, a ComputationError, where a pivot is not positive or
    is lost in rounding, and ComputationError, before it starts, where memory will not suffice.
    """
    refuse_beyond_memory(symbolic, part)
    triangle = upper_triangle(matrix)
    values = values_on_pattern(symbolic, triangle)
    if symbolic.backend == "mkl":
        from fem import pardiso  # noqa: PLC0415  the extra is optional

        return pardiso.factorise(symbolic, values, part)
    try:
        handle, template = symbolic.unused.pop()
    except IndexError:
        template = _cvxopt_matrix(symbolic.pointers, symbolic.columns, values)
        handle = cholmod.symbolic(template, cvxopt_matrix(symbolic.order))
    else:
        template.V = cvxopt_matrix(np.ascontiguousarray(values))
    diagonal = triangle.diagonal()
    del triangle, values
    cause = (
        "the matrix is not positive definite (a part free to move as a rigid body, a negative "
        "material constant, or a shift above the first eigenvalue)"
    )
    try:
        cholmod.numeric(template, handle)
    except ArithmeticError as error:
        unknown = int(elimination_order(handle)[error.args[0]])
        raise NotPositiveDefiniteError(part, unknown, cause) from None
    except MemoryError:
        raise ComputationError(
            f"{part}: memory ran out in the factorisation of {symbolic.size} unknowns"
        ) from None
    eliminated = elimination_order(handle)
    pivots = np.array(cholmod.diag(handle)).ravel() ** 2 / diagonal[eliminated]
    smallest = int(np.argmin(pivots))
    if pivots[smallest] < _SINGULAR_PIVOT:
        raise NotPositiveDefiniteError(part, int(eliminated[smallest]), cause)
    return CholmodFactor(symbolic.size, handle)
