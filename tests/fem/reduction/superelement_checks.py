"""What a specialist checks on a superelement before using it."""

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import LinearOperator, eigsh

from fem.reduction.superelement import ENDS
from fem.solvers.cholesky import analyse, factorise


def rigid_body_residual(leg, motions):
    """Largest force of a rigid motion (n×6), as a share of the largest entry of the stiffness.

    Rotations are counted by the leg's length, so that all entries are N/m.
    """
    unit = np.array([1.0, 1.0, 1.0, *[1.0 / leg.length] * 3])
    rows = np.ones(leg.size)
    rows[:ENDS] = np.tile(unit, 2)
    scaled = csr_array(leg.stiffness).multiply(rows[:, None]).multiply(rows)
    forces = rows[:, None] * (leg.stiffness @ motions) * unit
    return float(np.abs(forces).max() / abs(scaled).max())


def grounding(leg, motions):
    """Strain energy of the six rigid motions (6) over that of the tip alone moving as much."""
    energy = np.einsum("ij,ij->j", motions, leg.stiffness @ motions)
    tip_alone = csr_array(leg.stiffness).diagonal()[6:ENDS]
    return np.abs(energy) / tip_alone


def asymmetry(matrix):
    """Largest difference between a matrix and its transpose, as a share of its largest entry."""
    return float(abs(matrix - matrix.T).max() / abs(matrix).max())


def free_frequencies(leg, count, shift_frequency):
    """The lowest `count` elastic frequencies (Hz) of the leg with nothing held.

    Lanczos on (K + σM)⁻¹ M, σ = (2π `shift_frequency`)², positive definite although the leg floats;
    a shift near the first frequency is best. The mass must be positive definite. The six rigid
    motions are left out.
    """
    stiffness, mass = csr_array(leg.stiffness), csr_array(leg.mass)
    sigma = (2.0 * np.pi * shift_frequency) ** 2
    shifted = csr_array(stiffness + sigma * mass)
    symbolic = analyse(shifted, leading=(ENDS + (leg.size - ENDS) % 3,))
    factor = factorise(symbolic, shifted, f"{leg.model} leg, free")
    inverse = LinearOperator(mass.shape, matvec=factor.solve, dtype=np.float64)
    noise = np.random.default_rng(1).standard_normal(leg.size)
    values = eigsh(
        stiffness,
        count + 6,
        M=mass,
        sigma=-sigma,
        OPinv=inverse,
        v0=factor.solve(mass @ noise),
        return_eigenvectors=False,
    )
    return np.sqrt(np.sort(values)[6:]) / (2.0 * np.pi)
