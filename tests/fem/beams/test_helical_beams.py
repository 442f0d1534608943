"""Legs whose fibres wind around them: tension twists them, shear forces bend them sideways."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from scipy.linalg import eigh

from fem.beams.beam import beam_leg
from fem.beams.beam_theory import cantilever_frequencies
from fem.bodies import doubling
from lumped.arrays import dense
from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg, Material
from lumped.models.bodies import clamped_modes
from lumped.models.segments import segment_chain, segment_leg
from lumped.sections import LaminateBox, LaminateTube, Layer
from meshes.section.section_mesh import section_mesh
from validation.cases.ritz_legs import ritz_beam
from validation.solids.solid_legs import computed_properties

# T300/5208 carbon and epoxy (S. W. Tsai, H. T. Hahn, Introduction to Composite Materials, 1980,
# table 1.7): Pa.
CARBON = {"E1": 181e9, "E2": 10.3e9, "G12": 7.17e9, "nu12": 0.28, "rho": 1600.0}


def helix(shape="tube", angle=30.0, thickness=3e-3, length=0.6):
    layers = (Layer(**CARBON, thickness=thickness, angle=angle),)
    section = LaminateTube(layers, 0.06) if shape == "tube" else LaminateBox(layers, 0.06, 0.04)
    return ConstantLeg(length, section, Material(*section.mean_material))


def scaled(matrix, reference):
    size = np.sqrt(np.diag(reference))
    return np.abs((matrix - reference) / np.outer(size, size)).max()


@pytest.mark.parametrize("angle", [15.0, -30.0, 60.0])
def test_helical_tube_has_closed_form_compliance(angle):
    """The wall is an off-axis ply under n = N/2πr and q = T/2πr² (R. M. Jones, §2.6, eqs 2.97).

    A wall of finite thickness t differs by (t/r)².
    """
    leg = helix(angle=angle, thickness=1e-5)
    c, s = cos(radians(angle)), sin(radians(angle))
    s11, s22, s66 = 1.0 / CARBON["E1"], 1.0 / CARBON["E2"], 1.0 / CARBON["G12"]
    s12 = -CARBON["nu12"] * s11
    along = s11 * c**4 + (2.0 * s12 + s66) * s**2 * c**2 + s22 * s**4
    shear = (2.0 * s11 - 2.0 * s12 - s66) * s * c**3 - (2.0 * s22 - 2.0 * s12 - s66) * s**3 * c
    twist = 4.0 * (s11 + s22 - 2.0 * s12) * s**2 * c**2 + s66 * (c**2 - s**2) ** 2
    radius, wall = 0.03 - 0.5e-5, 1e-5
    beam = leg.timoshenko
    round_area = 2.0 * pi * radius * wall
    assert pytest.approx(round_area / along, rel=1e-5) == beam.EA
    assert pytest.approx(round_area * radius**2 / twist, rel=1e-5) == beam.GJ
    assert beam.twist_x == pytest.approx(shear / (round_area * radius), rel=1e-5)
    assert beam.turn_y == pytest.approx(-2.0 * shear / (round_area * radius), rel=1e-5)
    assert pytest.approx(0.5 * round_area / twist, rel=1e-5) == beam.GAy


@pytest.mark.parametrize(("shape", "tolerance"), [("tube", 0.012), ("box", 0.08)])
def test_helical_beam_equals_orthotropic_solid(shape, tolerance):
    """All 36 entries of the tip compliance.

    Laminate theory has an error of (thickness/radius)² = 0.012 in a tube, and of about 2t/(b + h) =
    0.064 by the corners of a box. If the section constants are computed by finite elements, only
    the error of the solid's slices remains, 1e-7.
    """
    leg = helix(shape, length=0.2)
    solid = doubling.tip_compliance(
        doubling.condensed_leg(leg, section_mesh(leg.section, 2), 64), "free"
    )
    assert abs(solid[0, 3]) > 0.7 * np.sqrt(solid[0, 0] * solid[3, 3])
    computed = tip_compliance(computed_properties(leg, 2), leg.length)
    assert scaled(computed, solid) < 1e-6
    assert scaled(tip_compliance(leg.timoshenko, leg.length), solid) < tolerance


@pytest.mark.parametrize("theory", ["timoshenko", "euler-bernoulli"])
def test_helical_elements_are_exact_in_statics(theory):
    """Two beam elements and three segments have the closed form's tip compliance."""
    leg = helix("box")
    beam = leg.properties(theory)
    expected = tip_compliance(beam, leg.length)
    chain = segment_leg(segment_chain(beam, leg.length, 3))
    for model in (beam_leg(beam, leg.length, 2), chain):
        free = dense(model.stiffness)[6:, 6:]
        assert scaled(np.linalg.inv(free)[:6, :6], expected) < 1e-9


def test_helical_beam_frequencies_converge_to_exact():
    """State equations and Ritz polynomials have the same frequencies; elements have order four."""
    leg = helix("box")
    beam = leg.timoshenko
    exact = np.array([mode.frequency for mode in cantilever_frequencies(beam, leg.length, 4)])
    ritz = ritz_beam(beam, leg.length, 9)
    basis = np.linalg.svd(ritz.root)[2][6:].T
    squares = eigh(basis.T @ ritz.stiffness @ basis, basis.T @ ritz.mass @ basis)[0][:4]
    assert np.sqrt(squares) / (2.0 * pi) == pytest.approx(exact, rel=1e-7)
    errors = np.array(
        [
            clamped_modes(beam_leg(beam, leg.length, elements), 4).frequencies / exact - 1.0
            for elements in (4, 8)
        ]
    )
    assert np.all(np.abs(errors[1]) < 2e-4)
    assert errors[0].max() / errors[1].max() == pytest.approx(16.0, rel=0.2)
    uncoupled = 1.0 / (2.0 * pi) * 3.5160 * np.sqrt(beam.EIy / beam.mu) / leg.length**2
    assert exact[0] < uncoupled
