"""Frequencies of cantilevers from waves along the leg, against closed forms and solids."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.oracles.prism_waves import wall_frequency
from support.robots.paper_legs import STEEL

from fem.beams.beam_theory import cantilever_frequencies
from fem.couplings.wave_cantilever import (
    beam_frequency,
    cut_off,
    prism_frequency,
    wave_frequency,
)
from fem.couplings.wave_stiffness import prism_waves
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg, Material
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle, Tube
from meshes.section.section_mesh import section_mesh
from validation.solids.leg_meshes import face_mesh
from validation.solids.solid_legs import computed_properties, solid_frequencies

ALUMINIUM = Material.isotropic(7.0e10, 0.33, 2700.0)
SCARA_ARM = ConstantLeg(0.35, HollowRectangle(0.12, 0.09, 0.006), ALUMINIUM)


def waves_by_kind(section, material):
    mesh = face_mesh(ConstantLeg(1.0, section, material), 4)
    return {kind.fields.name: kind for kind in prism_waves(mesh, material)}


def prism(kind, length, order=1):
    near = beam_frequency(kind, length, order)
    return prism_frequency(kind, length, wave_frequency(kind, length, order, near))


@pytest.mark.parametrize("section", [Rectangle(0.05, 0.08), Tube(0.1, 0.01)])
def test_slender_cantilever_equals_timoshenko(section):
    """Huang's equation with the section constants of `fem.sections`."""
    material = replace(STEEL, G=0.6 * STEEL.G)
    leg, kinds = ConstantLeg(0.4, section, material), waves_by_kind(section, material)
    modes = cantilever_frequencies(computed_properties(leg, 4), leg.length, 6)
    # Above the cut-off a second bending wave propagates (second spectrum); such modes are left out.
    below = [mode for mode in modes if mode.frequency < cut_off(kinds[mode.kind])]
    assert len(below) > 3
    for mode in below:
        frequency = beam_frequency(kinds[mode.kind], leg.length, mode.order)
        # The curved elements of a tube change κ by 1e-5, the frequency by less.
        assert frequency == pytest.approx(mode.frequency, rel=2e-6), mode


def test_round_bar_torsion_has_no_distortion():
    """Pochhammer: torsional waves in a round bar travel at √(G/ρ) for every wavelength."""
    kind = waves_by_kind(Circle(0.1), STEEL)["torsion"]
    speed = np.sqrt(STEEL.G / STEEL.rho)
    for order in (1, 2):
        closed = (2 * order - 1) * speed / (4.0 * 0.5)
        # Area and polar moment of the mesh differ from those of a circle by 1e-5.
        assert prism_frequency(kind, 0.5, closed) == pytest.approx(closed, rel=1e-4)


@pytest.mark.parametrize(
    ("leg", "expected"),
    [
        (SCARA_ARM, (-0.029, -0.0135)),
        (ConstantLeg(0.3, Tube(0.1, 0.003), STEEL), (-0.0038, -0.0038)),
    ],
)
def test_distortion_is_solid_beam_difference(leg, expected):
    """The frequency change from beam to solid elements equals that by waves along the leg.

    Waves and solids use the same section mesh, but no common code along the leg.
    """
    solid = solid_frequencies(leg, (4,), "free", 2)
    beams = cantilever_frequencies(computed_properties(leg, 4), leg.length, 2)
    kinds = waves_by_kind(leg.section, leg.material)
    for mode, frequency, change in zip(beams, solid.frequencies.values[0], expected, strict=True):
        kind = kinds[mode.kind]
        by_waves = prism(kind, leg.length) / beam_frequency(kind, leg.length, 1) - 1.0
        assert by_waves == pytest.approx(change, rel=0.5)
        # Four elements along a thin tube make its frequency 0.07 % too high.
        assert frequency / mode.frequency - 1.0 == pytest.approx(by_waves, abs=8e-4)


def test_distortion_falls_with_slenderness_squared():
    """Relative change of the first frequency by distortion of the section, over the slenderness s.

    Walls that bend by their inertia contribute ω² ∝ s⁻⁴. Contraction contributes s⁻², which remains
    for slender legs.
    """
    kind = waves_by_kind(SCARA_ARM.section, ALUMINIUM)["bending y"]
    lengths = SCARA_ARM.length * 2.0 ** np.arange(4)
    changes = [prism(kind, length) / beam_frequency(kind, length, 1) - 1.0 for length in lengths]
    exponents = np.array([np.log2(long / short) for short, long in pairwise(changes)])
    assert np.all(np.diff(exponents) > 0.0)
    assert -4.0 < exponents[0] < -3.0
    assert exponents[-1] == pytest.approx(-2.42, abs=0.05)


def test_i_section_torsion_equals_solid():
    """Warping is free at the tip. The frequency by Saint-Venant torsion alone is 3 % too low."""
    leg = ConstantLeg(0.8, ISection(0.1, 0.16, 0.012, 0.008), STEEL)
    solid = solid_frequencies(leg, (4,), "free", 1).frequencies.values[0, 0]
    kind = waves_by_kind(leg.section, STEEL)["torsion"]
    saint_venant = beam_frequency(kind, leg.length, 1)
    by_waves = prism_frequency(kind, leg.length, 1.05 * saint_venant)
    assert by_waves / saint_venant == pytest.approx(1.031, abs=1e-3)
    assert solid == pytest.approx(by_waves, rel=1e-3)


def test_cut_off_frequency_is_that_of_section_walls():
    """The lowest cut-off of the waves is the lowest frequency of the section in its plane."""
    mesh = section_mesh(SCARA_ARM.section, 4)
    kinds = prism_waves(mesh, ALUMINIUM)
    assert_allclose(
        min(map(cut_off, kinds)), wall_frequency(mesh, ALUMINIUM) / (2.0 * np.pi), rtol=1e-6
    )


def test_mode_of_vibrating_walls_is_refused():
    """In a thin-walled arm no wave resembles a beam's second mode: its walls vibrate locally."""
    kind = waves_by_kind(SCARA_ARM.section, ALUMINIUM)["bending y"]
    beam = beam_frequency(kind, SCARA_ARM.length, 2)
    with pytest.raises(ComputationError, match="walls of the section vibrate locally"):
        wave_frequency(kind, SCARA_ARM.length, 2, beam)
    with pytest.raises(ComputationError, match="no frequency of bending y with free ends near"):
        prism_frequency(kind, SCARA_ARM.length, 0.5 * beam_frequency(kind, SCARA_ARM.length, 1))
