"""Kinematics of joints, of the biglide and of the shipped robots against closed forms."""

from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation
from support.robots.paper_robot_variants import LEG1, LEG2, variant_of_ifw

from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError
from lumped.mechanism.biglide import Stroke, family_member
from lumped.mechanism.free_twists import interface_position, joint_twists
from lumped.mechanism.joint import FREEDOMS, Joint, Side
from lumped.mechanism.kinematics.closure import CLOSED, Closure, Placement
from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool
from lumped.mechanism.placing import leg_frame, place_rigid_body
from lumped.memo import forget
from lumped.robot_file import load_robot

TURN = Rotation.from_euler("z", 0.7).as_matrix()
TILT = Rotation.from_euler("XY", [0.4, -0.8]).as_matrix()


def single_joint(kind):
    """Return two bodies on one joint at the origin with axis z (a universal joint: x and y)."""
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
    ("kind", "position", "turn", "values"),
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
def test_joint_allows_its_free_twists(kind, position, turn, values):
    """Known relative positions of each joint: closed, with its coordinates and free twists."""
    mechanism = single_joint(kind)
    closure = Closure(mechanism)
    # Both bodies are moved together first: only their relative placement matters.
    base = Rotation.from_euler("xyz", [0.3, -0.2, 0.5]).as_matrix()
    origin = np.array([1.0, 2.0, 3.0])

    def placement(twist):
        end = origin + base @ np.array(position) + twist[:3]
        turned = Rotation.from_rotvec(twist[3:]).as_matrix() @ base @ turn
        positions = np.array([0.0 * origin, origin, end])
        return Placement(positions, np.array([np.eye(3), base, turned]))

    closed = placement(np.zeros(6))
    # Rounding of numbers of about 1: a few units in the last place, with a margin of ten.
    assert np.abs(closure.residual(closed)).max() < 1e-14
    (coordinates,) = closure.coordinates(closed)
    if kind == "planar":
        assert np.linalg.norm(coordinates[:2]) == pytest.approx(values[0], abs=1e-14)
        assert coordinates[2] == pytest.approx(values[1], abs=1e-14)
    else:
        assert coordinates == pytest.approx(values, abs=1e-14)
    twists = joint_twists(mechanism.joints[0], base, base @ turn).T
    assert twists.shape == (FREEDOMS[kind], 6)
    for twist, unit in zip(twists, np.eye(len(twists)), strict=True):
        moved_placement = placement(1e-6 * twist)
        assert np.abs(closure.residual(moved_placement)).max() < 1e-11
        (after,) = closure.coordinates(moved_placement)
        # The rates of a rotation vector are not the angular velocity.
        if kind != "spherical":
            assert (after - coordinates) / 1e-6 == pytest.approx(unit, abs=1e-5)
    if kind == "spherical":
        assert np.array_equal(twists, np.eye(6)[3:])
    # Each of the six relative motions is either free or changes the residual to first order.
    opened = np.linalg.matrix_rank(closure.jacobian(closed), tol=1e-9)
    assert opened == len(closure.joint_of) == 6 - FREEDOMS[kind]


@pytest.mark.parametrize(
    ("axes", "message"),
    [
        ([[1.0, 0.0, 0.0]], r"axes 1×3: a universal joint has 2×3"),
        ([[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0]], "axes are parallel"),
        ([[1.0, 0.0, 0.0], [0.0, 2.0, 0.0]], "axis 2 has length 2: must be a unit vector"),
    ],
)
def test_invalid_cardan_axes_are_refused(axes, message):
    """Axes of a universal joint are two directions that are not parallel."""
    with pytest.raises(InputError, match=message):
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
    """Legs along, across and opposite to base z, with and without `up`."""
    x, y, z_axis = leg_frame(np.zeros(3), np.array(end), up).rotation.T
    assert x == pytest.approx(np.array(end) / np.linalg.norm(end), abs=1e-14)
    assert z_axis == pytest.approx(z, abs=1e-14)
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
    """Return random poses within the range of the path in each move (of a biglide: its stroke)."""
    low, high = mechanism.poses.min(axis=0), mechanism.poses.max(axis=0)
    shares = np.random.default_rng(0).uniform(0.02, 0.98, (count, len(low)))
    return low + shares * (high - low)


