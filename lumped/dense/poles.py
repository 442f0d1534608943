"""Partial fractions of the receptance of a system with viscous dashpots.

The receptance H(s) = A (K + sD + s²M)⁻¹ Aᵀ of the outputs A is written as a sum of first-order
terms. Let x be the displacements in the basis of undamped modes, which satisfy x = K⁻¹(Aᵀ − sDx −
s²Mx), and let y = sx/ω with the natural frequency ω of each undamped mode. The state z = (x, y)
satisfies z + sNz = b with a constant matrix N and vector b. With the eigenvalues ν of N and a
residue matrix G for each of them,

    H = Σ G / (1 + sν)

and the poles are s = −1/ν. The two terms of an oscillation add up to one of second order,

    (g + sh) / (1 + sκ + s²μ),    μ = ν₁ν₂,  κ = ν₁ + ν₂,  g = G₁ + G₂,  h = G₁ν₂ + G₂ν₁.

Its natural frequency is 1/√μ and its damping ratio is κ/(2√μ). A mode without mass has an infinite
ω, and the state contains no y for it.
"""

from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array, ComplexArray

# Fraction of the largest 1/s² below which a motion has no mass.
_MASSLESS = 1e-12
# Relative imaginary part of an eigenvalue above which the motion oscillates.
_REAL = 1e-9
# Relative distance of an eigenvalue from the conjugate of its partner. It is half the loss factor.
_PARTNER = 0.9
# Relative distance of a pole from zero below which the motion is idle.
_IDLE = 1e-9
# Condition number of the eigenvectors above which the terms lose more than eight digits.
_DEFECTIVE = 1e8


@dataclass(frozen=True, eq=False)
class Terms:
    """The r terms (g + sh) / (1 + sκ + s²μ) of the receptance of k outputs.

    `inverses` are μ (r values, in s²), `rates` are κ (r values, in s). `residues` are g and
    `rate_residues` are h (r×k×k each).
    """

    inverses: ComplexArray
    rates: ComplexArray
    residues: ComplexArray
    rate_residues: ComplexArray


def partial_fractions(
    elastic: ComplexArray, viscous: Array, inertia: Array, outputs: Array, shift: float = 0.0
) -> Terms | None:
    """Terms of the receptance of k outputs, each a linear function of n unknowns.

    The rows of A = `outputs` (k×n) map the unknowns to the outputs. The stiffness K = `elastic`,
    the damping D = `viscous` and the mass M = `inertia` are n×n (SI). A singular K needs a positive
    `shift` (1/s): the terms are then computed from K + sD + s²M at s = `shift`, which is regular.
    Terms with a pole at zero are omitted. Their motions must not move the outputs. None if a motion
    is critically damped, so that two eigenvectors are linearly dependent.
    """
    shifted = elastic + shift * viscous + shift**2 * inertia
    inverses, shapes = np.linalg.eig(np.linalg.solve(shifted, inertia))
    massive = np.flatnonzero(np.abs(inverses) > _MASSLESS * np.abs(inverses).max())
    size, states = len(inverses), len(inverses) + len(massive)
    matrix = np.zeros((states, states), dtype=complex)
    damping = (viscous + 2.0 * shift * inertia) @ shapes
    matrix[:size, :size] = np.linalg.solve(shapes, np.linalg.solve(shifted, damping))
    rates = np.arange(size, states)
    matrix[massive, rates] = np.sqrt(inverses[massive])
    matrix[rates, massive] = -np.sqrt(inverses[massive])
    eigenvalues, vectors = np.linalg.eig(matrix)
    if np.linalg.cond(vectors) > _DEFECTIVE:
        return None
    loads = np.zeros((states, len(outputs)), dtype=complex)
    loads[:size] = np.linalg.solve(shapes, np.linalg.solve(shifted, outputs.T))
    participations = np.linalg.solve(vectors, loads)
    residues: ComplexArray = np.einsum(
        "ir,rj->rij", outputs @ shapes @ vectors[:size], participations
    )
    # 1 + (s − σ)ν = (1 − σν)(1 + sν/(1 − σν)).
    scales = 1.0 - shift * eigenvalues
    moving = np.abs(scales) > _IDLE
    eigenvalues = np.asarray(eigenvalues[moving] / scales[moving], dtype=complex)
    return _paired(eigenvalues, residues[moving] / scales[moving, None, None])


def _paired(eigenvalues: ComplexArray, residues: ComplexArray) -> Terms:
    """Terms of second order for oscillations, and of first order for all other motions.

    `eigenvalues` are the eigenvalues ν of the matrix N of the module docstring. `residues` are the
    matrices G, one k×k matrix for each ν.
    """
    sizes = np.abs(eigenvalues)
    upper = [int(k) for k in np.flatnonzero(eigenvalues.imag > _REAL * sizes)]
    lower = [int(k) for k in np.flatnonzero(eigenvalues.imag < -_REAL * sizes)]
    distances = [
        (abs(eigenvalues[second] - eigenvalues[first].conjugate()) / sizes[first], first, second)
        for first in upper
        for second in lower
    ]
    partners: dict[int, int] = {}
    for distance, first, second in sorted(distances):
        if distance < _PARTNER and first not in partners and second not in partners.values():
            partners[first] = second
    firsts, seconds = list(partners.keys()), list(partners.values())
    single = np.setdiff1d(np.arange(len(eigenvalues)), [*firsts, *seconds])
    a, b = eigenvalues[firsts], eigenvalues[seconds]
    first_residues, second_residues = residues[firsts], residues[seconds]
    rate_residues = first_residues * b[:, None, None] + second_residues * a[:, None, None]
    return Terms(
        np.concatenate([a * b, np.zeros(len(single))]),
        np.concatenate([a + b, eigenvalues[single]]),
        np.concatenate([first_residues + second_residues, residues[single]]),
        np.concatenate([rate_residues, np.zeros_like(residues[single])]),
    )
