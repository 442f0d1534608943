"""Frequencies of a cantilever by the waves in it, against closed forms and solids."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from prism_waves import wall_frequency
from prismatic_legs import STEEL

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
from validation.solids.solid_legs import computed_properties, face_mesh, solid_frequencies

ALUMINIUM = Material.isotropic(7.0e10, 0.33, 2700.0)
SCARA_ARM = ConstantLeg(0.35, HollowRectangle(0.12, 0.09, 0.006), ALUMINIUM)


def waves_by_kind(section, material):
    mesh = face_mesh(ConstantLeg(1.0, section, material), 4)
    return {kind.fields.name: kind for kind in prism_waves(mesh, material)}


def prism(kind, length, order=1):
    near = beam_frequency(kind, length, order)
    return prism_frequency(kind, length, wave_frequency(kind, length, order, near))


@pytest.mark.parametrize("section", [Rectangle(0.05, 0.08), Tube(0.1, 0.01)])
def test_beam_of_saint_venant_states_is_timoshenkos(section):
    """Huang's equation with the constants of `fem.sections`, which knows no field along x."""
    material = replace(STEEL, G=0.6 * STEEL.G)
    leg, kinds = ConstantLeg(0.4, section, material), waves_by_kind(section, material)
    modes = cantilever_frequencies(computed_properties(leg, 4), leg.length, 6)
    # The second spectrum of stubby legs has two waves that travel.
    below = [mode for mode in modes if mode.frequency < cut_off(kinds[mode.kind])]
    assert len(below) > 3
    for mode in below:
        own = beam_frequency(kinds[mode.kind], leg.length, mode.order)
        # κ of a tube's curved cells: 1e-5 times the shear's share.
        assert own == pytest.approx(mode.frequency, rel=2e-6), mode


def test_torsion_of_circle_has_no_distortion():
    """Pochhammer: round bars twist at √(G/ρ) whatever the length of the wave."""
    kind = waves_by_kind(Circle(0.1), STEEL)["torsion"]
    speed = np.sqrt(STEEL.G / STEEL.rho)
    for order in (1, 2):
        closed = (2 * order - 1) * speed / (4.0 * 0.5)
        # Area and polar moment of the mesh: 1e-5 of a circle's.
        assert prism_frequency(kind, 0.5, closed) == pytest.approx(closed, rel=1e-4)


@pytest.mark.parametrize(
    ("leg", "expected"),
    [
        (SCARA_ARM, (-0.029, -0.0135)),
        (ConstantLeg(0.3, Tube(0.1, 0.003), STEEL), (-0.0038, -0.0038)),
    ],
)
def test_distortion_is_solid_minus_beam(leg, expected):
    """Solids of one section mesh, elements along the leg, share no code with fields along it."""
    solid = solid_frequencies(leg, (4,), "free", 2)
    beams = cantilever_frequencies(computed_properties(leg, 4), leg.length, 2)
    kinds = waves_by_kind(leg.section, leg.material)
    for mode, frequency, change in zip(beams, solid.frequencies.values[0], expected, strict=True):
        kind = kinds[mode.kind]
        by_waves = prism(kind, leg.length) / beam_frequency(kind, leg.length, 1) - 1.0
        assert by_waves == pytest.approx(change, rel=0.5)
        # Four elements along the leg are too stiff by 0.07 % of a thin tube.
        assert frequency / mode.frequency - 1.0 == pytest.approx(by_waves, abs=8e-4)


def test_distortion_falls_with_square_of_slenderness():
    """Walls bend under their own inertia, ω² ∝ s⁻⁴; contraction along the wave remains, s⁻²."""
    kind = waves_by_kind(SCARA_ARM.section, ALUMINIUM)["bending y"]
    lengths = SCARA_ARM.length * 2.0 ** np.arange(4)
    changes = [prism(kind, length) / beam_frequency(kind, length, 1) - 1.0 for length in lengths]
    exponents = np.array([np.log2(long / short) for short, long in pairwise(changes)])
    assert np.all(np.diff(exponents) > 0.0)
    assert -4.0 < exponents[0] < -3.0
    assert exponents[-1] == pytest.approx(-2.42, abs=0.05)


def test_open_section_twists_at_the_solids_frequency():
    """An I-section warps at its free tip: Saint-Venant's torsion is 3 % too slow."""
    leg = ConstantLeg(0.8, ISection(0.1, 0.16, 0.012, 0.008), STEEL)
    solid = solid_frequencies(leg, (4,), "free", 1).frequencies.values[0, 0]
    kind = waves_by_kind(leg.section, STEEL)["torsion"]
    saint_venant = beam_frequency(kind, leg.length, 1)
    found = prism_frequency(kind, leg.length, 1.05 * saint_venant)
    assert found / saint_venant == pytest.approx(1.031, abs=1e-3)
    assert solid == pytest.approx(found, rel=1e-3)


def test_cut_off_is_the_lowest_of_the_walls():
    mesh = section_mesh(SCARA_ARM.section, 4)
    kinds = prism_waves(mesh, ALUMINIUM)
    assert_allclose(
        min(map(cut_off, kinds)), wall_frequency(mesh, ALUMINIUM) / (2.0 * np.pi), rtol=1e-6
    )


def test_frequency_without_beam_wave_raises():
    kind = waves_by_kind(SCARA_ARM.section, ALUMINIUM)["bending y"]
    beam = beam_frequency(kind, SCARA_ARM.length, 2)
    with pytest.raises(ComputationError, match="walls of the section vibrate locally"):
        wave_frequency(kind, SCARA_ARM.length, 2, beam)
    with pytest.raises(ComputationError, match="no bending y of a leg with free ends near"):
        prism_frequency(kind, SCARA_ARM.length, 0.5 * beam_frequency(kind, SCARA_ARM.length, 1))
