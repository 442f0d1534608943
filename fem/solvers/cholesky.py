"""Sparse Cholesky factorisation K = L Lᵀ behind one small interface.

Two backends: CHOLMOD from cvxopt with METIS orderings (the default), and MKL PARDISO (optional
extra `mkl`). The environment variable FLEXPROOF_SOLVER (`cholmod` or `mkl`) chooses the default.
CHOLMOD's factor is read where it is what it is taken for (fem.solvers.cholmod.layout).
One order of elimination serves all matrices of one pattern. CHOLMOD's wheel has one thread, so a
large matrix is eliminated in two halves at once where there are two cores
(fem.solvers.cholmod.bisected_factor).
"""

import os

import numpy as np
from scipy.sparse import csr_array

from fem.machine import threads
from fem.solvers.cholmod import bisected_factor, whole_factor
from fem.solvers.cholmod.kernel import kernel
from fem.solvers.cholmod.layout import factors_are_readable
from fem.solvers.factor import Backend, Factor, Symbolic, refuse_beyond_memory, upper_triangle
from fem.solvers.ordering import Elimination, bisection, block_graph, nested_dissection
from lumped.arrays import Array, SparseMatrix
from lumped.errors import ComputationError, InputError

# Unknowns from which two halves take less time than the whole, although they fill in 5 % more.
_BISECTED = 60_000


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


def solver_name() -> str:
    """What a report calls the default backend, and how it is reached where that is slower."""
    if default_backend() == "mkl":
        return "MKL PARDISO"
    reached = "" if factors_are_readable() else ", by cvxopt's public interface (slower)"
    named = f", {kernel()} kernel" if kernel() else ""
    return f"CHOLMOD (cvxopt{named}) with METIS{reached}"


def analyse(
    matrix: SparseMatrix,
    leading: tuple[int, ...] = (),
    backend: Backend | None = None,
    elimination: Elimination | None = None,
) -> Symbolic:
    """Order the unknowns of a symmetric matrix (csr n×n) and count the entries of its factor.

    The upper triangle of the matrix is enough.
    `leading`: sizes of the blocks of unknowns before the nodes of three (see fem.solvers.ordering).
    `backend` None means `default_backend()`; `elimination` one that is known already. Raises
    ComputationError where the backend is missing, or computes wrong products.
    """
    triangle = upper_triangle(matrix)
    if (backend or default_backend()) == "mkl":
        from fem.solvers import pardiso  # noqa: PLC0415  the extra is optional

        return pardiso.analyse(triangle)
    # Once in a process: that its products are right.
    kernel()
    if elimination is None:
        graph = block_graph(triangle, leading)
        if matrix.shape[0] >= _BISECTED and threads() > 1 and factors_are_readable():
            elimination = bisection(graph)
        else:
            elimination = nested_dissection(graph)
    if elimination.halves:
        halves = bisected_factor.analyse(triangle, elimination)
        if halves is not None:
            return halves
    whole = Elimination(elimination.order)
    return whole_factor.analyse(triangle, whole, readable=factors_are_readable())


def factorise(symbolic: Symbolic, matrix: SparseMatrix, part: str = "stiffness matrix") -> Factor:
    """Factorise a symmetric positive definite matrix (csr n×n) of the analysed pattern.

    Its upper triangle is enough. Entries may be missing from the pattern, none may lie outside.
    `part` names the matrix in errors. Raises NotPositiveDefiniteError, a ComputationError, where a
    pivot is not positive or is lost in rounding, and ComputationError, before it starts, where
    memory will not suffice.
    """
    refuse_beyond_memory(symbolic, part)
    return symbolic.numeric(values_on_pattern(symbolic, matrix), part)


def values_on_pattern(symbolic: Symbolic, matrix: SparseMatrix) -> Array:
    """Values of a symmetric matrix at the places of the analysed pattern, zero where absent.

    Raises ComputationError for an entry outside the pattern.
    """
    n, count = symbolic.size, len(symbolic.columns)
    if matrix.shape != (n, n):
        raise ComputationError(
            f"matrix of order {matrix.shape[0]} given to the analysis of one of order {n}"
        )
    triangle = matrix if _has_pattern(symbolic, matrix) else upper_triangle(matrix)
    if _has_pattern(symbolic, triangle):
        return np.asarray(triangle.data)
    places = csr_array((np.arange(1.0, count + 1.0), symbolic.columns, symbolic.pointers), (n, n))
    ones = csr_array((np.ones(triangle.nnz), triangle.indices, triangle.indptr), (n, n))
    common = csr_array(places.multiply(ones))
    common.sort_indices()
    if common.nnz != triangle.nnz:
        raise ComputationError("matrix has entries outside the pattern that was analysed")
    values = np.zeros(count)
    values[common.data.astype(np.int64) - 1] = triangle.data
    return values


def _has_pattern(symbolic: Symbolic, matrix: SparseMatrix) -> bool:
    return (
        matrix.format == "csr"
        and np.array_equal(matrix.indptr, symbolic.pointers)
        and np.array_equal(matrix.indices, symbolic.columns)
    )
