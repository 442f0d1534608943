"""Sparse Cholesky factorisation K = L Lᵀ behind one small interface.

Two backends: CHOLMOD from cvxopt with METIS orderings (the default), and MKL PARDISO (optional
extra `mkl`). The environment variable FLEXPROOF_SOLVER (`cholmod` or `mkl`) chooses.
CHOLMOD's factor is read where it is what it is taken for (fem.solvers.cholmod.whole_factor).
CHOLMOD's wheel has one thread, so a large matrix is eliminated in two halves at once where there
are two cores (fem.solvers.cholmod.bisected_factor).
"""

import os
from dataclasses import dataclass
from functools import cached_property

from fem.machine import available_memory, threads
from fem.solvers.cholmod import bisected_factor, whole_factor
from fem.solvers.cholmod.kernel import kernel
from fem.solvers.cholmod.whole_factor import factors_are_readable
from fem.solvers.factor import Factor, Symbolic, upper_triangle
from fem.solvers.ordering import Elimination, bisection, block_graph, nested_dissection
from lumped.arrays import Array, SparseMatrix
from lumped.errors import InputError

# Unknowns from which two halves take less time than the whole, although they fill in 5 % more.
_BISECTED = 60_000
# Two factors at once where the memory that is left holds this many more; the machine is not ours.
_ROOM = 4


def backend() -> str:
    """`cholmod`, unless the environment variable FLEXPROOF_SOLVER says `mkl`.

    Raises InputError for any other value.
    """
    name = os.environ.get("FLEXPROOF_SOLVER", "cholmod")
    if name not in {"cholmod", "mkl"}:
        raise InputError(f"FLEXPROOF_SOLVER = {name!r}: must be 'cholmod' or 'mkl'")
    return name


def solver_name() -> str:
    """What a report calls the backend, and how it is reached where that is slower."""
    if backend() == "mkl":
        return "MKL PARDISO"
    reached = "" if factors_are_readable() else ", by cvxopt's public interface (slower)"
    named = f", {kernel()} kernel" if kernel() else ""
    return f"CHOLMOD (cvxopt{named}) with METIS{reached}"


def analyse(
    matrix: SparseMatrix, leading: tuple[int, ...] = (), elimination: Elimination | None = None
) -> Symbolic:
    """Order the unknowns of a symmetric matrix (csr n×n) and count the entries of its factor.

    The upper triangle of the matrix is enough.
    `leading`: sizes of the blocks of unknowns before the nodes of three (see fem.solvers.ordering);
    `elimination` one that is known already. Raises ComputationError where the backend is missing,
    or computes wrong products.
    """
    triangle = upper_triangle(matrix)
    if backend() == "mkl":
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
    if elimination.halves and (halves := bisected_factor.analyse(triangle, elimination)):
        return halves
    whole = Elimination(elimination.order)
    return whole_factor.analyse(triangle, whole, readable=factors_are_readable())


@dataclass(eq=False)
class RenewableFactor:
    """A factor that is given up where another one needs its memory, and made anew when asked for.

    `part` names its matrix in errors; these are those of `Symbolic.factorise`.
    """

    symbolic: Symbolic
    part: str

    @cached_property
    def numeric(self) -> Factor:
        """The backend's own factor."""
        return self.symbolic.factorise(self.part)

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        return self.numeric.solve(right_hand_sides)

    def make_room(self) -> None:
        """Release the factor unless a second one beside it takes a small part of the memory."""
        available = available_memory()
        if available is not None and available < _ROOM * self.symbolic.peak_bytes:
            vars(self).pop("numeric", None)
