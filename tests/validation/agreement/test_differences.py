"""Measurements of one number: the farthest of what should be nothing, and what two meshes give."""

import pytest

from validation.agreement.differences import farthest_off, farthest_refined, refined
from validation.case import Measurement


def test_the_farthest_of_numbers_that_should_be_zero():
    assert farthest_off([0.0, -3.0, 2.0]) == Measurement(3.0, 0.0, exact=True)
    assert farthest_off([1.0, float("nan")]).value != 1.0


def test_two_meshes_leave_their_step_by_order_and_ratio():
    # 3/(2² − 1) = 1 and 3/(√2⁴ − 1) = 1 of the step.
    for order, ratio in ((2.0, 2.0), (4.0, 2.0**0.5)):
        found = refined(1.5, 1.25, 1.0, order=order, ratio=ratio)
        assert (found.value, found.reference) == (1.25, 1.0)
        assert found.value_uncertainty == pytest.approx(0.25)


def test_the_farthest_of_two_meshes_has_the_step_of_its_own_number():
    found = farthest_refined([[0.5, -4.0], [9.0, 0.0]], [[1.0, -3.0], [2.0, 0.0]], order=2.0)
    assert (found.value, found.reference) == (3.0, 0.0)
    assert found.value_uncertainty == pytest.approx(1.0)
