"""A mechanism of bodies that are not reduced: sparse statics and modes of a system.

The same as `lumped.system.solution`, for hundreds of thousands of unknowns, nothing idle.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from fem.solvers.cholesky import analyse, factorise
from fem.solvers.factor import Factor
from lumped.arrays import Array
from lumped.dense.balance import balanced_flexibility
from lumped.dense.modes import Modes, fix_signs
from lumped.errors import ComputationError
from lumped.system.assembly import System

_SEED = 1


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

    Shift-invert Lanczos about zero from a fixed start. Joints have no mass, so the start and all
    that follows lies in the range of K⁻¹M, where the mass is positive. Raises ComputationError
    where it does not converge.
    """
    mass, solve = csr_array(found.system.mass), found.factor.solve
    inverse = LinearOperator(mass.shape, matvec=solve, dtype=np.float64)
    noise = np.random.default_rng(_SEED).standard_normal(mass.shape[0])
    try:
        values, vectors = eigsh(
            mass, count, M=mass, sigma=0.0, OPinv=inverse, v0=solve(mass @ noise)
        )
    except ArpackNoConvergence as error:
        raise ComputationError(
            f"{found.system.name}: {len(error.eigenvalues)} of {count} modes converged; "
            "fewer modes or a finer mesh are needed"
        ) from error
    order = np.argsort(values)
    return Modes(np.sqrt(values[order]) / (2.0 * np.pi), fix_signs(vectors[:, order]))
