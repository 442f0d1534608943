"""Equations (1), (2) and (12) in closed form against the general model on elastic drives."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lumped.robot_file import load_robot
from validation.models.mechanism import answers
from validation.paper.formula_errata import drive_compliance, jacobian
from validation.paper.robot import (
    deflections,
    frequencies,
    member,
    over_stroke,
    stroke_of,
)


@pytest.mark.parametrize("alpha", [1.0, 1.7])
def test_rigid_bodies_on_drives_have_the_compliance_of_equation_1(alpha):
    mechanism = member(load_robot("ifw"), alpha).mechanism
    (places,) = over_stroke(mechanism, 7)
    found = answers("simplified", places.postures, 1)
    for station, answer in zip(places.x, found, strict=True):
        J = jacobian(stroke_of(mechanism), station)
        expected = drive_compliance(J, 1.0e9 * np.eye(2))
        # 2×2 solves of condition below 10; at the ends of the stroke s = √(L² − x²) is √ε
        assert_allclose(answer.compliance[:2, :2], expected, rtol=1e-10, atol=1e-23)
        # eq. (12) with the work balance: the softest direction of J K⁻¹ Jᵀ carries 46 kg
        first = 1.0 / np.sqrt(46.0 * np.linalg.eigvalsh(expected)[-1]) / (2.0 * np.pi)
        assert answer.frequencies[0] == pytest.approx(first, rel=1e-10)


def test_deflections_and_frequencies_on_drives_are_the_papers():
    """Known values: 1.063 µm near x = 0.497 under fx (paper §2.1: below 1.1), 0.503 under fy in
    the middle, 1.0 at both ends; first frequencies of 713.4 to 756.2 Hz (§3.1: above 710)."""
    mechanism = load_robot("ifw").mechanism
    (places,) = over_stroke(mechanism, 201)
    found = deflections("simplified", [places])
    assert found.planar_x.max() == pytest.approx(1.063, abs=0.0005)
    # The maximum is flat: 0.01 m beside it the deflection has changed by its fourth digit.
    assert places.x[found.planar_x.argmax()] == pytest.approx(0.497, abs=0.01)
    assert found.planar_y[[0, 100, -1]] == pytest.approx([1.0, 0.503, 1.0], abs=0.0005)
    first = frequencies("simplified", [places], 1)
    assert [first.min(), first.max()] == pytest.approx([713.4, 756.2], abs=0.05)


def test_both_ends_of_the_stroke_hold_b_along_x():
    stroke = stroke_of(load_robot("ifw").mechanism)
    for x in stroke.ends:
        assert_allclose(jacobian(stroke, x)[0], 0.0, atol=1e-7)
