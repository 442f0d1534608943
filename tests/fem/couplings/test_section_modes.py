"""Frequencies of cantilevers from modes of the section, against waves, closed forms and solids."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.robots.paper_legs import STEEL

from fem.beams.beam_theory import cantilever_frequencies
from fem.couplings.section_fields import section_fields
from fem.couplings.section_modes import (
    lowest_section_frequency,
    prism_modes,
    saint_venant_frequencies,
)
from fem.couplings.wave_cantilever import cut_off, prism_frequency
from fem.couplings.wave_stiffness import prism_waves
from lumped.legs import ConstantLeg
from lumped.sections import Angle, Channel, ISection, Rectangle
from meshes.section.section_mesh import section_mesh
from validation.solids.leg_meshes import face_mesh
from validation.solids.solid_legs import computed_properties, leg_constants

CHANNEL = ConstantLeg(0.6, Channel(0.05, 0.1, 0.0085, 0.006), STEEL)
I_BEAM = ConstantLeg(0.8, ISection(0.1, 0.16, 0.012, 0.008), STEEL)


def fields_by_name(leg, divisions=4):
    fields = section_fields(face_mesh(leg, divisions), leg.material)
    return {group.name: group for group in fields}


def frequencies(leg, name, count, ends="free"):
    fields = fields_by_name(leg)[name]
    return prism_modes(fields, leg.length, ends, np.array([leg.length]), count).frequencies


@pytest.mark.parametrize(
    ("name", "tolerance"), [("torsion", 6e-4), ("bending z", 3e-5), ("bending y", 3e-5)]
)
def test_section_modes_equal_all_fields(name, tolerance):
    """An I-section has frequencies from all its fields e^{γx}, which are exact along the leg.

    Ritz's method gives an upper bound. The last level changes torsion by 6.3e-4.
    """
    waves = prism_waves(face_mesh(I_BEAM, 4), STEEL)
    (kind,) = (kind for kind in waves if kind.fields.name == name)
    (frequency,) = frequencies(I_BEAM, name, 1)
    exact = prism_frequency(kind, I_BEAM.length, frequency)
    assert exact < frequency < (1.0 + tolerance) * exact
    assert lowest_section_frequency(kind.fields) == pytest.approx(cut_off(kind), rel=1e-9)


@pytest.mark.parametrize("section", [CHANNEL.section, Angle(0.05, 0.08, 0.01, 0.01)])
def test_saint_venant_beam_is_timoshenko(section):
    """Coupled bending and torsion of a beam with the section's constants (Huang's equation)."""
    leg = ConstantLeg(0.6, section, STEEL)
    beams = cantilever_frequencies(computed_properties(leg, 4), leg.length, 6)
    groups = fields_by_name(leg).values()
    by_states = np.sort(
        np.concatenate([saint_venant_frequencies(group, leg.length, 6) for group in groups])
    )
    assert_allclose(by_states[:6], [mode.frequency for mode in beams], rtol=2e-8)


def test_held_i_section_equals_vlasov():
    """Torsion of a slender I-section whose faces do not warp: Vlasov's rod in closed form.

    GJ θ″ − EΓ θ⁗ + ω²ρI_p θ = 0 with θ = θ′ = 0 at the root, and θ′ = 0 and no torque at the tip.
    With the roots −α² and β² of the characteristic equation, α tan αL = −β tanh βL.
    """
    leg = replace(I_BEAM, length=2.4)
    constants = leg_constants(leg, 4)
    GJ, warping = STEEL.G * constants.torsion_constant, STEEL.E * constants.warping_constant
    polar = STEEL.rho * (constants.second_moment_y + constants.second_moment_z)
    (frequency,) = frequencies(leg, "torsion", 1, "rigid")
    inertia = polar * (2.0 * np.pi * frequency) ** 2
    root = np.sqrt(0.25 * GJ**2 + inertia * warping)
    alpha, beta = np.sqrt((root - 0.5 * GJ) / warping), np.sqrt((root + 0.5 * GJ) / warping)
    # Vlasov neglects shear strain of the flanges' bending and distortion: 0.6 % at this length.
    misfit = alpha * np.tan(alpha * leg.length) + beta * np.tanh(beta * leg.length)
    slope = alpha**2 * leg.length / np.cos(alpha * leg.length) ** 2
    assert abs(misfit / slope) < 0.01
    assert frequency > 1.2 * np.sqrt(GJ / polar) / (4.0 * leg.length)


@pytest.mark.parametrize(
    ("leg", "name", "length", "exponent"),
    [
        (I_BEAM, "torsion", 6.4, -1.86),
        (CHANNEL, "torsion with bending y", 2.4, -4.0),
        # At 4.8 m the change is 6e-6, and its round-off 1e-6.
        (CHANNEL, "tension with bending z", 1.2, -2.42),
    ],
)
def test_change_falls_with_power_of_slenderness(leg, name, length, exponent):
    """Exponents of the relative change of the first frequency by warping and distortion.

    The stiffness of warping over that of torsion is EΓ/GJL², with the exponent −2, from which free
    ends take a part of the third order, so that −2 is approached from above. In the first
    mode of a slender channel, bending, the share of torsion in the energy is of order EI/GJL² as
    well, so that the exponent is −4. Contraction and shear have −2, inertia that bends walls −4.
    """
    fields = fields_by_name(leg)[name]
    changes = []
    for long in (length, 2.0 * length):
        (prism,) = prism_modes(fields, long, "free", np.array([long]), 1).frequencies
        (beam,) = saint_venant_frequencies(fields, long, 1)
        changes.append(prism / beam - 1.0)
    assert np.log2(changes[1] / changes[0]) == pytest.approx(exponent, abs=0.1)


def test_free_warping_does_not_change_tension_of_rectangle():
    """Without Poisson's ratio a bar in tension has the frequency √(E/ρ)/4L."""
    material = replace(STEEL, nu=0.0)
    leg = ConstantLeg(0.5, Rectangle(0.03, 0.05), material)
    fields = section_fields(section_mesh(leg.section, 1), material)[0]
    (frequency,) = prism_modes(fields, leg.length, "rigid", np.array([0.5]), 1).frequencies
    assert frequency == pytest.approx(np.sqrt(material.E / material.rho) / 2.0, rel=1e-9)
