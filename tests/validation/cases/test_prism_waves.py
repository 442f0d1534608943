"""Waves in a prism: long ones are the beam's, shorter ones slow down as Rayleigh found."""

from math import pi, sqrt

import numpy as np
import pytest
from prism_waves import beam_wave_frequency, prism_wave_frequency

from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle

SECTION = Rectangle(0.1, 0.2)
STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)


@pytest.mark.parametrize("kind", ["bending", "torsion", "tension"])
def test_long_waves_are_the_beams(kind):
    beam = ConstantLeg(1.0, SECTION, STEEL).timoshenko
    errors = [
        prism_wave_frequency(SECTION, STEEL, kind, k) / beam_wave_frequency(beam, kind, k) - 1.0
        for k in (1.0, 0.5)
    ]
    # (k h)² is 0.01 for the longer wave, and beam theory's corrections are small parts of it.
    assert abs(errors[1]) < 1e-4
    # Exponent 2 in the slenderness, as for every such correction; (k h)² moves it by a per cent.
    assert np.log2(errors[0] / errors[1]) == pytest.approx(2.0, abs=0.03)


def test_tension_waves_slow_down_as_rayleigh_found():
    k = 0.5
    beam = ConstantLeg(1.0, SECTION, STEEL).timoshenko
    polar = beam.rho_J / beam.mu
    found = prism_wave_frequency(SECTION, STEEL, "tension", k)
    slowing = 1.0 - found / beam_wave_frequency(beam, "tension", k)
    # Rayleigh, Theory of Sound, §157: lateral inertia, ν² k² I_p/2A; next order (k h)² relative.
    assert slowing == pytest.approx(STEEL.nu**2 * k**2 * polar / 2.0, rel=0.02)


def test_without_poissons_ratio_tension_waves_are_exact_at_any_length():
    cork = Material.isotropic(1e9, 0.0, 1000.0)
    for k in (1.0, 10.0):
        expected = k * sqrt(cork.E / cork.rho) / (2.0 * pi)
        # A constant axial displacement is among the polynomials: rounding alone.
        assert prism_wave_frequency(SECTION, cork, "tension", k) == pytest.approx(
            expected, rel=1e-10
        )