def test_loops_close_at_random_poses(mechanism):
    """All built-in robots; the numerical solution equals the closed inverse kinematics."""
    closure = Closure(mechanism)
    along = [i for i, move in enumerate(mechanism.tool.moves) if move in "xyz"]
    datum = np.array(mechanism.tool.datum)
    for pose in random_poses(mechanism, 3):
        solved = posture(replace(mechanism, inverse_kinematics=None), pose)
        residual = closure.residual(closure.placement(solved))
        assert np.abs(residual).max() <= CLOSED * closure.size
        # The pose of a biglide is the position of B; the loaded point has an offset from B.
        tool_point = Side(mechanism.tool.body, mechanism.tool.point)
        position = interface_position(solved, tool_point) - datum
        assert position[along] == pytest.approx(pose[along], abs=1e-12 * mechanism.size)
        for name, frame in posture(mechanism, pose).frames.items():
            assert solved.frames[name].position == pytest.approx(frame.position, abs=1e-9)
            assert solved.frames[name].rotation == pytest.approx(frame.rotation, abs=1e-9)
    # Joint coordinates are zero in the reference posture, also for a slide given by two points.
    for values in closure.coordinates(closure.reference):
        assert values == pytest.approx(0.0, abs=1e-14)


def test_jacobian_is_derivative_of_residual(mechanism):
    """Central differences in a displaced posture, for all built-in robots."""
    closure, rng = Closure(mechanism), np.random.default_rng(1)
    placement = closure.reference
    size = closure.jacobian(placement).shape[1]
    # In an open posture, where the derivative of every term of the residual counts.
    placement = closure.displaced(placement, 0.2 * closure.size * rng.standard_normal(size))
    steps = 1e-6 * closure.size * np.eye(size)
    forward, behind = (
        [
            closure.residual_at(closure.displaced(placement, s), mechanism.reference_pose)
            for s in signed
        ]
        for signed in (steps, -steps)
    )
    derivative = np.subtract(forward, behind).T / (2e-6 * closure.size)
    # Central differences: truncation error 1e-12 and rounding error 1e-16/1e-6, times lengths of
    # about the mechanism's size.
    assert closure.jacobian_at(placement) == pytest.approx(derivative, abs=1e-8)


def test_mobility_equals_kutzbach(mechanism):
    """6 (bodies − 1 − joints) + Σ freedoms, plus redundant constraints."""
    computed = mobility(reference_posture(mechanism))
    freedoms = sum(FREEDOMS[joint.kind] for joint in mechanism.joints)
    kutzbach = 6 * (len(mechanism.bodies) - 1 - len(mechanism.joints)) + freedoms
    assert computed.mobility - computed.redundant == kutzbach
    if mechanism.name in {"Delta", "hexapod"}:
        assert computed.redundant == 0
    prescribed = len(mechanism.tool.moves) + len(mechanism.tool.constant_moves)
    assert computed.mobility == prescribed + computed.idle


def test_delta_kinematics_equal_closed_form():
    """Angles of the three arms by hand, from arm and rod length and the platform's offset."""
    mechanism = load_robot("delta").mechanism
    arm, rod, offset, droop = 0.24, 0.56, 0.18 - 0.06, np.radians(20.0)
    for pose in random_poses(mechanism, 2):
        solved = posture(mechanism, pose)
        assert mobility(solved).idle == 6
        for leg, turn in enumerate(np.radians([0.0, 120.0, 240.0]), start=1):
            # Motor and platform joint are both moved inwards by the platform's radius.
            radial = pose[:2] @ [np.cos(turn), np.sin(turn)] - offset
            lateral = pose[:2] @ [-np.sin(turn), np.cos(turn)]
            # |arm (cos θ, −sin θ) − (radial, z)|² + lateral² = rod²
            level = (radial**2 + pose[2] ** 2 + lateral**2 + arm**2 - rod**2) / (2.0 * arm)
            reach = np.hypot(radial, pose[2])
            droops = np.arctan2(-pose[2], radial) - np.arccos(level / reach)
            # The iteration that closes the loops ends at 2e-12.
            angle = solved.coordinates[f"motor{leg}"][0]
            assert angle == pytest.approx(droops - droop, abs=1e-10)


