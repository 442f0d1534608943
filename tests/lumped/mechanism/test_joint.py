"""What every kind of joint leaves free and forbids, physics.md section 7, and legs on points."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lumped.errors import InputError
from lumped.mechanism.free_twists import twists_left_free
from lumped.mechanism.joint import FREEDOMS, Joint, Side
from lumped.mechanism.kinematics.closure import Closure, Placement
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool
from lumped.mechanism.placing import leg_frame, rigid_on

TURN = Rotation.from_euler("z", 0.7).as_matrix()
TILT = Rotation.from_euler("XY", [0.4, -0.8]).as_matrix()


def single_joint(kind):
    """Two bodies on one joint at the origin, its axis z; a universal joint's axes x and y."""
    none = np.zeros((0, 3))
    axes = {"universal": np.eye(3)[:2], "spherical": none, "fixed": none}.get(kind, np.eye(3)[2:])
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
def test_each_kind_allows_its_motions_one_by_one_and_forbids_others(kind, place, turn, values):
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
    assert np.abs(closure.residual(closed)).max() < 1e-15
    (found,) = closure.coordinates(closed)
    shown = [np.linalg.norm(found[:2]), found[2]] if kind == "planar" else found
    assert shown == pytest.approx(values, abs=1e-15)
    twists = twists_left_free(mechanism.joints[0], base, base @ turn).T
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
def test_a_leg_s_z_is_as_near_to_up_as_it_can_be(end, up, z):
    x, y, found = leg_frame(np.zeros(3), np.array(end), up).rotation.T
    assert x == pytest.approx(np.array(end) / np.linalg.norm(end), abs=1e-15)
    assert found == pytest.approx(z, abs=1e-15)
    assert y == pytest.approx(np.cross(z, x), abs=1e-14)
