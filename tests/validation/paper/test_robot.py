"""What the paper's statements compute from, by hand and solved once more."""

import csv
import io
import pickle

import numpy as np
import pytest
from like_ifw import IFW as ROBOT
from numpy.testing import assert_allclose

from lumped.errors import InputError
from validation import paper
from validation.context import Context
from validation.models.options import ModelOptions
from validation.paper.curves import cosine_spaced, frequencies_over_the_stroke
from validation.paper.robot import (
    Places,
    deflections,
    family,
    frequencies,
    member,
    over_stroke,
    stroke_of,
)


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


def test_stations_reach_both_ends_and_the_centre():
    x = cosine_spaced(0.145, 0.85, 21)
    assert (x[0], x[10], x[-1]) == pytest.approx((0.145, 0.4975, 0.85), rel=1e-12)
    assert (np.diff(x) > 0.0).all()
    # Every posture is one of the robot's: none is outside by rounding.
    assert [at.pose[0] for at in Places(ROBOT.mechanism, x).postures] == pytest.approx(x)


@pytest.mark.exhaustive
def test_the_printed_release_has_a_curve_of_its_own():
    figure = frequencies_over_the_stroke(Context(ROBOT, "quick"))
    centre = list(csv.DictReader(io.StringIO(figure.data)))[10]
    # Orientation values of an independent computation: 184 Hz, and about 300 Hz as printed.
    for column, number, within in (
        ("x (m)", 0.4975, 1e-6),
        ("beam FE: frequency 2 (Hz)", 184.0, 0.005),
        ("segments, eq. (25) as printed: frequency 2 (Hz)", 300.0, 0.02),
    ):
        assert float(centre[column]) == pytest.approx(number, rel=within)
    assert figure.svg.startswith("<svg")


def test_the_figures_can_be_sent_to_another_process():
    found = pickle.loads(pickle.dumps(paper.figures()))  # noqa: S301  our own
    assert len({figure.id for figure in found}) == len(found) == 4
