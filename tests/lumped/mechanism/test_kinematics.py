"""Joints, legs on points, the biglide and the shipped mechanisms: closed forms, derivatives."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from like_ifw import LEG1, LEG2, like_ifw
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.mechanism.biglide import Stroke, family_member
from lumped.mechanism.free_twists import interface_position, joint_twists
from lumped.mechanism.joint import FREEDOMS, Joint, Side
from lumped.mechanism.kinematics.closure import Closure, Placement
from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.kinematics.postures import CLOSED, posture, reference_posture
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool
from lumped.mechanism.placing import leg_frame, place_rigid_body
from lumped.memo import forget
from lumped.robot_file import load_robot

TURN = Rotation.from_euler("z", 0.7).as_matrix()
TILT = Rotation.from_euler("XY", [0.4, -0.8]).as_matrix()


def single_joint(kind):
    """Two bodies on one joint at the origin, its axis z; a universal joint's axes x and y."""
    none = np.zeros((0, 3))
    axes = {"universal": np.eye(3)[:2], "spherical": none, "fixed": none}.get(kind, np.eye(3)[2:])
    points = {"O": np.zeros(3)}
    placed = [place_rigid_body(name, ("O",), points) for name in (GROUND, "first", "second")]
    return Mechanism(
        "joint",
        {body.name: body for body, _ in placed},
        (Joint("j", kind, Side("first", "O"), Side("second", "O"), axes),),
        Tool("second", "O"),
        {body.name: frame for body, frame in placed},
        np.zeros((0, 0)),
    )


@pytest.mark.parametrize(
    ("kind", "place", "turn", "values"),
    [
        ("fixed", [0.0, 0.0, 0.0], np.eye(3), []),
        ("cylindrical", [0.0, 0.0, 0.3], TURN, [0.3, 0.7]),
        ("planar", [0.0, 0.2, 0.0], TURN, [0.2, 0.7]),
        ("universal", [0.0, 0.0, 0.0], TILT, [0.4, -0.8]),
        ("spherical", [0.0, 0.0, 0.0], TURN, [0.0, 0.0, 0.7]),
        ("revolute", [0.0, 0.0, 0.0], TURN, [0.7]),
        ("prismatic", [0.0, 0.0, 0.3], np.eye(3), [0.3]),
    ],
)
def test_joint_kinds_allow_their_motions_only(kind, place, turn, values):
    mechanism = single_joint(kind)
    closure = Closure(mechanism)
    # Both bodies carried along: what counts is how they lie to each other.
    base = Rotation.from_euler("xyz", [0.3, -0.2, 0.5]).as_matrix()
    at = np.array([1.0, 2.0, 3.0])

    def placement(twist):
        end = at + base @ np.array(place) + twist[:3]
        turned = Rotation.from_rotvec(twist[3:]).as_matrix() @ base @ turn
        return Placement(np.array([0.0 * at, at, end]), np.array([np.eye(3), base, turned]))

    closed = placement(np.zeros(6))
    # A few units in the last place of numbers of about 1, ten times over.
    assert np.abs(closure.residual(closed)).max() < 1e-14
    (found,) = closure.coordinates(closed)
    shown = [np.linalg.norm(found[:2]), found[2]] if kind == "planar" else found
    assert shown == pytest.approx(values, abs=1e-14)
    twists = joint_twists(mechanism.joints[0], base, base @ turn).T
    assert twists.shape == (FREEDOMS[kind], 6)
    for twist, own in zip(twists, np.eye(len(twists)), strict=True):
        moved = placement(1e-6 * twist)
        assert np.abs(closure.residual(moved)).max() < 1e-11
        (after,) = closure.coordinates(moved)
        # A rotation vector has rates of its own.
        if kind != "spherical":
            assert (after - found) / 1e-6 == pytest.approx(own, abs=1e-5)
    if kind == "spherical":
        assert np.array_equal(twists, np.eye(6)[3:])
    # Each of the six relative motions is either free or opens the joint to first order.
    opened = np.linalg.matrix_rank(closure.jacobian(closed), tol=1e-9)
    assert opened == len(closure.joint_of) == 6 - FREEDOMS[kind]


