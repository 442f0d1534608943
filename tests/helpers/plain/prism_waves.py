"""Harmonic waves along a prism: as a beam has them, and as the three-dimensional body does.

Half a wave is a simply supported mode, a quarter a mode of a bar held at one end, so that waves
say what beam theory itself is worth at a given length.
"""

from math import pi, sqrt
from typing import Literal, TypeAlias

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh

from lumped.arrays import Array
from lumped.legs import BeamProperties, Material
from lumped.sections import Section

WaveKind: TypeAlias = Literal["bending", "torsion", "tension"]


def beam_wave_frequency(beam: BeamProperties, kind: WaveKind, wavenumber: float) -> float:
    """Frequency (Hz) of the beam's wave of `wavenumber` k (1/m); bending y, Timoshenko's.

    Bending: w = sin kx, θ = cos kx, the lower root of a two by two problem.
    """
    k = wavenumber
    match kind:
        case "tension":
            return k * sqrt(beam.EA / beam.mu) / (2.0 * pi)
        case "torsion":
            return k * sqrt(beam.GJ / beam.rho_J) / (2.0 * pi)
    coupling = -beam.GAz * k
    stiffness = [[beam.GAz * k**2, coupling], [coupling, beam.EIy * k**2 + beam.GAz]]
    lowest = eigh(stiffness, np.diag([beam.mu, beam.rho_Iy]), eigvals_only=True)[0]
    return sqrt(lowest) / (2.0 * pi)


def prism_wave_frequency(
    section: Section, material: Material, kind: WaveKind, wavenumber: float, degree: int = 10
) -> float:
    """Frequency (Hz) of a rectangular prism's lowest wave of a kind, wavenumber k (1/m), 3-D.

    u = (U cos kx, V sin kx, W sin kx), U, V, W polynomials of `degree` in y and in z, by Ritz on
    the section of an isotropic prism with free sides. The kinds differ in parity: U is odd in z for
    bending y, odd in y and z for torsion, even for tension.
    """
    k = wavenumber
    parity_y, parity_z = {"bending": (0, 1), "torsion": (1, 1), "tension": (0, 0)}[kind]
    half_y, half_z = (side / 2.0 for side in section.extent)
    points, weights = legendre.leggauss(degree + 2)
    volumes = np.outer(weights, weights).ravel() * half_y * half_z

    def field(odd_y: int, odd_z: int) -> tuple[Array, Array, Array]:
        (p, dp), (q, dq) = (_legendre(points, odd, degree) for odd in (odd_y, odd_z))
        return _products(p, q), _products(dp, q) / half_y, _products(p, dq) / half_z

    U, Uy, Uz = field(parity_y, parity_z)
    V, Vy, Vz = field(1 - parity_y, parity_z)
    W, Wy, Wz = field(parity_y, 1 - parity_z)
    oU, oV, oW = (np.zeros_like(f) for f in (U, V, W))
    strains = [
        np.hstack(row)
        for row in (
            (-k * U, oV, oW),
            (oU, Vy, oW),
            (oU, oV, Wz),
            (oU, Vz, Wy),
            (Uz, oV, k * W),
            (Uy, k * V, oW),
        )
    ]
    lame = material.E * material.nu / ((1.0 + material.nu) * (1.0 - 2.0 * material.nu))
    dilatation = strains[0] + strains[1] + strains[2]
    terms = [(lame, dilatation)]
    terms += [(2.0 * material.G, strain) for strain in strains[:3]]
    terms += [(material.G, strain) for strain in strains[3:]]
    fields = [np.hstack(row) for row in ((U, oV, oW), (oU, V, oW), (oU, oV, W))]
    stiffness = sum(c * f.T @ (volumes[:, None] * f) for c, f in terms)
    mass = material.rho * sum(f.T @ (volumes[:, None] * f) for f in fields)
    lowest = eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, 0])[0]
    return sqrt(lowest) / (2.0 * pi)


def _products(along_y: Array, along_z: Array) -> Array:
    """Products of two families of functions at the product points (q² × all pairs)."""
    return np.asarray(np.kron(along_y, along_z), dtype=np.float64)


def _legendre(points: Array, odd: int, degree: int) -> tuple[Array, Array]:
    """Odd or even Legendre polynomials and their slopes at `points` (q × polynomials)."""
    coefficients = np.eye(degree + 1)[:, odd::2]
    both = (coefficients, legendre.legder(coefficients))
    polynomials, slopes = (np.asarray(legendre.legval(points, c), dtype=np.float64) for c in both)
    return polynomials.T, slopes.T