def test_joint_angle_exceeds_half_turn(five_bar):
    """Crank and rod alone, both driven: the elbow rotates by 230°, the rod by 150°."""
    joints = {joint.name: joint for joint in five_bar.joints}
    motor, elbow = joints["motor1"], replace(joints["elbow1"], drive=joints["motor1"].drive)
    arm = replace(
        five_bar,
        joints=(motor, elbow),
        bodies={name: five_bar.bodies[name] for name in ("ground", "crank1", "rod1")},
        tool=replace(five_bar.tool, moves=("x", "phi_z")),
    )
    crank_angle, rod_angle = np.radians([-80.0, 150.0])
    # x of the tool after crank (-0.2, 0.25) and rod (0.35, 0.3), as vectors in the reference
    # posture, have rotated by `crank_angle` and `rod_angle`.
    x = -0.15 - 0.2 * np.cos(crank_angle) - 0.25 * np.sin(crank_angle)
    x += 0.35 * np.cos(rod_angle) - 0.3 * np.sin(rod_angle)
    angles = posture(arm, np.array([x, rod_angle])).coordinates
    assert [angles["motor1"][0], angles["elbow1"][0]] == pytest.approx(
        [crank_angle, rod_angle - crank_angle]
    )


def test_open_joint_is_reported(five_bar):
    """A rod displaced by 1 µm: joint and gap are named."""
    frame = five_bar.reference["rod2"]
    shifted = replace(frame, position=frame.position + 1e-6 * np.eye(3)[1])
    open_five_bar = replace(five_bar, reference={**five_bar.reference, "rod2": shifted})
    with pytest.raises(InputError, match="joint elbow2 is open by 1e-06 m in the reference"):
        posture(open_five_bar, np.array([0.0, 0.5]))


def test_imprecise_axis_is_reported():
    """Tilted by 1e-7 rad, redundant constraints contradict.

    By 1e-4 rad, one is no longer redundant.
    """
    mechanism = load_robot("3-rrr").mechanism

    def tilted(angle):
        """Return the robot with the axis of one passive joint tilted by about `angle` (rad)."""
        joints = list(mechanism.joints)
        passive = [joint.kind == "revolute" and joint.drive is None for joint in joints]
        index = passive.index(True)
        axis = joints[index].axes + angle * np.array([[1.0, 0.3, 0.7]])
        joints[index] = replace(joints[index], axes=axis / np.linalg.norm(axis))
        return replace(mechanism, joints=tuple(joints))

    with pytest.raises(InputError, match=r"\d+ redundant constraints contradict the others"):
        posture(tilted(1e-7), mechanism.poses[0])
    assert mobility(reference_posture(tilted(1e-4))).almost_redundant == 1


def test_unreachable_pose_names_joint():
    """x = 0.9 m is beyond the stroke: open joint, and the last pose that is reachable."""
    iterated = replace(load_robot("ifw").mechanism, inverse_kinematics=None)
    # Of the way of 0.4025 m from the reference pose to x = 0.9 m, 0.3525 m lie within the stroke:
    # 88 %.
    message = r"cannot be reached: joint [\s\S]*reachable pose, after 88 %, is x = 0\.84"
    with pytest.raises(InputError, match=message):
        posture(iterated, np.array([0.9]))


STROKE = Stroke(0.92, 0.85, 0.775)


