"""What a specialist checks on a superelement before using it."""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from fem.reduction.superelement import ENDS, end_motions
from fem.solvers.cholesky import analyse, factorise
from lumped.arrays import Array, SparseMatrix
from lumped.errors import ComputationError
from lumped.mechanism.body_model import LegMatrices

_SEED = 1


@dataclass(frozen=True)
class MassProperties:
    """Mass (kg), centre of mass (3, m from the root) and inertia (3×3, kg m²) about it."""

    mass: float
    centre: Array
    inertia: Array


def rigid_motions(leg: LegMatrices) -> Array:
    """Unknowns (r×6) of a superelement in the rigid motions about its root: no amplitudes."""
    return np.vstack([end_motions(leg.length), np.zeros((leg.size - ENDS, 6))])


def rigid_body_residual(leg: LegMatrices, motions: Array) -> float:
    """Largest force of a rigid motion (n×6), as a share of the largest entry of the stiffness.

    Rotations are counted by the leg's length, so that all entries are N/m.
    """
    unit = np.array([1.0, 1.0, 1.0, *[1.0 / leg.length] * 3])
    rows = np.ones(leg.size)
    rows[:ENDS] = np.tile(unit, 2)
    scaled = csr_array(leg.stiffness).multiply(rows[:, None]).multiply(rows)
    forces = rows[:, None] * (leg.stiffness @ motions) * unit
    return float(np.abs(forces).max() / abs(scaled).max())


def grounding(leg: LegMatrices, motions: Array) -> Array:
    """Strain energy of the six rigid motions (6) over that of the tip alone moving as much."""
    energy = np.einsum("ij,ij->j", motions, leg.stiffness @ motions)
    tip_alone = csr_array(leg.stiffness).diagonal()[6:ENDS]
    return np.asarray(np.abs(energy) / tip_alone)


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


def asymmetry(matrix: SparseMatrix) -> float:
    """Largest difference between a matrix and its transpose, as a share of its largest entry."""
    return float(abs(matrix - matrix.T).max() / abs(matrix).max())


def free_frequencies(leg: LegMatrices, count: int, shift_frequency: float) -> Array:
    """The lowest `count` elastic frequencies (Hz) of the leg with nothing held.

    Lanczos on (K + σM)⁻¹ M, σ = (2π `shift_frequency`)², positive definite although the leg floats;
    a shift near the first frequency is best. The mass must be positive definite. The six rigid
    motions are left out. Raises ComputationError where it does not converge.
    """
    stiffness, mass = csr_array(leg.stiffness), csr_array(leg.mass)
    sigma = (2.0 * np.pi * shift_frequency) ** 2
    shifted = csr_array(stiffness + sigma * mass)
    symbolic = analyse(shifted, leading=(ENDS + (leg.size - ENDS) % 3,))
    factor = factorise(symbolic, shifted, f"{leg.model} leg, free")
    inverse = LinearOperator(mass.shape, matvec=factor.solve, dtype=np.float64)
    noise = np.random.default_rng(_SEED).standard_normal(leg.size)
    try:
        values = eigsh(
            stiffness,
            count + 6,
            M=mass,
            sigma=-sigma,
            OPinv=inverse,
            v0=factor.solve(mass @ noise),
            return_eigenvectors=False,
        )
    except ArpackNoConvergence as error:
        raise ComputationError(
            f"{leg.model} leg, free: {len(error.eigenvalues)} of {count + 6} modes converged"
        ) from error
    return np.asarray(np.sqrt(np.sort(values)[6:]) / (2.0 * np.pi))
