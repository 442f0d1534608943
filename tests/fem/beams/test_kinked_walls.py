"""Bending of walls at kinks of boxes and I-sections, against closed forms and solids."""

import numpy as np
import pytest

from fem.beams.kinked_walls import kink_compliances
from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import LineLeg, Material
from lumped.sections import HollowRectangle, ISection
from validation.solids.line_beams import computed_tip

ALLOY = Material.isotropic(E=7.0e10, nu=0.3, rho=2700.0)
ROOT, TIP = HollowRectangle(0.1, 0.08, 0.004), HollowRectangle(0.1, 0.056, 0.004)


def tube(*stations):
    tip = (stations[-1][0], 0.0, 0.0)
    return LineLeg(CentreLine((LinePiece((0.0, 0.0, 0.0), tip),), (0.0, 0.0, 1.0)), stations, ALLOY)


def test_one_kink_bends_two_flanges_by_closed_form():
    """Tension: flanges of width b = 96 mm with n = t/A and α = 0.024/2·0.3 bend by 0.00657 b³/D.

    Integral of the deflections of a strip with simply supported edges, by its sine series.
    """
    leg = tube((0.0, ROOT), (0.3, ROOT), (0.6, TIP))
    plate = 7.0e10 * 0.004**3 / (12.0 * 0.91)
    load = 0.004 / ROOT.area * 0.024 / 0.6
    orders = np.arange(1, 40, 2) * np.pi / 0.096
    mean = np.sum((2.0 / (orders * 0.048)) ** 2 / 2.0 / (4.0 * plate * orders**3))
    assert kink_compliances(leg)[0] == pytest.approx(2.0 * 0.096 * load**2 * mean, rel=1e-6)


def test_tapers_without_kinks_add_nothing():
    assert not kink_compliances(tube((0.0, ROOT), (0.6, TIP))).any()
    middle = HollowRectangle(0.1, 0.068, 0.004)
    assert not kink_compliances(tube((0.0, ROOT), (0.3, middle), (0.6, TIP))).any()


def test_kink_at_step_is_bounded_by_thinner_wall():
    """The bound is the same whether the wall is thicker before the kink or behind it."""
    thick = HollowRectangle(0.1, 0.08, 0.008)
    kinked = tube((0.0, ROOT), (0.3, ROOT), (0.6, TIP))
    stepped = tube((0.0, thick), (0.3, thick), (0.3, ROOT), (0.6, TIP))
    reverse = tube(
        (0.0, ROOT), (0.3, ROOT), (0.3, thick), (0.6, HollowRectangle(0.1, 0.056, 0.008))
    )
    tension = [kink_compliances(leg)[0] for leg in (kinked, stepped, reverse)]
    assert tension == pytest.approx([tension[0]] * 3, rel=1e-12)


def test_flange_bends_as_cantilevers_on_foundations():
    """Tension: the first cantilever mode across half a flange, λ = 1.8751, does 98 % of the work.

    Its share of a uniform load is 2σ/λ = 0.7830, σ = 0.7341. A beam of stiffness B on a foundation
    Bλ⁴/c⁴ deflects by P c³/(2√2 B λ³) under a force P.
    """
    root, tip = (ISection(0.08, height, 0.004, 0.004) for height in (0.1, 0.07))
    leg = tube((0.0, root), (0.3, root), (0.6, tip))
    strip = 0.7 * 7.0e10 * 0.004**3 / (12.0 * 0.91)
    load = 0.004 / root.area * 0.5 * 0.03 / 0.3
    first = load**2 * 0.7830**2 * 0.04**4 / (2.0**1.5 * strip * 1.8751**3)
    assert kink_compliances(leg)[0] == pytest.approx(4.0 * first / 0.979, rel=2e-3)


@pytest.mark.parametrize(
    ("root", "tip", "softened"),
    [
        (ROOT, TIP, [0, 2, 4]),
        (ISection(0.08, 0.1, 0.004, 0.004), ISection(0.08, 0.07, 0.004, 0.004), [0, 1, 2, 4, 5]),
    ],
    ids=["box", "I"],
)
def test_solid_with_kinks_is_softer_within_bounds(root, tip, softened):
    """Solids are 2 to 30 % softer than their beams, by more than a quarter of the bounds."""
    leg = tube((0.0, root), (0.12, root), (0.24, tip), (0.36, tip))
    solid = clamped_leg(solid_leg(leg, solid_mesh(leg, 4)), "free").compliance
    added = np.diagonal(solid - computed_tip(leg, 4))
    bounds = kink_compliances(leg)
    assert (added[softened] > 0.02 * np.diagonal(solid)[softened]).all()
    assert (added[softened] > 0.25 * bounds[softened]).all()
    assert (added[softened] < bounds[softened]).all()
