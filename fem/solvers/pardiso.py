"""MKL PARDISO (pypardiso, the optional extra `mkl`) as a backend of fem.solvers.cholesky."""

import weakref
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fem.solvers.factor import NotPositiveDefiniteError, Symbolic
from lumped.arrays import Array, SparseMatrix
from lumped.errors import ComputationError

_POSITIVE_DEFINITE, _INDEFINITE = 2, -2
_ANALYSIS, _NUMERIC, _SOLVE = 11, 22, 33
_NOT_POSITIVE_DEFINITE = -4
# Numbers (from 1) of PARDISO's parameters and reports.
_PEAK_OF_ANALYSIS, _KEPT_BY_ANALYSIS, _NUMERIC_MEMORY = 15, 16, 17
_POSITIVE, _NEGATIVE, _FAILED_AT = 22, 23, 30
# An eigenvalue of a small dense matrix below this part of its largest has no sign.
_ZERO = 1e-12


def _solver(kind: int) -> Any:
    try:
        from pypardiso import PyPardisoSolver  # noqa: PLC0415  the extra is optional
    except ImportError as error:
        raise ComputationError(
            "linear solver 'mkl': pypardiso is not installed (pip install 'flexproof[mkl]')"
        ) from error
    solver = PyPardisoSolver(mtype=kind)
    # Without this, memory outside Python's sight stays taken until the process ends.
    weakref.finalize(solver, _free, solver.__dict__, type(solver))
    return solver


def _free(state: dict[str, Any], kind: Any) -> None:
    solver = kind.__new__(kind)
    solver.__dict__ = state
    solver.free_memory()


def _call(solver: Any, phase: int, triangle: SparseMatrix, right_hand_sides: Array) -> Array:
    # pypardiso's public solve() compares the matrix with a stored copy at every call.
    solver.set_phase(phase)
    return np.asarray(solver._call_pardiso(triangle, right_hand_sides))


def analyse(triangle: SparseMatrix) -> Symbolic:
    """Analyse an upper `triangle` (csr); PARDISO keeps its own METIS order."""
    n = triangle.shape[0]
    nothing = np.zeros((n, 1))

    def analysed() -> Any:
        solver = _solver(_POSITIVE_DEFINITE)
        _call(solver, _ANALYSIS, triangle, nothing)
        return solver

    # The analysed solver serves the first factorisation, later ones make their own.
    unused = [analysed()]
    kilobytes = max(
        unused[0].get_iparm(_PEAK_OF_ANALYSIS),
        int(unused[0].get_iparm(_KEPT_BY_ANALYSIS)) + int(unused[0].get_iparm(_NUMERIC_MEMORY)),
    )

    def numeric(part: str) -> PardisoFactor:
        from pypardiso.pardiso_wrapper import PyPardisoError  # noqa: PLC0415  the extra is optional

        solver = unused.pop() if unused else analysed()
        try:
            _call(solver, _NUMERIC, triangle, nothing)
        except PyPardisoError as error:
            if error.value == _NOT_POSITIVE_DEFINITE:
                unknown = int(solver.get_iparm(_FAILED_AT)) - 1
                raise NotPositiveDefiniteError(part, unknown) from None
            said = f"{part}: MKL PARDISO failed with error {error.value}"
            raise ComputationError(said) from error
        return PardisoFactor(triangle, solver)

    return Symbolic(n, None, 1024 * int(kilobytes), numeric)


@dataclass(frozen=True, eq=False)
class PardisoFactor:
    """Numeric factor of MKL PARDISO."""

    triangle: SparseMatrix = field(repr=False)
    solver: Any = field(repr=False)

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        columns = np.asfortranarray(right_hand_sides, dtype=np.float64)
        if not columns.size:
            return np.zeros_like(columns)
        return _call(self.solver, _SOLVE, self.triangle, columns)


def inertia(triangle: SparseMatrix, constraints: Array | None = None) -> tuple[int, int, int]:
    """Negative, zero and positive eigenvalues of a symmetric matrix A, from its upper triangle.

    With `constraints` B (n×c) those of A on Bᵀx = 0: A has them and, by Haynsworth's theorem on
    [A B; Bᵀ 0], the c of −BᵀA⁻¹B less c of either sign.
    """
    solver = _solver(_INDEFINITE)
    n = triangle.shape[0]
    _call(solver, _ANALYSIS + 1, triangle, np.zeros((n, 1)))
    negative, positive = int(solver.get_iparm(_NEGATIVE)), int(solver.get_iparm(_POSITIVE))
    zero = n - negative - positive
    if constraints is None or zero:
        return negative, zero, positive
    columns = np.asfortranarray(constraints, dtype=np.float64)
    border = -constraints.T @ _call(solver, _SOLVE, triangle, columns)
    values = np.linalg.eigvalsh((border + border.T) / 2.0)
    small = np.abs(values) <= _ZERO * np.abs(values).max()
    c = constraints.shape[1]
    return (
        negative + int((values[~small] < 0.0).sum()) - c,
        int(small.sum()),
        positive + int((values[~small] > 0.0).sum()) - c,
    )
