"""Postures of the biglide and the α family against geometry by hand."""

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lumped.biglide import geometry_faults, scaled, with_equivalent_legs
from lumped.errors import InputError


def test_stroke_of_the_demonstrator(demonstrator):
    """Known values: from a − L2 = 0.145 m to L1 = 0.85 m; d = L1 + L2 − a = 0.705 m."""
    assert demonstrator.stroke == pytest.approx((0.145, 0.85), rel=1e-14)
    assert demonstrator.stroke_length == pytest.approx(0.705, rel=1e-14)
    assert demonstrator.centre == pytest.approx(0.4975, rel=1e-14)
    assert_allclose(demonstrator.stations(4), [0.145, 0.38, 0.615, 0.85], rtol=1e-14)


@pytest.mark.parametrize("x", [0.145, 0.3, 0.4975, 0.85])
def test_legs_reach_from_their_slides_to_b(demonstrator, x):
    posture = demonstrator.posture(x)
    assert_allclose(posture.tip, [x, 0.0, 0.0])
    assert posture.root1[0] == 0.0
    assert posture.root2[0] == 0.92
    for root, rotation, leg in (
        (posture.root1, posture.rotation1, demonstrator.leg1),
        (posture.root2, posture.rotation2, demonstrator.leg2),
    ):
        assert_allclose(root + leg.length * rotation[:, 0], posture.tip, atol=1e-15)
        assert_allclose(rotation.T @ rotation, np.eye(3), atol=1e-15)
        assert_allclose(rotation[:, 2], [0.0, 0.0, 1.0])
        assert root[1] <= 0.0  # both legs on the same side


def test_singular_ends(demonstrator):
    """Leg 2 points along −x at the first end, leg 1 along +x at the last one."""
    first, last = (demonstrator.posture(x) for x in demonstrator.stroke)
    assert_allclose(first.rotation2[:, 0], [-1.0, 0.0, 0.0], atol=1e-15)
    assert first.s1 == pytest.approx(np.sqrt(0.85**2 - 0.145**2), rel=1e-14)
    assert_allclose(last.rotation1[:, 0], [1.0, 0.0, 0.0], atol=1e-15)
    assert last.s2 == pytest.approx(np.sqrt(0.775**2 - 0.07**2), rel=1e-14)


@pytest.mark.parametrize("short", [1e-3, 1e-6, 1e-9, 1e-12])
def test_heights_near_the_ends_of_the_stroke_keep_their_digits(demonstrator, short):
    """Against rational arithmetic: L² − x² alone would have 1e-16 L² of rounding."""
    robot = replace(demonstrator, a=0.75)
    for x in (robot.stroke[0] + short, robot.stroke[1] - short):
        posture = robot.posture(x)
        for height, length, base in (
            (posture.s1, robot.leg1.length, Fraction(x)),
            (posture.s2, robot.leg2.length, Fraction(robot.a) - Fraction(x)),
        ):
            assert height == pytest.approx(float(Fraction(length) ** 2 - base**2) ** 0.5, rel=1e-15)


@pytest.mark.parametrize("x", [0.1449, 0.8501, -1.0, np.nan, np.inf])
def test_postures_outside_the_stroke(demonstrator, x):
    with pytest.raises(InputError, match=r"outside the stroke 0.145 m to 0.85 m"):
        demonstrator.posture(x)


@pytest.mark.parametrize("alpha", [0.7, 1.0, 2.0])
def test_family_keeps_stroke_and_section(demonstrator, alpha):
    """Eqs (10), (11): L = α L0, d the same, a = α (L10 + L20) − d; EA, EI, GJ, μ the same."""
    member, base = scaled(demonstrator, alpha), with_equivalent_legs(demonstrator)
    assert member.leg1.length == pytest.approx(alpha * 0.85, rel=1e-14)
    assert member.leg2.length == pytest.approx(alpha * 0.775, rel=1e-14)
    assert member.a == pytest.approx(alpha * 1.625 - 0.705, rel=1e-14)
    assert member.stroke_length == pytest.approx(0.705, rel=1e-13)
    for leg, original in ((member.leg1, base.leg1), (member.leg2, base.leg2)):
        assert leg.timoshenko == original.timoshenko
        assert leg.mass == pytest.approx(alpha * original.mass, rel=1e-14)


def test_family_begins_where_the_legs_can_meet(demonstrator):
    """a > α |L10 − L20| gives α > d / (2 L20) = 0.705/1.55 = 0.4548; a > 0 gives 0.4338."""
    assert not geometry_faults(scaled(demonstrator, 0.4549))
    with pytest.raises(InputError, match=r"α = 0.4548: .* never becomes horizontal"):
        scaled(demonstrator, 0.4548)
    with pytest.raises(InputError, match="the slides must be apart"):
        scaled(demonstrator, 0.43)


def test_geometry_faults(demonstrator):
    assert geometry_faults(demonstrator) == []
    assert "cannot meet" in geometry_faults(replace(demonstrator, a=1.7))[0]
    assert "must be apart" in geometry_faults(replace(demonstrator, a=0.0))[0]
    assert "differ by a = 0.05" in geometry_faults(replace(demonstrator, a=0.05))[0]