@pytest.mark.parametrize(
    ("axes", "said"),
    [
        ([[1.0, 0.0, 0.0]], r"axes 1×3: a universal joint has 2×3"),
        ([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], "axes are parallel"),
        ([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]], "axis 2 has length 2: must be a unit vector"),
    ],
)
def test_axes_that_are_another_joint(axes, said):
    with pytest.raises(InputError, match=said):
        Joint("j", "universal", Side("a", "P"), Side("b", "P"), np.array(axes))


@pytest.mark.parametrize(
    ("end", "up", "z"),
    [
        ([2.0, 0.0, 0.0], None, [0.0, 0.0, 1.0]),
        ([0.0, 0.0, 3.0], None, [1.0, 0.0, 0.0]),
        ([0.0, 0.0, -3.0], None, [1.0, 0.0, 0.0]),
        ([1.0, 0.0, 1.0], None, [-np.sqrt(0.5), 0.0, np.sqrt(0.5)]),
        ([1.0, 0.0, 0.0], np.array([5.0, 1.0, 0.0]), [0.0, 1.0, 0.0]),
    ],
)
def test_leg_z_axis_is_closest_to_up(end, up, z):
    x, y, found = leg_frame(np.zeros(3), np.array(end), up).rotation.T
    assert x == pytest.approx(np.array(end) / np.linalg.norm(end), abs=1e-14)
    assert found == pytest.approx(z, abs=1e-14)
    assert y == pytest.approx(np.cross(z, x), abs=1e-14)


ELASTIC = Path(__file__).parents[3] / "examples" / "elastic-biglide" / "robot.toml"
ROBOTS = ("five-bar", "3-rrr", "delta", "orthoglide", "hexapod", "biglide", str(ELASTIC))


@pytest.fixture(scope="module", params=ROBOTS)
def mechanism(request):
    return load_robot(request.param).mechanism


@pytest.fixture(scope="module")
def five_bar():
    return load_robot("five-bar").mechanism


def random_poses(mechanism, count):
    """Poses between the least and the largest of each move on the path (biglide: its stroke)."""
    low, high = mechanism.poses.min(axis=0), mechanism.poses.max(axis=0)
    shares = np.random.default_rng(0).uniform(0.02, 0.98, (count, len(low)))
    return low + shares * (high - low)


def test_random_poses_close_at_prescribed_tool_pose(mechanism):
    closure = Closure(mechanism)
    along = [i for i, move in enumerate(mechanism.tool.moves) if move in "xyz"]
    datum = np.array(mechanism.tool.datum)
    for pose in random_poses(mechanism, 3):
        found = posture(replace(mechanism, inverse_kinematics=None), pose)
        residual = closure.residual(closure.placement(found))
        assert np.abs(residual).max() <= CLOSED * closure.size
        # Poses of a biglide are of B, from which its loaded point stands off.
        place = interface_position(found, Side(mechanism.tool.body, mechanism.tool.point)) - datum
        assert place[along] == pytest.approx(pose[along], abs=1e-12 * mechanism.size)
        for name, frame in posture(mechanism, pose).frames.items():
            assert found.frames[name].position == pytest.approx(frame.position, abs=1e-9)
            assert found.frames[name].rotation == pytest.approx(frame.rotation, abs=1e-9)
    # Also of a slide whose two points are apart in the reference posture.
    for values in closure.coordinates(closure.reference):
        assert values == pytest.approx(0.0, abs=1e-14)


