"""What the paper's statements compute from, by hand and solved once more."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lumped.errors import InputError
from lumped.robot_file import load_robot
from validation.models.options import ModelOptions
from validation.paper.robot import (
    deflections,
    family,
    frequencies,
    member,
    over_stroke,
    stroke_of,
)

ROBOT = load_robot("ifw")


def on_drives(stroke, x):
    """Compliance (m/N, 2×2) of B along x and y: legs rigid, drives of 1e9 N/m.

    A slide at (p, y_A) with |B − A| = L: (x − p) δx + s (δy − δy_A) = 0, s the leg's height.
    """
    heights = np.sqrt([stroke.length1**2 - x**2, stroke.length2**2 - (stroke.a - x) ** 2])
    arms = np.column_stack([[x, x - stroke.a], heights])
    from_slides = np.linalg.solve(arms, np.diag(heights))
    return from_slides @ from_slides.T / 1.0e9


@pytest.mark.parametrize("fraction", [0.1, 0.8])
def test_the_family_on_drives_is_virtual_power(fraction):
    """Eqs (1), (2) and, with the work balance, (12): J K⁻¹ Jᵀ carries the 46 kg of the platform."""
    members = family(ROBOT, fraction, (1.1, 1.25))
    found = deflections("simplified", members)
    first = frequencies("simplified", members, 1)[:, 0]
    given = stroke_of(ROBOT.mechanism)
    for place, alpha in enumerate((1.1, 1.25)):
        stroke = stroke_of(member(ROBOT, alpha).mechanism)
        assert stroke.length == pytest.approx(given.length)
        assert [stroke.length1, stroke.length2] == pytest.approx([alpha * 0.85, alpha * 0.775])
        x = stroke.ends[0] + fraction * stroke.length
        compliance = on_drives(stroke, x)
        moved = np.linalg.norm(compliance, axis=0) * 1e9
        assert [found.planar_x[place], found.planar_y[place]] == pytest.approx(moved, rel=1e-9)
        softest = np.linalg.eigvalsh(compliance)[-1]
        expected = 1.0 / np.sqrt(46.0 * softest) / (2.0 * np.pi)
        assert first[place] == pytest.approx(expected, rel=1e-9)
    assert np.isnan(found.along_z).all()


def test_deflections_and_frequencies_on_drives_are_the_papers():
    """Known values: 1.063 µm near x = 0.497 under fx (paper §2.1: below 1.1), 0.503 under fy in
    the middle, 1.0 at both ends; first frequencies of 713.4 to 756.2 Hz (§3.1: above 710)."""
    (places,) = over_stroke(ROBOT.mechanism, 201)
    found = deflections("simplified", [places])
    assert found.planar_x.max() == pytest.approx(1.063, abs=0.0005)
    # The maximum is flat: 0.01 m beside it the deflection has changed by its fourth digit.
    assert places.x[found.planar_x.argmax()] == pytest.approx(0.497, abs=0.01)
    assert found.planar_y[[0, 100, -1]] == pytest.approx([1.0, 0.503, 1.0], abs=0.0005)
    assert found.largest_planar == pytest.approx(1.063, abs=0.0005)
    at_ends = deflections("simplified", over_stroke(ROBOT.mechanism, 2))
    assert at_ends.largest_planar == pytest.approx(1.0, abs=0.0005)
    first = frequencies("simplified", [places], 1)
    assert [first.min(), first.max()] == pytest.approx([713.4, 756.2], abs=0.05)


def test_longer_legs_are_stiffer_in_the_plane_and_softer_along_z():
    """Known values, α = 1 and 2 at the centre, to half a unit of the last digit (physics notes)."""
    slender = ModelOptions(legs="equivalent", theory="euler-bernoulli")
    found = deflections("vjm", family(ROBOT, 0.5, (1.0, 2.0)), slender)
    assert found.planar_x == pytest.approx([7.3, 3.0], abs=0.05)
    assert found.along_z == pytest.approx([23.0, 85.0], abs=0.5)


def test_both_ends_of_the_stroke_are_rigid_along_x_on_drives():
    stroke = stroke_of(ROBOT.mechanism)
    for x in stroke.ends:
        assert_allclose(on_drives(stroke, x)[0], 0.0, atol=1e-16)
    found = frequencies("simplified", over_stroke(ROBOT.mechanism, 2), 2)
    assert_allclose(found[:, 0], np.sqrt(1.0e9 / 46.0) / (2.0 * np.pi), rtol=1e-7)
    assert np.isinf(found[:, 1]).all()


def test_a_member_that_cannot_be_is_refused():
    with pytest.raises(InputError, match=r"geometry\.alpha"):
        member(ROBOT, 0.4)
    with pytest.raises(InputError, match="foot"):
        ROBOT.with_values({"foot.compliance[6,6]": 3.16e-9})
