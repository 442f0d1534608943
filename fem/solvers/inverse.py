"""Statics of a supported solid: by a factor, or without one if it does not fit the memory.

Without a factor, PETSc computes by conjugate gradients with the multigrid GAMG. Each solution is
checked by its residual and its energy. Such solutions do not give the signs of eigenvalues: modes
are counted only if a factor of K − σM, which is computed for this purpose alone, fits the memory.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from fem.machine import available_memory
from fem.solvers.backends.petsc.iteration import GamgIteration, IndefiniteError, SolutionCheck
from fem.solvers.backends.protocol import HOST, Space
from fem.solvers.factor import NotPositiveDefiniteError, RenewableFactor, Symbolic
from lumped.arrays import Array
from lumped.solver_request import Solver, requested_solver


@dataclass(eq=False)
class _GamgInverse:
    """Inverse K⁻¹ by GAMG. Raises NotPositiveDefiniteError and ComputationError."""

    iteration: GamgIteration
    part: str

    def solve(self, right_hand_sides: Any) -> Any:
        """K⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        columns = right_hand_sides.reshape(len(right_hand_sides), -1)
        try:
            solution = self.iteration.solve(columns)
        except IndefiniteError:
            raise NotPositiveDefiniteError(self.part) from None
        return solution.reshape(right_hand_sides.shape)


@dataclass(eq=False)
class RenewableIteration(RenewableFactor):
    """Multigrid solver that is released if a factor needs its memory, and set up again when needed.

    `motions` (n×6) are the rigid motions of the body, `places` (n×3, in m) the positions of its
    unknowns.
    """

    motions: Array
    places: Array

    @cached_property
    def numeric(self) -> _GamgInverse:
        """The iterative solver, which is set up when it is first needed."""
        triangle = self.symbolic.triangle
        iteration = GamgIteration(triangle, self.motions, self.places, self.part)
        return _GamgInverse(iteration, self.part)

    def precondition(self, forces: Array) -> Array:
        """Approximate displacements (n×k) under `forces` (n×k), by one cycle of the multigrid."""
        return self.numeric.iteration.precondition(forces)

    @property
    def checks(self) -> tuple[SolutionCheck, ...]:
        """Accuracy of the last solutions, one entry for each right-hand side."""
        numeric = vars(self).get("numeric")
        return numeric.iteration.checks if isinstance(numeric, _GamgInverse) else ()

    @property
    def space(self) -> Space:
        """Memory in which right-hand sides are used: that of the host."""
        return HOST

    @cached_property
    def countable(self) -> bool:
        """True if a factor of K − σM fits the memory."""
        return _fits(self.symbolic)


def inverse(symbolic: Symbolic, motions: Array, places: Array, part: str) -> RenewableFactor:
    """Inverse K⁻¹ of the stiffness of a supported solid (n unknowns), by a factor or by GAMG.

    GAMG is used if it is requested, or if PETSc is requested and a factor does not fit the
    available memory. `motions` and `places` are those of `RenewableIteration`. `part` is the name
    of the matrix in messages. The factor or multigrid is computed at once. Raises
    NotPositiveDefiniteError if the solid is not sufficiently supported, ComputationError if the
    computation fails.
    """
    request = requested_solver()
    if request is Solver.GAMG or (request is Solver.PETSC and not _fits(symbolic)):
        symbolic.analysis.give_up()
        iteration = RenewableIteration(symbolic, part, motions, places)
        symbolic.require_support(iteration.solve, part)
        return iteration
    factor = RenewableFactor(symbolic, part)
    _ = factor.numeric
    return factor


def _fits(symbolic: Symbolic) -> bool:
    """True if a factor fits the available memory."""
    available = available_memory()
    return available is None or symbolic.peak_bytes <= available
