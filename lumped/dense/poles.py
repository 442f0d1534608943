"""Partial fractions of the receptance of a system with viscous dashpots.

The receptance H(s) = A (K + sD + s²M)⁻¹ Aᵀ at s = iω is a sum of first-order terms. The
displacements x = K⁻¹(Aᵀ − sDx − s²Mx), in the basis of undamped modes, and y = s√μ x form the state
z = (x, y), which satisfies z + sNz = b. With the eigenvalues ν of N,

    H = Σ G / (1 + sν)

and the poles are s = −1/ν. The two terms of an oscillation add up to one of second order,

    (g + sh) / (1 + sκ + s²μ),    μ = ν₁ν₂,  κ = ν₁ + ν₂,  g = G₁ + G₂,  h = G₁ν₂ + G₂ν₁.

Its natural frequency is 1/√μ and its damping ratio is κ/(2√μ). Motions without mass have no y, so
that N is not defective there.
"""

from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array, ComplexArray

# Fraction of the largest 1/s² below which a motion has no mass.
_MASSLESS = 1e-12
# Relative imaginary part of a pole above which the motion oscillates.
_REAL = 1e-9
# Relative distance of a pole from the conjugate of its partner. It is half the loss factor.
_PARTNER = 0.9
# Relative distance of a pole from zero below which the motion is idle.
_IDLE = 1e-9
# Condition number of the eigenvectors above which the terms lose more than eight digits.
_DEFECTIVE = 1e8


@dataclass(frozen=True, eq=False)
class Terms:
    """The r terms (g + sh) / (1 + sκ + s²μ) of a receptance.

    `inverses` are μ (r values, in s²), `rates` are κ (r values, in s). For k outputs, `residues`
    are g (r×k×k) and `rate_residues` are h (r×k×k).
    """

    inverses: ComplexArray
    rates: ComplexArray
    residues: ComplexArray
    rate_residues: ComplexArray


def partial_fractions(
    elastic: ComplexArray, viscous: Array, inertia: Array, outputs: Array, shift: float = 0.0
) -> Terms | None:
    """Terms of the receptance of k motions, the rows of A = `outputs` (k×n), in n unknowns.

    The matrices (n×n) are K = `elastic`, D = `viscous` and M = `inertia`. If K is singular, a
    positive `shift` (1/s) of s makes K + sD + s²M regular. Terms with a pole at zero are omitted;
    their motions must not move the outputs. The result is None if a motion is damped critically, so
    that eigenvectors are linearly dependent.
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
    poles, vectors = np.linalg.eig(matrix)
    if np.linalg.cond(vectors) > _DEFECTIVE:
        return None
    loads = np.zeros((states, len(outputs)), dtype=complex)
    loads[:size] = np.linalg.solve(shapes, np.linalg.solve(shifted, outputs.T))
    participations = np.linalg.solve(vectors, loads)
    residues: ComplexArray = np.einsum(
        "ir,rj->rij", outputs @ shapes @ vectors[:size], participations
    )
    # 1 + (s − σ)ν = (1 − σν)(1 + sν/(1 − σν)).
    scales = 1.0 - shift * poles
    moving = np.abs(scales) > _IDLE
    poles, residues = poles[moving] / scales[moving], residues[moving] / scales[moving, None, None]
    return _paired(np.asarray(poles, dtype=complex), residues)


def _paired(poles: ComplexArray, residues: ComplexArray) -> Terms:
    """Terms of second order for oscillations, and of first order for all other motions.

    The eigenvalues ν of N are `poles`, and the matrices G are `residues` (one k×k for each ν).
    """
    sizes = np.abs(poles)
    upper = [int(k) for k in np.flatnonzero(poles.imag > _REAL * sizes)]
    lower = [int(k) for k in np.flatnonzero(poles.imag < -_REAL * sizes)]
    distances = [
        (abs(poles[second] - poles[first].conjugate()) / sizes[first], first, second)
        for first in upper
        for second in lower
    ]
    partners: dict[int, int] = {}
    for distance, first, second in sorted(distances):
        if distance < _PARTNER and first not in partners and second not in partners.values():
            partners[first] = second
    firsts, seconds = list(partners.keys()), list(partners.values())
    single = np.setdiff1d(np.arange(len(poles)), [*firsts, *seconds])
    a, b = poles[firsts], poles[seconds]
    first_residues, second_residues = residues[firsts], residues[seconds]
    rate_residues = first_residues * b[:, None, None] + second_residues * a[:, None, None]
    return Terms(
        np.concatenate([a * b, np.zeros(len(single))]),
        np.concatenate([a + b, poles[single]]),
        np.concatenate([first_residues + second_residues, residues[single]]),
        np.concatenate([rate_residues, np.zeros_like(residues[single])]),
    )
