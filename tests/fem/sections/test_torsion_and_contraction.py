"""Torsion beyond Saint-Venant, and bending of meshes whose curved cells cannot contract."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from prismatic_legs import STEEL

from fem.sections.nonuniform_torsion import wave_frequency
from fem.sections.saint_venant import section_quadrature
from fem.sections.section_constants import held_contraction, section_constants
from fem.sections.waveguide import assembled, elasticity, strains, torsion_wave
from lumped.legs import Material
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
from meshes.section.section_mesh import section_mesh


def test_circle_does_not_warp_so_its_torsional_waves_have_no_dispersion():
    """Pochhammer: the lowest torsional wave of a round bar runs at √(G/ρ) at any wave number."""
    mesh = section_mesh(Circle(0.1), 6)
    for k in (1.0, 10.0, 30.0):
        expected = k * np.sqrt(STEEL.G / STEEL.rho)
        # quad9 meshes of the circle: area to 1e-5
        assert_allclose(torsion_wave(mesh, STEEL, k), expected, rtol=1e-4)


def test_a_thick_i_section_has_the_wave_of_a_rod_that_warps():
    """E. Reissner, J. Math. Phys. 31 (1952) 268: one warping function, 8 % above."""
    mesh = section_mesh(ISection(width=0.1, height=0.16, flange=0.02, web=0.02), 4)
    k = np.pi / 1.6
    rod = wave_frequency(section_constants(mesh, STEEL.nu), STEEL, k)
    # One function for the shear of thick walls is 1.4 % of that off, whatever the wave (measured).
    assert_allclose(torsion_wave(mesh, STEEL, k) / (2.0 * np.pi), rod, rtol=2e-3)


def test_a_thin_walled_i_section_has_vlasovs_wave():
    """V. Z. Vlasov: ω² = (GJ k² + EΓ k⁴)/(ρI_p + ρΓ k²), the shear of the walls left out."""
    mesh = section_mesh(ISection(width=0.1, height=0.2, flange=0.004, web=0.003), 4)
    constants, k = section_constants(mesh, 0.0), np.pi / 4.0
    m = Material.isotropic(2.1e11, 0.0, 7850.0)
    polar = constants.second_moment_y + constants.second_moment_z
    gamma = constants.warping_constant * k**2
    stiffness = m.G * constants.torsion_constant + m.E * gamma
    vlasov = k * np.sqrt(stiffness / (m.rho * (polar + gamma))) / (2.0 * np.pi)
    # That shear takes less than 1 %, the distortion of the walls no more than that.
    assert_allclose(wave_frequency(constants, m, k), vlasov, rtol=0.01)
    assert_allclose(torsion_wave(mesh, m, k) / (2.0 * np.pi), vlasov, rtol=0.02)


AUXETIC = Material.isotropic(2.1e11, -0.9, 7850.0)
CUBIC = Material(E=1.0, G=2.0, nu=0.25, rho=1.0)


@pytest.mark.parametrize(
    ("section", "nu"),
    [
        (Rectangle(0.1, 0.16), 0.3),
        (HollowRectangle(0.1, 0.16, 0.01), 0.3),
        (ISection(0.1, 0.16, 0.012, 0.008), 0.3),
        (Circle(0.1), 0.0),
    ],
)
def test_straight_cells_and_all_without_poissons_ratio_contract_as_asked(section, nu):
    quad = section_quadrature(section_mesh(section, 2))
    assert not held_contraction(quad, nu, 0.4).any()


@pytest.mark.parametrize("material", [STEEL, AUXETIC, CUBIC])
@pytest.mark.parametrize("section", [Circle(0.1), Tube(0.1, 0.02)])
def test_energy_is_the_least_of_plane_displacements_beside_plane_sections(section, material):
    """Dense generalised plane strain, all of C on all unknowns: f₀ − fᵀK⁺f over E, with εxx = s."""
    quad = section_quadrature(section_mesh(section, 4))
    moduli, field = elasticity(material), strains(quad, 0.0)
    local = np.einsum("mqsi,st,mqtj,mq->mij", field, moduli, field, quad.weights, optimize=True)
    cells = 3 * quad.mesh.cells[:, :, None] + np.arange(3)
    expected = np.zeros((2, 2))
    loads = np.zeros((3 * len(quad.mesh.nodes), 2))
    for i, s in enumerate(quad.points):
        by_cell = np.einsum("mqsi,s,mq->mi", field, moduli[:, 0], s * quad.weights)
        np.add.at(loads[:, i], cells.reshape(len(local), -1), by_cell)
        for j, other in enumerate(quad.points):
            expected[i, j] = moduli[0, 0] * quad.integral(s * other)
    relaxed = np.linalg.lstsq(assembled(quad, local), loads, rcond=1e-11)[0]
    expected -= loads.T @ relaxed
    moments = np.array([[quad.integral(a * b) for b in quad.points] for a in quad.points])
    found = moments + held_contraction(quad, material.nu, material.G / material.E)
    # Rounding of the pseudoinverse, with stiffnesses 40 times apart for ν = −0.9.
    assert_allclose(found, expected / material.E, rtol=0.0, atol=1e-9 * moments[0, 0])
    assert found[0, 0] > moments[0, 0] * (1.0 + 1e-6)
