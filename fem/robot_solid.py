"""The whole robot with solid legs and no reduction: sparse statics and modes of a mechanism.

The same as lumped.biglide_assembly's dense solutions, for hundreds of thousands of unknowns.
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from fem.reduction.superelement import ENDS
from fem.solvers.cholesky import analyse, factorise
from fem.solvers.factor import Factor
from lumped.arrays import Array
from lumped.balance import balanced_flexibility, rounding_of_flexibility
from lumped.biglide_assembly import Mechanism
from lumped.errors import ComputationError
from lumped.modes import Modes, fix_signs

_SEED = 1


@dataclass(frozen=True, eq=False)
class FactorisedRobot:
    """A robot in one posture and the factor of its stiffness."""

    mechanism: Mechanism
    factor: Factor


def factorised_robot(mechanism: Mechanism) -> FactorisedRobot:
    """Factorise the robot's stiffness; raises ComputationError where a part is free to move."""
    stiffness = csr_array(mechanism.stiffness)
    # The legs' interiors come last, node by node; before them lie the bodies of the robot.
    nodes = sum(to_leg.shape[0] - ENDS for to_leg in mechanism.legs) // 3
    bodies = stiffness.shape[0] - 3 * nodes
    symbolic = analyse(stiffness, leading=(bodies,))
    return FactorisedRobot(mechanism, factorise(symbolic, stiffness, mechanism.name))


def compliance(robot: FactorisedRobot) -> Array:
    """6×6 compliance (SI, robot axes) at the loaded point: six unit wrenches together."""
    wrenches = robot.mechanism.loaded.toarray().T
    displacements = robot.factor.solve(wrenches)
    forces = robot.mechanism.stiffness @ displacements
    return balanced_flexibility(wrenches, displacements, forces, robot.mechanism.name)


def rounding(robot: FactorisedRobot) -> Array:
    """What the rounding of the stiffness matrix leaves open of the compliance (6×6, SI, 95 %)."""
    mechanism = robot.mechanism
    displacements = robot.factor.solve(mechanism.loaded.toarray().T)
    return rounding_of_flexibility(mechanism.stiffness, displacements, mechanism.turned)


def modes(robot: FactorisedRobot, count: int) -> Modes:
    """The lowest `count` modes (Hz; shapes n×count in robot unknowns, mass-normalised).

    Shift-invert Lanczos about zero from a fixed start. The feet have no mass, so the start and all
    that follows lies in the range of K⁻¹M, where the mass is positive. Raises ComputationError
    where it does not converge.
    """
    mass, solve = csr_array(robot.mechanism.mass), robot.factor.solve
    inverse = LinearOperator(mass.shape, matvec=solve, dtype=np.float64)
    noise = np.random.default_rng(_SEED).standard_normal(mass.shape[0])
    try:
        values, vectors = eigsh(
            mass, count, M=mass, sigma=0.0, OPinv=inverse, v0=solve(mass @ noise)
        )
    except ArpackNoConvergence as error:
        raise ComputationError(
            f"{robot.mechanism.name}: {len(error.eigenvalues)} of {count} modes converged; "
            "fewer modes or a finer mesh are needed"
        ) from error
    order = np.argsort(values)
    return Modes(np.sqrt(values[order]) / (2.0 * np.pi), fix_signs(vectors[:, order]))
