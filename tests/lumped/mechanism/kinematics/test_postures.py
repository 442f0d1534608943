"""Postures against closed forms, and poses that have none."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from like_ifw import IFW

from lumped.errors import InputError
from lumped.mechanism.biglide import Stroke
from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot

# Without the closed form: loops are closed by iteration.
ITERATED = replace(IFW.mechanism, inverse_kinematics=None)
STROKE = Stroke(0.92, 0.85, 0.775)


@pytest.mark.parametrize("mechanism", [IFW.mechanism, ITERATED], ids=["closed form", "iterated"])
def test_coordinates_are_counted_from_the_reference_posture(mechanism):
    found = posture(mechanism, np.array([0.7]))
    (before, _), (after, _) = STROKE.legs_at(0.4975), STROKE.legs_at(0.7)
    turn = before.rotation.T @ after.rotation
    slid = after.position[1] - before.position[1]
    assert found.coordinates["drive1"] == pytest.approx([slid], abs=1e-13)
    turned = np.arctan2(turn[1, 0], turn[0, 0])
    assert found.coordinates["foot1"] == pytest.approx([turned], abs=1e-13)
    assert found.coordinates["seat"].shape == (0,)


def test_a_pose_out_of_reach_names_the_joint_that_opens_and_how_far_the_way_went():
    with pytest.raises(InputError) as caught:
        posture(ITERATED, np.array([0.9]))
    # 0.3525 m of 0.4025 m lie within the stroke: 88 %.
    assert "cannot be reached: joint" in str(caught.value)
    assert "ends after 88 %, at x = 0.84" in str(caught.value)


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
