"""The stroke of the biglide, the α family and its constructor against geometry by hand."""

from fractions import Fraction

import numpy as np
import pytest
from like_ifw import LEG1, LEG2, like_ifw
from numpy.testing import assert_allclose

from lumped.errors import InputError
from lumped.legs import equivalent_leg
from lumped.mechanism.biglide import Stroke, lengthened

STROKE = Stroke(0.92, 0.85, 0.775)


def test_stroke_of_the_demonstrator():
    """Known values: from a − L2 = 0.145 m to L1 = 0.85 m; d = L1 + L2 − a = 0.705 m."""
    assert STROKE.ends == pytest.approx((0.145, 0.85), rel=1e-14)
    assert STROKE.length == pytest.approx(0.705, rel=1e-14)
    assert STROKE.centre == pytest.approx(0.4975, rel=1e-14)
    # Poses are of B, wherever the loaded point is.
    robot = like_ifw(tool_offset=np.array([0.03, -0.02, 0.155]))
    assert_allclose(robot.poses[[0, 4, 8], 0], [0.145, 0.4975, 0.85], rtol=1e-14)
    assert robot.reference_pose == pytest.approx([0.4975], rel=1e-14)


@pytest.mark.parametrize("x", [0.145, 0.3, 0.4975, 0.85])
def test_legs_reach_from_their_slides_to_b(x):
    for leg, slide, length in zip(STROKE.legs_at(x), (0.0, 0.92), (0.85, 0.775), strict=True):
        assert leg.position[0] == slide
        assert leg.position[1] <= 0.0  # both legs on the same side
        along, across, up = leg.rotation.T
        assert_allclose(leg.position + length * along, [x, 0.0, 0.0], atol=1e-15)
        assert_allclose(across, np.cross(up, along), atol=1e-15)
        assert_allclose(up, [0.0, 0.0, 1.0])


@pytest.mark.parametrize("short", [1e-3, 1e-6, 1e-9, 1e-12])
def test_heights_near_the_ends_of_the_stroke_keep_their_digits(short):
    """Against rational arithmetic: L² − x² alone would have 1e-16 L² of rounding."""
    stroke = Stroke(0.75, 0.85, 0.775)
    for x in (stroke.ends[0] + short, stroke.ends[1] - short):
        bases = Fraction(x), Fraction(stroke.a) - Fraction(x)
        for leg, length, base in zip(stroke.legs_at(x), (0.85, 0.775), bases, strict=True):
            height = float(Fraction(length) ** 2 - base**2) ** 0.5
            assert -leg.position[1] == pytest.approx(height, rel=1e-15)


@pytest.mark.parametrize("x", [0.1449, 0.8501, -1.0, np.nan, np.inf])
def test_postures_outside_the_stroke(x):
    with pytest.raises(InputError, match=r"outside the stroke 0.145 m to 0.85 m"):
        STROKE.legs_at(x)


@pytest.mark.parametrize("alpha", [0.7, 1.0, 2.0])
def test_family_keeps_stroke_and_section(alpha):
    """Eqs (10), (11): L = α L0, d the same, a = α (L10 + L20) − d; EA, EI, GJ, μ the same."""
    a, *legs = lengthened(0.92, LEG1, LEG2, alpha)
    assert a == pytest.approx(alpha * 1.625 - 0.705, rel=1e-14)
    for leg, original in zip(legs, (LEG1, LEG2), strict=True):
        assert leg.timoshenko == equivalent_leg(original).timoshenko
        found, expected = (leg.length, leg.mass), (original.length, original.mass)
        assert found == pytest.approx(alpha * np.array(expected), rel=1e-14)


def test_family_begins_where_the_legs_can_meet():
    """a > α |L10 − L20| gives α > d / (2 L20) = 0.705/1.55 = 0.4548; a > 0 gives 0.4338."""
    for alpha, said in ((0.4549, ""), (0.4548, "never becomes horizontal"), (0.43, "a > 0")):
        a, leg1, leg2 = lengthened(0.92, LEG1, LEG2, alpha)
        faults = "".join(Stroke(a, leg1.length, leg2.length).faults())
        assert bool(faults) == bool(said)
        assert said in faults
