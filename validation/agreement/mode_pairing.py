"""Which mode of one model is which of another: modal assurance criterion and optimal pairing.

MAC = (aᵀWb)² / (aᵀWa · bᵀWb) with a mass-weighted product W (Allemang & Brown, IMAC 1982).
"""

import numpy as np
import scipy

from lumped.arrays import Array, IntArray
from lumped.legs import BeamProperties

# Modes of one model closer than this (relative) are compared as a space: a difference of the models
# by up to 1 % turns shapes that are 10 % apart by up to a tenth of a radian (Davis & Kahan, SIAM J.
# Numer. Anal. 7 (1970) 1), 0.99 in MAC, which is what single modes must have.
CLOSE = 0.1


def mac_matrix(first: Array, second: Array, weights: Array) -> Array:
    """MAC (m×n) between two sets of shapes (k×m, k×n) sampled alike, `weights` (k) ≥ 0."""
    a, b = (np.sqrt(weights)[:, None] * np.asarray(shapes) for shapes in (first, second))
    a, b = (shapes / np.linalg.norm(shapes, axis=0) for shapes in (a, b))
    mac: Array = np.square(a.T @ b)
    return mac


def pair_modes(mac: Array) -> IntArray:
    """Partner (m) of every row of a MAC matrix (m×n) by its largest sum (Hungarian method).

    −1 where there are too few columns.
    """
    rows, columns = scipy.optimize.linear_sum_assignment(mac, maximize=True)
    partner = np.full(mac.shape[0], -1)
    partner[rows] = columns
    return partner


def neighbours(frequencies: Array, mode: int) -> IntArray:
    """Modes that follow on each other within `CLOSE`, `mode` among them; frequencies ascend."""
    apart = np.diff(frequencies) > CLOSE * frequencies[:-1]
    family = np.concatenate([[0], np.cumsum(apart)])
    return np.flatnonzero(family == family[mode])


def centreline_samples(length: float, count: int) -> tuple[Array, Array]:
    """Gauss–Legendre stations (m) along a leg and the share of its length that each stands for."""
    points, weights = np.polynomial.legendre.leggauss(count)
    return 0.5 * length * (1.0 + points), 0.5 * length * weights


def centreline_weights(properties: BeamProperties, lengths: Array) -> Array:
    """Mass weights (6m) of twists sampled on a centreline: mass and rotary inertia per station."""
    p = properties
    per_length = np.array([p.mu, p.mu, p.mu, p.rho_J, p.rho_Iy, p.rho_Iz])
    return np.outer(lengths, per_length).ravel()
