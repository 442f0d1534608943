"""A mechanism of bodies that are not reduced: sparse statics and modes of a system.

The same as `lumped.system.solution`, for hundreds of thousands of unknowns, nothing idle.
"""

from dataclasses import dataclass

from scipy.sparse import csr_array

from fem.solvers.cholesky import analyse, factorise
from fem.solvers.factor import Factor
from fem.solvers.modes import searched_modes
from lumped.arrays import Array
from lumped.dense.balance import balanced_flexibility
from lumped.dense.modes import Modes
from lumped.system.assembly import System


@dataclass(frozen=True, eq=False)
class FactorisedSystem:
    """A mechanism in one posture and the factor of its stiffness."""

    system: System
    factor: Factor


def factorised(system: System) -> FactorisedSystem:
    """Factorise the stiffness; raises ComputationError where a part is free to move."""
    stiffness = csr_array(system.stiffness)
    # The bodies' insides come last, node by node; before them lie the nodes of the mechanism.
    symbolic = analyse(stiffness, leading=(system.outer,))
    return FactorisedSystem(system, factorise(symbolic, stiffness, system.name))


def compliance(found: FactorisedSystem) -> Array:
    """6×6 compliance (SI, base axes) at the loaded point: six unit wrenches together."""
    wrenches = found.system.tool.T
    displacements = found.factor.solve(wrenches)
    forces = found.system.stiffness @ displacements
    return balanced_flexibility(wrenches, displacements, forces, found.system.name)


def modes(found: FactorisedSystem, count: int) -> Modes:
    """The lowest `count` modes (Hz; shapes n×count, mass-normalised).

    Joints have no mass: the search looks where the mass is positive. Raises ComputationError where
    it does not converge.
    """
    mass = csr_array(found.system.mass)
    return searched_modes(found.factor, mass, count, found.system.name)
