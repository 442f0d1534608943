"""Flanges of tapered I-sections in torsion, against solids and closed forms."""

import numpy as np
import pytest

from fem.beams.tapered_flanges import flange_work
from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import LineLeg, Material
from lumped.sections import ISection
from validation.solids.line_beams import computed_tip

ALLOY = Material.isotropic(E=7.0e10, nu=0.3, rho=2700.0)


def i_leg(*stations, material=ALLOY, width=0.08):
    """Leg whose I-section has walls of 4 mm. `stations` are pairs of position and height (m)."""
    tip = (stations[-1][0], 0.0, 0.0)
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), tip),), (0.0, 0.0, 1.0))
    sections = tuple((at, ISection(width, height, 0.004, 0.004)) for at, height in stations)
    return LineLeg(line, sections, material)


@pytest.mark.parametrize(
    ("stations", "effect"),
    [
        ([(0.0, 0.1), (0.12, 0.1), (0.24, 0.07), (0.36, 0.07)], 0.050),
        ([(0.0, 0.1), (0.12, 0.1), (0.24, 0.05), (0.36, 0.05)], 0.159),
        ([(0.0, 0.1), (0.36, 0.07)], 0.020),
    ],
    ids=["kinks", "steep", "taper"],
)
def test_tapered_flanges_stiffen_torsion_of_solid(stations, effect):
    """The solid with free ends is 2 to 16 % stiffer in torsion than its beam."""
    leg = i_leg(*stations)
    beam = computed_tip(leg, 1)[3, 3]
    change = clamped_leg(solid_leg(leg, solid_mesh(leg, 1)), "free").compliance[3, 3] / beam - 1.0
    assert change == pytest.approx(-effect, abs=1e-3)
    assert flange_work(leg, np.ones_like) / beam == pytest.approx(change, rel=0.08)


def test_stiff_flanges_stay_straight():
    """Flanges and web far stiffer than torsion: u = θ h/2 is linear in x.

    Then θ = θ_L x h_L/L h, and the rotation under a unit torque is (L/h_L)²/(h₀² ∫ GJ/h⁴ dx).
    """
    material = Material(E=7.0e16, nu=0.3, rho=2700.0, G=2.7e10)
    leg = i_leg((0.0, 0.1), (0.8, 0.07), material=material, width=0.02)
    x = np.linspace(0.0, 0.8, 2001)
    height = 0.096 - 0.03 * x / 0.8
    torsion = [2.7e10 * leg.section_at(at).torsion_constant for at in x]
    straight = (0.8 / 0.066) ** 2 / (0.096**2 * np.trapezoid(torsion / height**4, x))
    uniform = np.trapezoid(1.0 / np.array(torsion), x)
    assert straight < 0.98 * uniform
    assert flange_work(leg, np.ones_like) == pytest.approx(straight - uniform, rel=0.015)


def test_flanges_end_at_step_of_height():
    """Flanges on both sides that do not touch each other: a step adds nothing to both tapers."""
    first, second = i_leg((0.0, 0.1), (0.3, 0.08)), i_leg((0.0, 0.06), (0.2, 0.05))
    stepped = i_leg((0.0, 0.1), (0.3, 0.08), (0.3, 0.06), (0.5, 0.05))
    both = flange_work(first, np.ones_like) + flange_work(second, np.ones_like)
    assert flange_work(stepped, np.ones_like) == pytest.approx(both, rel=1e-9)
    # Flanges that touch each other bend as one.
    touching = i_leg((0.0, 0.1), (0.3, 0.08), (0.3, 0.08 - 1e-9), (0.5, 0.05))
    kinked = i_leg((0.0, 0.1), (0.3, 0.08), (0.5, 0.05))
    work = flange_work(touching, np.ones_like)
    assert work == pytest.approx(flange_work(kinked, np.ones_like), rel=1e-6)


def test_parallel_flanges_of_prism_add_nothing():
    prism = i_leg((0.0, 0.1), (0.2, 0.1), (0.4, 0.1))
    rotation = prism.sections("timoshenko").tip_compliance[3, 3]
    assert abs(flange_work(prism, np.ones_like)) < 1e-9 * rotation
    nearly = i_leg((0.0, 0.1), (0.4, 0.1 - 1e-7))
    beam = nearly.sections("timoshenko").tip_compliance[3, 3]
    assert abs(flange_work(nearly, np.ones_like)) < 1e-9 * beam
