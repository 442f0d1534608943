"""Postures against closed forms, and poses that have none."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lumped.biglide import mechanism
from lumped.biglide import postures as biglide_postures
from lumped.errors import InputError
from lumped.mechanism.kinematics.closure import Closure
from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.kinematics.postures import (
    CLOSED,
    posture,
    reference_posture,
)
from lumped.robot_file import load_robot


@pytest.fixture(scope="module")
def ifw():
    return load_robot("ifw").robot


def residual(found) -> float:
    closure = Closure(found.mechanism)
    return float(np.abs(closure.residual(closure.placement(found))).max()) / closure.size


def test_the_biglide_is_where_its_closed_form_puts_it(ifw):
    of = mechanism(ifw)
    first, *inside, last = (posture(of, pose) for pose in of.poses)
    for found in inside:
        expected = ifw.posture(float(found.pose[0]))
        assert found.frames["leg1"].rotation == pytest.approx(expected.rotation1, abs=1e-14)
        assert found.frames["leg2"].rotation == pytest.approx(expected.rotation2, abs=1e-14)
        assert found.frames["slide1"].position == pytest.approx(expected.root1, abs=1e-14)
        assert residual(found) <= CLOSED
    # Where a leg is stretched the posture is a double root: its error is the root of rounding.
    for found, slide in ((first, "slide2"), (last, "slide1")):
        assert found.frames[slide].position[1] == pytest.approx(0.0, abs=1e-7)
        assert residual(found) <= CLOSED


def test_coordinates_are_counted_from_the_reference_posture(ifw):
    reference = mechanism(ifw)
    found = posture(reference, np.array([0.7, 0.05]))
    before, after = ifw.posture(ifw.centre), ifw.posture(0.7)
    slid = after.root1[1] - before.root1[1] + 0.05
    turned = np.arctan2(after.s1, 0.7) - np.arctan2(before.s1, ifw.centre)
    assert found.coordinates["drive1"] == pytest.approx([slid], abs=1e-14)
    assert found.coordinates["foot1"] == pytest.approx([turned], abs=1e-14)
    assert found.coordinates["seat"].shape == (0,)


def test_the_biglide_moves_in_its_plane_and_is_held_three_times_too_often(ifw):
    found = mobility(reference_posture(mechanism(ifw)))
    # Kutzbach: 5 bodies × 6 = 30, constraints 2 × 5 + 3 × 5 + 6 = 31.
    assert (found.mobility, found.constraints, found.redundant, found.idle) == (2, 31, 3, 0)
    assert not found.at_limit


def test_the_end_of_the_stroke_is_a_limit_that_the_drive_reaches_across(ifw):
    found = mobility(*biglide_postures(ifw, (0.85,)))
    assert found.at_limit
    assert (found.stirring, found.barred) == (("drive1",), ("x",))


def test_a_pose_out_of_reach_names_the_joint_that_opens_and_how_far_the_way_went(ifw):
    with pytest.raises(InputError) as caught:
        posture(mechanism(ifw), np.array([0.9, 0.0]))
    # 0.3525 m of 0.4025 m lie within the stroke: 88 %.
    assert "cannot be reached: joint" in str(caught.value)
    assert "ends after 88 %, at x = 0.84" in str(caught.value)


def test_a_pose_has_as_many_numbers_as_the_tool_has_moves(ifw):
    for wrong in ([0.5], [0.5, 0.0, 0.0], [0.5, np.nan]):
        with pytest.raises(InputError, match=r"must be 2 finite numbers \(x, y\)"):
            posture(mechanism(ifw), np.array(wrong))


def test_iteration_ends_where_the_biglide_s_closed_form_does():
    """Poses are of B, from which its loaded point stands off."""
    file = Path(__file__).parents[4] / "examples" / "elastic-biglide" / "robot.toml"
    closed_form = load_robot(str(file)).mechanism
    iterated = replace(closed_form, inverse_kinematics=None)
    for pose in closed_form.poses[2:-2:3]:
        expected, found = (posture(of, pose).frames for of in (closed_form, iterated))
        for name, frame in expected.items():
            assert found[name].position == pytest.approx(frame.position, abs=1e-9)
            assert found[name].rotation == pytest.approx(frame.rotation, abs=1e-9)
