"""What a superelement is as a rigid body: its motions, and the mass that they move."""

from dataclasses import dataclass

import numpy as np

from fem.reduction.superelement import ENDS, end_motions
from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.mechanism.body_model import LegMatrices


@dataclass(frozen=True)
class MassProperties:
    """Mass (kg), centre of mass (3, m from the root) and inertia (3×3, kg m²) about it."""

    mass: float
    centre: Array
    inertia: Array


def rigid_motions(leg: LegMatrices) -> Array:
    """Unknowns (r×6) of a superelement in the rigid motions about its root: no amplitudes."""
    return np.vstack([end_motions(leg.length), np.zeros((leg.size - ENDS, 6))])


def mass_properties(leg: LegMatrices, motions: Array) -> MassProperties:
    """What the mass matrix says of the rigid leg; raises ComputationError without mass."""
    rigid = motions.T @ (leg.mass @ motions)
    mass = float(rigid[0, 0])
    if not mass > 0.0:
        raise ComputationError(f"{leg.model} leg: its mass matrix has no mass along x")
    # Upper right block m [c]ᵀ: a rotation about the root moves the centre c by φ × c.
    moment = rigid[:3, 3:] / mass
    centre = np.array([moment[1, 2], moment[2, 0], moment[0, 1]])
    square = centre @ centre * np.eye(3) - np.outer(centre, centre)
    return MassProperties(mass, centre, rigid[3:, 3:] - mass * square)