def test_jacobian_is_derivative_of_residual(mechanism):
    closure, rng = Closure(mechanism), np.random.default_rng(1)
    placement = closure.reference
    size = closure.jacobian(placement).shape[1]
    # Off the closed posture too, where no term may hide behind a vanishing residual.
    placement = closure.displaced(placement, 0.2 * closure.size * rng.standard_normal(size))
    steps = 1e-6 * closure.size * np.eye(size)
    ahead, behind = (
        [
            closure.residual_at(closure.displaced(placement, s), mechanism.reference_pose)
            for s in way
        ]
        for way in (steps, -steps)
    )
    derivative = np.subtract(ahead, behind).T / (2e-6 * closure.size)
    # Central differences: truncation 1e-12, rounding 1e-16/1e-6, times lengths about the size.
    assert closure.jacobian_at(placement) == pytest.approx(derivative, abs=1e-8)


def test_mobility_equals_kutzbach_formula(mechanism):
    found = mobility(reference_posture(mechanism))
    freedoms = sum(FREEDOMS[joint.kind] for joint in mechanism.joints)
    kutzbach = 6 * (len(mechanism.bodies) - 1 - len(mechanism.joints)) + freedoms
    assert found.mobility - found.redundant == kutzbach
    if mechanism.name in {"Delta", "hexapod"}:
        assert found.redundant == 0
    prescribed = len(mechanism.tool.moves) + len(mechanism.tool.constant_moves)
    assert found.mobility == prescribed + found.idle


def test_delta_kinematics_equal_closed_form():
    mechanism = load_robot("delta").mechanism
    arm, rod, offset, droop = 0.24, 0.56, 0.18 - 0.06, np.radians(20.0)
    for pose in random_poses(mechanism, 2):
        found = posture(mechanism, pose)
        assert mobility(found).idle == 6
        for leg, turn in enumerate(np.radians([0.0, 120.0, 240.0]), start=1):
            # From the motor to the platform's joint, both moved inwards by the platform's radius.
            radial = pose[:2] @ [np.cos(turn), np.sin(turn)] - offset
            lateral = pose[:2] @ [-np.sin(turn), np.cos(turn)]
            # |arm (cos θ, −sin θ) − (radial, z)|² + lateral² = rod²
            level = (radial**2 + pose[2] ** 2 + lateral**2 + arm**2 - rod**2) / (2.0 * arm)
            reach = np.hypot(radial, pose[2])
            droops = np.arctan2(-pose[2], radial) - np.arccos(level / reach)
            # Loops closed by iteration, which ends at 2e-12.
            assert found.coordinates[f"motor{leg}"][0] == pytest.approx(droops - droop, abs=1e-10)


def test_joint_angle_continues_past_half_a_turn(five_bar):
    """Crank and rod alone, both driven: the elbow turns by 230° while the rod does by 150°."""
    joints = {joint.name: joint for joint in five_bar.joints}
    motor, elbow = joints["motor1"], replace(joints["elbow1"], drive=joints["motor1"].drive)
    arm = replace(
        five_bar,
        joints=(motor, elbow),
        bodies={name: five_bar.bodies[name] for name in ("ground", "crank1", "rod1")},
        tool=replace(five_bar.tool, moves=("x", "phi_z")),
    )
    back, turned = np.radians([-80.0, 150.0])
    # Where crank and rod, (-0.2, 0.25) and (0.35, 0.3) in the reference posture, then end.
    x = -0.15 - 0.2 * np.cos(back) - 0.25 * np.sin(back)
    x += 0.35 * np.cos(turned) - 0.3 * np.sin(turned)
    found = posture(arm, np.array([x, turned])).coordinates
    assert [found["motor1"][0], found["elbow1"][0]] == pytest.approx([back, turned - back])


def test_open_reference_posture_names_joint(five_bar):
    frame = five_bar.reference["rod2"]
    off = replace(frame, position=frame.position + 1e-6 * np.eye(3)[1])
    moved = replace(five_bar, reference={**five_bar.reference, "rod2": off})
    with pytest.raises(InputError, match="joint elbow2 is open by 1e-06 m in the reference"):
        posture(moved, np.array([0.0, 0.5]))


