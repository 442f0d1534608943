"""Harmonic waves along a prism, by beam theory and by three-dimensional elasticity.

Half a wave is a mode of a simply supported bar, a quarter wave a mode of a cantilever. Waves thus
give the error of beam theory at a given length.
"""

from math import pi, sqrt

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh

from fem.sections.saint_venant import section_quadrature
from fem.sections.waveguide import mass_matrix, stiffness_matrix
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh


def beam_wave_frequency(beam, kind, wavenumber):
    """Frequency (Hz) of a wave of a beam with `wavenumber` k (1/m). Bending is Timoshenko's.

    Bending: w = sin kx, θ = cos kx, the lower root of a two by two problem.
    """
    k = wavenumber
    if kind == "tension":
        return k * sqrt(beam.EA / beam.mu) / (2.0 * pi)
    if kind == "torsion":
        return k * sqrt(beam.GJ / beam.rho_J) / (2.0 * pi)
    coupling = -beam.GAz * k
    stiffness = [[beam.GAz * k**2, coupling], [coupling, beam.EIy * k**2 + beam.GAz]]
    return sqrt(eigh(stiffness, np.diag([beam.mu, beam.rho_Iy]), eigvals_only=True)[0]) / (2.0 * pi)


def prism_wave_frequency(section, material, kind, wavenumber, degree=10):
    """Frequency (Hz) of the lowest wave of one kind in a rectangular prism, by 3-D elasticity.

    u = (U cos kx, V sin kx, W sin kx), U, V, W polynomials of `degree` in y and in z, by Ritz on
    the section of an isotropic prism with free sides. The kinds differ in parity: U is odd in z for
    bending y, odd in y and z for torsion, even in both for tension.
    """
    k = wavenumber
    odd_y, odd_z = {"bending": (0, 1), "torsion": (1, 1), "tension": (0, 0)}[kind]
    half_y, half_z = (side / 2.0 for side in section.extent)
    points, weights = legendre.leggauss(degree + 2)
    volumes = (np.outer(weights, weights) * half_y * half_z).reshape(-1, 1)

    def field(odd_y, odd_z):
        """Products of Legendre polynomials at quadrature points, and slopes along y and z."""
        families = []
        for odd in (odd_y, odd_z):
            terms = np.eye(degree + 1)[:, odd::2]
            families += [legendre.legval(points, c).T for c in (terms, legendre.legder(terms))]
        p, dp, q, dq = families
        return np.kron(p, q), np.kron(dp, q) / half_y, np.kron(p, dq) / half_z

    (U, Uy, Uz), (V, Vy, Vz), (W, Wy, Wz) = (
        field(odd_y, odd_z),
        field(1 - odd_y, odd_z),
        field(odd_y, 1 - odd_z),
    )
    oU, oV, oW = (np.zeros_like(f) for f in (U, V, W))
    stretches = [np.hstack(row) for row in ((-k * U, oV, oW), (oU, Vy, oW), (oU, oV, Wz))]
    shears = [np.hstack(row) for row in ((oU, Vz, Wy), (Uz, oV, k * W), (Uy, k * V, oW))]
    lame = material.E * material.nu / ((1.0 + material.nu) * (1.0 - 2.0 * material.nu))
    terms = [(lame, sum(stretches))]
    terms += [(2.0 * material.G, strain) for strain in stretches]
    terms += [(material.G, strain) for strain in shears]
    fields = [np.hstack(row) for row in ((U, oV, oW), (oU, V, oW), (oU, oV, W))]
    stiffness = sum(c * f.T @ (volumes * f) for c, f in terms)
    mass = material.rho * sum(f.T @ (volumes * f) for f in fields)
    lowest = eigh(stiffness, mass, eigvals_only=True, subset_by_index=[0, 0])[0]
    return sqrt(lowest) / (2.0 * pi)


def bending_wave(mesh: SectionMesh, material: Material, wave_number: float, along: str) -> float:
    """Angular frequency (rad/s) of the wave on a section mesh that bends along "y" or "z".

    As k → 0 it is the wave of the Timoshenko beam with the section's constants. At finite k,
    contraction by Poisson's ratio raises the frequency, of relative order (k · side)². Warping by
    shear, of order (k · side)⁴, and walls that bend lower it.
    """
    motion = np.zeros((len(mesh.nodes), 3))
    motion[:, "xyz".index(along)] = 1.0
    quad = section_quadrature(mesh)
    stiffness, mass = stiffness_matrix(quad, material, wave_number), mass_matrix(quad, material.rho)
    values, shapes = eigh(stiffness, mass, subset_by_index=[0, 5])
    # Of the lowest ones that with the largest share of the translation.
    return float(np.sqrt(values[np.argmax(np.abs(shapes.T @ mass @ motion.ravel()))]))


def wall_frequency(mesh: SectionMesh, material: Material) -> float:
    """Lowest angular frequency (rad/s) at which the walls of an infinite leg vibrate in phase."""
    quad = section_quadrature(mesh)
    stiffness, mass = stiffness_matrix(quad, material, 0.0), mass_matrix(quad, material.rho)
    # The first four are the section's rigid motions: tension, two bendings, torsion.
    return float(np.sqrt(eigh(stiffness, mass, subset_by_index=[4, 4], eigvals_only=True)[0]))
