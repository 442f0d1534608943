"""Torsion beyond Saint-Venant: limits, and two formulations against each other."""

import numpy as np
from numpy.testing import assert_allclose
from prismatic_legs import STEEL

from fem.sections.nonuniform_torsion import cantilever_frequencies, wave_frequency
from fem.sections.section_constants import section_constants
from fem.sections.waveguide import torsion_wave
from lumped.legs import Material
from lumped.sections import Circle, ISection, Rectangle
from meshes.section.section_mesh import section_mesh


def saint_venant_frequency(constants, wave_number):
    polar = constants.second_moment_y + constants.second_moment_z
    speed = np.sqrt(STEEL.G * constants.torsion_constant / (STEEL.rho * polar))
    return wave_number * speed / (2.0 * np.pi)


def test_circle_does_not_warp_so_its_torsional_waves_have_no_dispersion():
    """Pochhammer: the lowest torsional wave of a round bar runs at √(G/ρ) at any wave number."""
    mesh = section_mesh(Circle(0.1), 6)
    for k in (1.0, 10.0, 30.0):
        expected = k * np.sqrt(STEEL.G / STEEL.rho)
        # quad9 meshes of the circle: area to 1e-5
        assert_allclose(torsion_wave(mesh, STEEL, k), expected, rtol=1e-4)


def test_slender_cantilever_in_torsion_has_quarter_waves():
    mesh = section_mesh(Rectangle(0.1, 0.3), (2, 6))
    constants = section_constants(mesh, STEEL.nu)
    length = 30.0
    found = cantilever_frequencies(constants, STEEL, length, 3)
    waves = (2.0 * np.arange(3) + 1.0) * np.pi / (2.0 * length)
    expected = [saint_venant_frequency(constants, k) for k in waves]
    assert_allclose(found, expected, rtol=1e-3)


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