def test_almost_closed_loops_report_missing_digits():
    mechanism = load_robot("3-rrr").mechanism

    def tilted(angle):
        """With the axis of one passive joint out of parallel."""
        joints = list(mechanism.joints)
        place = next(i for i, j in enumerate(joints) if j.kind == "revolute" and j.drive is None)
        axis = joints[place].axes + angle * np.array([[1.0, 0.3, 0.7]])
        joints[place] = replace(joints[place], axes=axis / np.linalg.norm(axis))
        return replace(mechanism, joints=tuple(joints))

    with pytest.raises(InputError, match=r"\d+ of its constraints repeat others and contradict"):
        posture(tilted(1e-7), mechanism.poses[0])
    assert mobility(reference_posture(tilted(1e-4))).almost_redundant == 1


def test_unreachable_pose_names_joint_and_progress():
    iterated = replace(load_robot("ifw").mechanism, inverse_kinematics=None)
    # 0.3525 m of 0.4025 m lie within the stroke: 88 %.
    said = r"cannot be reached: joint [\s\S]*ends after 88 %, at x = 0\.84"
    with pytest.raises(InputError, match=said):
        posture(iterated, np.array([0.9]))


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
        assert_allclose(leg.position + length * along, [x, 0.0, 0.0], atol=1e-14)
        assert_allclose(across, np.cross(up, along), atol=1e-14)
        assert_allclose(up, [0.0, 0.0, 1.0])


@pytest.mark.parametrize("short", [1e-3, 1e-6, 1e-9, 1e-12])
def test_heights_are_accurate_at_ends_of_stroke(short):
    """Against rational arithmetic: L² − x² alone would have 1e-16 L² of rounding."""
    stroke = Stroke(0.75, 0.85, 0.775)
    for x in (stroke.ends[0] + short, stroke.ends[1] - short):
        bases = Fraction(x), Fraction(stroke.a) - Fraction(x)
        for leg, length, base in zip(stroke.legs_at(x), (0.85, 0.775), bases, strict=True):
            height = float(Fraction(length) ** 2 - base**2) ** 0.5
            assert -leg.position[1] == pytest.approx(height, rel=1e-15)


@pytest.mark.parametrize("x", [0.1449, 0.8501, -1.0, np.nan, np.inf])
def test_postures_outside_stroke_are_refused(x):
    with pytest.raises(InputError, match=r"outside the stroke 0.145 m to 0.85 m"):
        STROKE.legs_at(x)


@pytest.mark.parametrize("alpha", [0.7, 1.0, 2.0])
def test_family_keeps_stroke_and_section(alpha):
    """Eqs (10), (11): L = α L0, d the same, a = α (L10 + L20) − d; EA, EI, GJ, μ the same."""
    a, *legs = family_member(0.92, LEG1, LEG2, alpha)
    assert a == pytest.approx(alpha * 1.625 - 0.705, rel=1e-14)
    for leg, original in zip(legs, (LEG1, LEG2), strict=True):
        assert leg.timoshenko == equivalent_leg(original).timoshenko
        found, expected = (leg.length, leg.mass), (original.length, original.mass)
        assert found == pytest.approx(alpha * np.array(expected), rel=1e-14)


def test_family_begins_where_the_legs_can_meet():
    """a > α |L10 − L20| gives α > d / (2 L20) = 0.705/1.55 = 0.4548; a > 0 gives 0.4338."""
    for alpha, said in ((0.4549, ""), (0.4548, "never becomes horizontal"), (0.43, "a > 0")):
        a, leg1, leg2 = family_member(0.92, LEG1, LEG2, alpha)
        faults = "".join(Stroke(a, leg1.length, leg2.length).faults())
        assert bool(faults) == bool(said)
        assert said in faults


def test_postures_of_file_reading_are_memoised(monkeypatch):
    forget()
    mechanism = load_robot("five-bar").mechanism
    monkeypatch.setattr("lumped.mechanism.kinematics.postures._continued", pytest.fail)
    assert "motor1" in posture(mechanism, mechanism.poses[0]).coordinates
