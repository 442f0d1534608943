"""Distortion of tapered rectangular tubes in torsion, against solids."""

from dataclasses import replace

import numpy as np
import pytest

from fem.beams.box_distortion import distortion_work
from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import LineLeg, Material
from lumped.sections import HollowRectangle
from validation.comparisons.line_leg_vs_solid import computed_tip

ALLOY = Material.isotropic(E=7.0e10, nu=0.3, rho=2700.0)


def tube(first, last, length=0.4):
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (length, 0.0, 0.0)),), (0.0, 0.0, 1.0))
    return LineLeg(line, ((0.0, first), (length, last)), ALLOY)


def test_unequal_taper_twists_like_solid():
    """Torsion of the solid with free ends is 1.70 times as flexible as by beam theory.

    The flexibility of distortion differs from this increase by 6 %, the error of this mesh; with
    walls of half the thickness by 2 %.
    """
    leg = tube(HollowRectangle(0.1, 0.08, 0.002), HollowRectangle(0.1, 0.056, 0.002))
    solid = clamped_leg(solid_leg(leg, solid_mesh(leg, 1)), "free").compliance[3, 3]
    beam = computed_tip(leg, 1)[3, 3]
    assert solid / beam == pytest.approx(1.705, rel=0.01)
    assert distortion_work(leg, np.ones_like) == pytest.approx(solid - beam, rel=0.08)


def test_equal_taper_does_not_distort():
    """A tube whose width and height fall in one ratio: no work of distortion."""
    first, last = HollowRectangle(0.1, 0.08, 0.004), HollowRectangle(0.07, 0.056, 0.0028)
    reference = distortion_work(tube(first, replace(first, height=0.056)), np.ones_like)
    assert distortion_work(tube(first, last), np.ones_like) < 1e-12 * reference


def test_short_taper_distorts_by_closed_form():
    """Work ∫ (T Δ/2)² (b* + h*)/24D dx with the symbols of `fem.beams.box_distortion`.

    With twice the length of the leg Δ is half as large, and so is the work.
    """
    first, last = HollowRectangle(0.1, 0.08, 0.004), HollowRectangle(0.1, 0.079, 0.004)
    work = distortion_work(tube(first, last), np.ones_like)
    plate = 7.0e10 * 0.004**3 / 12.0 / (1.0 - 0.3**2)
    rate = 0.001 / 0.4 / 0.0755
    expected = 0.4 * (0.5 * rate) ** 2 * (0.092 + 0.0715) / (24.0 * plate)
    # Second order in the relative change of the height, 1/80.
    assert work == pytest.approx(expected, rel=1e-3)
    halved = distortion_work(tube(first, last, 0.8), np.ones_like)
    assert halved == pytest.approx(work / 2.0, rel=1e-6)