def test_demonstrator_stroke_equals_paper():
    """Paper: the stroke is x from a − L2 = 0.145 m to L1 = 0.85 m, d = L1 + L2 − a = 0.705 m."""
    assert STROKE.ends == pytest.approx((0.145, 0.85), rel=1e-14)
    assert STROKE.length == pytest.approx(0.705, rel=1e-14)
    assert STROKE.centre == pytest.approx(0.4975, rel=1e-14)
    # A pose is the position of B for any offset of the loaded point.
    robot = variant_of_ifw(tool_offset=np.array([0.03, -0.02, 0.155]))
    assert_allclose(robot.poses[[0, 4, 8], 0], [0.145, 0.4975, 0.85], rtol=1e-14)
    assert robot.reference_pose == pytest.approx([0.4975], rel=1e-14)


@pytest.mark.parametrize("x", [0.145, 0.3, 0.4975, 0.85])
def test_biglide_leg_x_axis_points_from_slide_to_b(x):
    """In the biglide each leg's x axis points from its slide to the common point B."""
    for leg, slide, length in zip(STROKE.legs_at(x), (0.0, 0.92), (0.85, 0.775), strict=True):
        assert leg.position[0] == slide
        assert leg.position[1] <= 0.0  # both legs on the same side
        along, across, up = leg.rotation.T
        assert_allclose(leg.position + length * along, [x, 0.0, 0.0], atol=1e-14)
        assert_allclose(across, np.cross(up, along), atol=1e-14)
        assert_allclose(up, [0.0, 0.0, 1.0])


@pytest.mark.parametrize("short", [1e-3, 1e-6, 1e-9, 1e-12])
def test_leg_height_is_exact_at_stroke_ends(short):
    """Against rational arithmetic; L² − x² in floating point would have an error of 1e-16 L²."""
    stroke = Stroke(0.75, 0.85, 0.775)
    for x in (stroke.ends[0] + short, stroke.ends[1] - short):
        bases = Fraction(x), Fraction(stroke.a) - Fraction(x)
        for leg, length, base in zip(stroke.legs_at(x), (0.85, 0.775), bases, strict=True):
            height = float(Fraction(length) ** 2 - base**2) ** 0.5
            assert -leg.position[1] == pytest.approx(height, rel=1e-15)


@pytest.mark.parametrize("x", [0.1449, 0.8501, -1.0, np.nan, np.inf])
def test_position_outside_stroke_is_refused(x):
    """The stroke of the paper's robot is 0.145 to 0.85 m."""
    with pytest.raises(InputError, match=r"outside the stroke 0.145 m to 0.85 m"):
        STROKE.legs_at(x)


@pytest.mark.parametrize("alpha", [0.7, 1.0, 2.0])
def test_robot_family_keeps_stroke(alpha):
    """Paper, eqs (10), (11): L = α L0 and a = α (L10 + L20) − d; d, EA, EI, GJ, μ are unchanged.

    Leg lengths grow by α, and the distance a of the slides keeps the stroke d.
    """
    a, *legs = family_member(0.92, LEG1, LEG2, alpha)
    assert a == pytest.approx(alpha * 1.625 - 0.705, rel=1e-14)
    for leg, original in zip(legs, (LEG1, LEG2), strict=True):
        assert leg.timoshenko == equivalent_leg(original).timoshenko
        assert leg.length == pytest.approx(alpha * original.length, rel=1e-14)
        assert leg.mass == pytest.approx(alpha * original.mass, rel=1e-14)


def test_robot_family_needs_legs_that_meet():
    """a > α |L10 − L20| gives α > d / (2 L20) = 0.705/1.55 = 0.4548; a > 0 gives 0.4338."""
    for alpha, message in ((0.4549, ""), (0.4548, "never becomes horizontal"), (0.43, "a > 0")):
        a, leg1, leg2 = family_member(0.92, LEG1, LEG2, alpha)
        faults = "".join(Stroke(a, leg1.length, leg2.length).faults())
        assert bool(faults) == bool(message)
        assert message in faults


def test_repeated_posture_is_not_solved_again(monkeypatch):
    """Postures of a mechanism loaded again come from memory."""
    forget()
    mechanism = load_robot("five-bar").mechanism
    monkeypatch.setattr("lumped.mechanism.kinematics.postures._continued", pytest.fail)
    assert "motor1" in posture(mechanism, mechanism.poses[0]).coordinates
