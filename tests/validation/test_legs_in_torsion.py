"""Torsional waves of legs beyond Saint-Venant's torsion, and what they do to a robot's modes."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.sections.section_constants import section_constants
from lumped.arrays import Array
from lumped.biglide import system, with_equivalent_legs
from lumped.legs import ConstantLeg, Material
from lumped.robot_file import load_robot
from lumped.sections import Circle, HollowRectangle, ISection
from lumped.system import solution
from lumped.system.joint_motion import Portion
from meshes.section.section_mesh import section_mesh
from validation.models.biglide import robot_legs
from validation.solids.legs import solid_frequencies
from validation.studies.paired_robot_modes import ELEMENTS, SampledModes, model_modes
from validation.studies.quantities import strain_shares
from validation.studies.torsion import torsion_effects, wave_error, with_torsion

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
IFW = load_robot("ifw").robot
POSTURES = 3


def sampled(frequencies: Array, torsion: Array) -> SampledModes:
    """One posture, each shape a unit vector."""
    size = len(frequencies)
    return SampledModes(np.zeros(1), frequencies[None], np.eye(size)[None], torsion[None])


def test_thin_i_section_is_stiffened_as_by_vlasov():
    """ω² = (GJ k² + EΓ k⁴)/(ρI_p + ρΓ k²) with Γ, J and I_p of thin walls, k = π/L."""
    leg = ConstantLeg(8.0, ISection(0.1, 0.204, 0.004, 0.003), Material.isotropic(2.1e11, 0.0, 1e3))
    flange, web = 0.004 * 0.1**3 / 12.0, 0.003 * 0.196**3 / 12.0
    warping = 2.0 * flange * 0.1**2
    torsion = (2.0 * 0.1 * 0.004**3 + 0.196 * 0.003**3) / 3.0
    polar = 2.0 * flange + web + 2.0 * 0.1 * 0.004 * 0.1**2
    k = np.pi / 8.0
    stiffer = 1.0 + leg.material.E * warping * k**2 / (leg.material.G * torsion)
    expected = stiffer / (1.0 + warping * k**2 / polar) - 1.0
    assert expected > 0.3
    # Fillets count for 1 % of J, the shear of the walls takes from warping.
    assert wave_error(leg, 0.0) == pytest.approx(expected, rel=0.06)


def test_closed_section_is_softened_as_the_solid_is():
    """A clamped solid of half the length has a quarter of the same wave.

    Its walls bend near their own frequency, so that a fifth of the torsional stiffness is missing.
    """
    material = Material.isotropic(2.1e11, 0.1, 7850.0)
    leg = ConstantLeg(2.0, HollowRectangle(0.143, 0.234, 0.0174), material)
    constants = section_constants(section_mesh(leg.section, 4), material.nu)
    polar = constants.second_moment_y + constants.second_moment_z
    speed = np.sqrt(material.G * constants.torsion_constant / (material.rho * polar))
    half = solid_frequencies(replace(leg, length=1.0), (4,), "free", 4)
    found = half.frequencies.values[0, 2]
    assert half.mac[0, 2] > 0.999
    expected = (found / (speed / (2.0 * leg.length))) ** 2 - 1.0
    assert expected == pytest.approx(-0.2, abs=0.01)
    # The walls are held where the solid is clamped, along a wave they are not.
    assert wave_error(leg, 0.0) == pytest.approx(expected, rel=0.05)


def test_round_legs_do_not_warp_and_shorter_waves_count_for_higher_modes():
    assert wave_error(ConstantLeg(1.0, Circle(0.1), STEEL), 0.0) == pytest.approx(0.0, abs=1e-9)
    leg = ConstantLeg(2.0, ISection(0.12, 0.2, 0.012, 0.01), STEEL)
    half = replace(leg, length=1.0)
    constants = section_constants(section_mesh(leg.section, 4), STEEL.nu)
    polar = constants.second_moment_y + constants.second_moment_z
    speed = np.sqrt(STEEL.G * constants.torsion_constant / (STEEL.rho * polar))
    # Saint-Venant's frequency of half a wave on 1 m is c/2L.
    assert wave_error(leg, speed / 2.0) == pytest.approx(wave_error(half, 0.0), rel=1e-9)
    assert wave_error(leg, speed / 8.0) == wave_error(leg, 0.0) < wave_error(half, 0.0)


def test_stiffened_modes_are_those_of_two_coupled_masses():
    """K = diag(a, b) + e t tᵀ has the eigenvalues (a+b+e)/2 ± √((a−b)²/4 + e²/4), t = (1, 1)/√2."""
    a, b, error = 4.0, 9.0, 3.0
    torsion = np.array([np.zeros((2, 2)), np.full((2, 2), 0.5)])
    modes = sampled(np.sqrt([a, b]) / (2.0 * np.pi), torsion)
    found = with_torsion(modes, np.array([7.0, error]))
    root = np.sqrt(0.25 * (a - b) ** 2 + 0.25 * error**2)
    middle = 0.5 * (a + b + error)
    assert_allclose(np.square(2.0 * np.pi * found.frequencies[0]), [middle - root, middle + root])
    angle = 0.5 * np.arctan2(error, b - a)
    assert_allclose(np.abs(found.samples[0, :, 0]), [np.cos(angle), np.sin(angle)])
    # What is in torsion follows the shapes, and is stiffer.
    assert_allclose(np.trace(found.torsion[0, 1]), 1.0 + error)


def test_modal_torsion_has_the_share_of_strain_energy_on_its_diagonal():
    member = with_equivalent_legs(IFW)
    modes = model_modes(IFW, "beam", "timoshenko", ELEMENTS, POSTURES)
    legs = robot_legs("beam", member)
    whole = solution.solved(system(member, member.centre, *legs))
    shares = strain_shares(whole.system, solution.modes(whole, 6).shapes)
    stiffness = np.square(2.0 * np.pi * modes.frequencies[1, :6])
    for leg in (0, 1):
        found = np.diag(modes.torsion[1, leg])[:6] / stiffness
        assert_allclose(found, shares[Portion(f"leg {leg + 1}", "torsion")], rtol=1e-6, atol=1e-9)


def test_small_effects_on_frequencies_go_with_the_share_of_energy():
    """Rayleigh: δf/f = ½ e × share, to first order; exact legs have no effect at all."""
    modes = model_modes(IFW, "beam", "timoshenko", ELEMENTS, POSTURES)
    none = torsion_effects(IFW, modes, np.zeros(2))
    assert none.frequency.max() < 1e-12
    assert none.mac.min() == pytest.approx(1.0, abs=1e-12)
    error = 1e-4
    stiffness = np.square(2.0 * np.pi * modes.frequencies[:, :6])
    shares = np.diagonal(modes.torsion[:, 1], axis1=1, axis2=2)[:, :6] / stiffness
    found = torsion_effects(IFW, modes, np.array([0.0, error]))
    assert shares.max() > 0.05
    # The next order is e² over the gap to the next mode.
    assert_allclose(found.frequency, 0.5 * error * shares, rtol=1e-2, atol=1e-9)


def test_torsional_mode_that_passes_another_one_is_seen_on_its_way():
    """Before and after, both have their old shapes; while they cross, they mix."""
    modes = model_modes(IFW, "beam", "timoshenko", ELEMENTS, POSTURES)
    size = modes.frequencies.shape[1]
    coupled = np.zeros((size, size))
    # 64 % more stiffness brings mode 1 from 100 Hz to 128 Hz, past mode 2 half-way, at 115 Hz.
    frequencies = np.array([100.0, 115.0, *range(200, 200 + 50 * (size - 2), 50)])
    coupled[0, 0] = 1.0
    coupled[0, 1] = coupled[1, 0] = 0.02
    coupled[1, 1] = 4e-4
    torsion = (2.0 * np.pi * 100.0) ** 2 * np.array([coupled, np.zeros_like(coupled)])
    crossing = replace(
        modes,
        frequencies=np.tile(frequencies, (POSTURES, 1)),
        torsion=np.tile(torsion, (POSTURES, 1, 1, 1)),
    )
    found = torsion_effects(IFW, crossing, np.array([0.64, 0.0]))
    # In the end they are mixed by ½ atan(2 · 0.64 · 0.02/(1.64 − 1.3228)) = 0.04, cos² = 0.998.
    assert found.mac[:, :2].max() < 0.95
    assert found.mac[:, 2:].min() > 1.0 - 1e-9
    # Its own torsion would raise mode 2 by ½ · 0.64 · 4e-4/1.3225 = 1e-4 alone.
    assert found.frequency[:, 1].min() > 5e-4
