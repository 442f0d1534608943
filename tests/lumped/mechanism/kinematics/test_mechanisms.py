"""The shipped mechanisms: closed-form inverse kinematics, derivatives, mobility, random poses."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lumped.errors import InputError
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import FREEDOMS, Joint, Side
from lumped.mechanism.kinematics.closure import Closure, Placement
from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.kinematics.postures import CLOSED, posture, reference_posture
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool
from lumped.mechanism.placing import rigid_on
from lumped.robot_file import load_robot

ROBOTS = ("five-bar", "3-rrr", "delta", "orthoglide", "hexapod", "biglide")


@pytest.fixture(scope="module", params=ROBOTS)
def mechanism(request):
    return load_robot(request.param).mechanism


def random_poses(mechanism, count, seed=0):
    """Poses between the least and the largest of each move on the path (biglide: its stroke)."""
    rng = np.random.default_rng(seed)
    low, high = mechanism.poses.min(axis=0), mechanism.poses.max(axis=0)
    margin = 0.02 * (high - low)
    return rng.uniform(low + margin, high - margin, (count, len(low)))


def residual(found) -> float:
    closure = Closure(found.mechanism)
    return float(np.abs(closure.residual(closure.placement(found))).max()) / closure.size


def test_random_poses_close_and_have_the_tool_where_it_is_asked_to_be(mechanism):
    tool = Side(mechanism.tool.body, mechanism.tool.point)
    along = [i for i, move in enumerate(mechanism.tool.moves) if move in "xyz"]
    for pose in random_poses(mechanism, 4):
        found = posture(mechanism, pose)
        assert residual(found) <= CLOSED
        place = interface_position(found, tool)
        assert place[along] == pytest.approx(pose[along], abs=1e-12 * mechanism.size)


def test_the_jacobian_is_the_derivative_of_the_residual(mechanism):
    closure = Closure(mechanism)
    rng = np.random.default_rng(1)
    placement = closure.reference
    size = closure.jacobian(placement).shape[1]
    # Off the closed posture too, where no term may hide behind a vanishing residual.
    placement = closure.moved(placement, 0.2 * closure.size * rng.standard_normal(size))
    step = 1e-6 * closure.size
    pose = mechanism.reference_pose
    differences = [
        closure.residual_at(closure.moved(placement, side * step * unit), pose)
        for unit in np.eye(size)
        for side in (1.0, -1.0)
    ]
    derivative = (np.array(differences[::2]) - np.array(differences[1::2])).T / (2.0 * step)
    # Central differences: truncation 1e-12, rounding 1e-16/1e-6, times lengths about the size.
    assert closure.jacobian_at(placement) == pytest.approx(derivative, abs=1e-8)


def test_coordinates_are_zero_in_the_reference_posture(mechanism):
    """Also of a slide whose two points are apart there."""
    closure = Closure(mechanism)
    for values in closure.coordinates(closure.reference):
        assert values == pytest.approx(0.0, abs=1e-14)


def test_kutzbach_counts_what_is_not_overconstrained(mechanism):
    found = mobility(reference_posture(mechanism))
    bodies = len(mechanism.bodies) - 1
    freedoms = sum(FREEDOMS[joint.kind] for joint in mechanism.joints)
    kutzbach = 6 * (bodies - len(mechanism.joints)) + freedoms
    assert found.mobility - found.redundant == kutzbach
    if mechanism.name in {"Delta", "hexapod"}:
        assert found.redundant == 0
    prescribed = len(mechanism.tool.moves) + len(mechanism.tool.keeps)
    assert found.mobility == prescribed + found.idle


def test_delta_against_its_closed_form():
    mechanism = load_robot("delta").mechanism
    arm, rod, offset, droop = 0.24, 0.56, 0.18 - 0.06, np.radians(20.0)
    for pose in random_poses(mechanism, 3):
        found = posture(mechanism, pose)
        assert mobility(found).idle == 6
        for leg in range(3):
            turn = np.radians(120.0 * leg)
            outwards = np.array([np.cos(turn), np.sin(turn), 0.0])
            aside = np.array([-np.sin(turn), np.cos(turn), 0.0])
            # From the motor to the platform's joint, both moved inwards by the platform's radius.
            radial, lateral = pose @ outwards - offset, pose @ aside
            # |arm (cos θ, −sin θ) − (radial, z)|² + lateral² = rod²
            level = (radial**2 + pose[2] ** 2 + lateral**2 + arm**2 - rod**2) / (2.0 * arm)
            reach = np.hypot(radial, pose[2])
            droops = np.arctan2(-pose[2], radial) - np.arccos(level / reach)
            turned = found.coordinates[f"motor{leg + 1}"][0]
            assert turned == pytest.approx(droops - droop, abs=1e-11)


def test_a_joint_is_followed_past_half_a_turn():
    """Crank and rod alone, both driven: the elbow turns by 230° while the rod does by 150°."""
    mechanism = load_robot("five-bar").mechanism
    joints = {joint.name: joint for joint in mechanism.joints}
    motor, elbow = joints["motor1"], replace(joints["elbow1"], drive=joints["motor1"].drive)
    arm = replace(
        mechanism,
        joints=(motor, elbow),
        bodies={name: mechanism.bodies[name] for name in ("ground", "crank1", "rod1")},
        tool=replace(mechanism.tool, moves=("x", "phi_z")),
    )
    back, turned = np.radians([-80.0, 150.0])
    # Where crank and rod, (-0.2, 0.25) and (0.35, 0.3) in the reference posture, then end.
    x = -0.15 - 0.2 * np.cos(back) - 0.25 * np.sin(back)
    x += 0.35 * np.cos(turned) - 0.3 * np.sin(turned)
    found = posture(arm, np.array([x, turned])).coordinates
    assert [found["motor1"][0], found["elbow1"][0]] == pytest.approx([back, turned - back])


def test_an_open_reference_names_the_joint():
    mechanism = load_robot("five-bar").mechanism
    moved = {**mechanism.reference}
    frame = moved["rod2"]
    moved["rod2"] = replace(frame, position=frame.position + np.array([0.0, 1e-6, 0.0]))
    with pytest.raises(InputError, match="joint elbow2 is open by 1e-06 m in the reference"):
        posture(replace(mechanism, reference=moved), np.array([0.0, 0.5]))


def tilted(mechanism, angle):
    """The mechanism with the axis of one passive joint out of parallel."""
    joints = list(mechanism.joints)
    place = next(i for i, j in enumerate(joints) if j.kind == "revolute" and j.drive is None)
    axis = joints[place].axes + angle * np.array([[1.0, 0.3, 0.7]])
    joints[place] = replace(joints[place], axes=axis / np.linalg.norm(axis))
    return replace(mechanism, joints=tuple(joints))


def test_loops_that_only_almost_close_say_that_digits_are_missing():
    mechanism = tilted(load_robot("3-rrr").mechanism, 1e-7)
    with pytest.raises(InputError, match=r"\d+ of its constraints repeat others and contradict"):
        posture(mechanism, mechanism.poses[0])
    found = mobility(reference_posture(tilted(load_robot("3-rrr").mechanism, 1e-4)))
    assert found.almost_redundant == 1


TURN = Rotation.from_euler("z", 0.7).as_matrix()
TILT = Rotation.from_euler("XY", [0.4, -0.8]).as_matrix()


@pytest.mark.parametrize(
    ("kind", "place", "turn", "values"),
    [
        ("cylindrical", [0.0, 0.0, 0.3], TURN, [0.3, 0.7]),
        ("planar", [0.0, 0.2, 0.0], TURN, [0.2, 0.7]),
        ("universal", [0.0, 0.0, 0.0], TILT, [0.4, -0.8]),
        ("spherical", [0.0, 0.0, 0.0], TURN, [0.0, 0.0, 0.7]),
        ("revolute", [0.0, 0.0, 0.0], TURN, [0.7]),
        ("prismatic", [0.0, 0.0, 0.3], np.eye(3), [0.3]),
    ],
)
def test_each_kind_allows_its_motion_gives_its_coordinates_and_forbids_others(
    kind, place, turn, values
):
    closure = Closure(single_joint(kind))
    base = Rotation.from_euler("xyz", [0.3, -0.2, 0.5]).as_matrix()
    # Both bodies carried along: what counts is how they lie to each other.
    placement = Placement(
        np.array([[0.0, 0.0, 0.0], [1.0, 2.0, 3.0], [1.0, 2.0, 3.0] + base @ np.array(place)]),
        np.array([np.eye(3), base, base @ turn]),
    )
    assert np.abs(closure.residual(placement)).max() < 1e-15
    (found,) = closure.coordinates(placement)
    if kind == "planar":
        assert [np.linalg.norm(found[:2]), found[2]] == pytest.approx(values, abs=1e-15)
    else:
        assert found == pytest.approx(values, abs=1e-15)
    # Each of the six relative motions is either free or opens the joint to first order.
    opened = np.linalg.matrix_rank(closure.jacobian(placement), tol=1e-9)
    assert opened == len(closure.joint_of) == 6 - FREEDOMS[kind]


def single_joint(kind):
    """Two bodies on one joint at the origin, its axis z; a universal joint's axes x and y."""
    axes = {"universal": np.eye(3)[:2], "spherical": np.zeros((0, 3))}.get(kind, np.eye(3)[2:])
    points = {"O": np.zeros(3)}
    placed = [rigid_on(name, ("O",), points) for name in (GROUND, "first", "second")]
    return Mechanism(
        "joint",
        {body.name: body for body, _ in placed},
        (Joint("j", kind, Side("first", "O"), Side("second", "O"), axes),),
        Tool("second", "O"),
        {body.name: frame for body, frame in placed},
        np.zeros((0, 0)),
    )
