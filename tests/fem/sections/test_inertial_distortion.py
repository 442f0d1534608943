"""Distortion of sections by inertia, against plates in closed form and 3-D waves."""

import numpy as np
import pytest
from scipy.sparse import csc_array
from scipy.sparse.linalg import eigsh
from support.robots.paper_legs import STEEL

from fem.sections.inertial_distortion import distortion_flexibility
from fem.sections.saint_venant import section_quadrature
from fem.sections.waveguide import mass_matrix, stiffness_matrix
from lumped.sections import HollowRectangle, ISection, Tube
from meshes.section.section_mesh import section_mesh

BOX = HollowRectangle(0.1, 0.16, 0.003)


def test_flanges_bend_as_cantilever_plates():
    """Acceleration along the web: the web carries the shear force, flanges their own inertia.

    A cantilever plate of width c under a uniform load q stores q² c⁵/40D. Four half flanges have
    q = t/A per unit force. The corners inside the web make them shorter, by 2 % of c.
    """
    flange, half, section = 0.003, 0.05, ISection(0.1, 0.1, 0.003, 0.002)
    plate = STEEL.E * flange**3 / (12.0 * (1.0 - STEEL.nu**2))
    work = 4.0 * (flange / section.area) ** 2 * half**5 / (20.0 * plate)
    beta = distortion_flexibility(section_mesh(section, 8), STEEL)
    assert beta[1, 1] == pytest.approx(STEEL.rho * section.area * work, rel=0.04)
    # With two axes of symmetry the motions are not coupled.
    assert np.abs(beta - np.diag(np.diag(beta))).max() < 1e-8 * beta.max()


def test_round_tube_does_not_distort():
    """A ring under the shear flow of a force stretches only: 1e-3 of a box of this size."""
    ring = distortion_flexibility(section_mesh(Tube(0.12, 0.003), 4), STEEL)
    assert np.abs(ring).max() < 2e-3 * distortion_flexibility(section_mesh(BOX, 4), STEEL)[0, 0]


def test_coarse_walls_raise_frequency_as_waves_do():
    """Box with walls of 3 mm at 140 Hz: one element across the walls raises f by 0.11 %."""
    wave_number = 1.875 / 0.9
    waves, changes = [], []
    for divisions in (4, 8):
        mesh = section_mesh(BOX, divisions)
        quad = section_quadrature(mesh)
        stiffness, mass = (
            csc_array(matrix)
            for matrix in (
                stiffness_matrix(quad, STEEL, wave_number),
                mass_matrix(quad, STEEL.rho),
            )
        )
        squares = eigsh(stiffness, 2, mass, sigma=0.0, return_eigenvectors=False)
        waves.append(np.sqrt(np.sort(squares)))
        changes.append(np.diag(distortion_flexibility(mesh, STEEL))[:2])
    for coarse, fine, beta in zip(*waves, changes[1] - changes[0], strict=True):
        assert coarse / fine - 1.0 == pytest.approx(0.5 * fine**2 * beta, rel=0.25)
