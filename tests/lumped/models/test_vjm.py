"""Virtual joint method: limits computed by hand, invariants of eq. (3), the paper's robot."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from support.robots.paper_robot_variants import IFW, placed_at, stations, variant_of_ifw

from lumped.equivalent_leg import constant_leg
from lumped.errors import ComputationError
from lumped.legs import given_compliance
from lumped.models import serial_chains, vjm
from lumped.models.bodies import tip_compliances
from lumped.screws import move_compliance, rotation_z, turn_matrix

X, Y, Z = np.eye(3)
O = np.zeros(3)


def along(*axis):
    """Return the 6-component twist of a slide along `axis`."""
    return np.array([*axis, 0.0, 0.0, 0.0])


def about(*axis):
    """Return the 6-component twist of a hinge about `axis`."""
    return np.array([0.0, 0.0, 0.0, *axis])


def stiffness(end, joints, springs):
    return vjm.chain_stiffness(vjm.serial_chain(end, joints, springs), "arm")


def compliance(robot, x):
    """Return the 6×6 compliance at the loaded point, with B at `x` (m)."""
    (posture,) = placed_at(robot, x)
    return serial_chains.compliance(posture, tip_compliances(robot))


def deflections(compliance):
    """Return three deflections (µm) at 1000 N: in the plane by Fx and by Fy, along z by Fz."""
    planar = np.linalg.norm(compliance[:2, :2], axis=0)
    return np.array([*planar, compliance[2, 2]]) * 1e9


@pytest.mark.parametrize(
    ("x", "fx", "fy", "fz"),
    [(0.145, 0.42, 8.76, 26.1), (0.4975, 8.81, 4.19, 27.2), (0.850, 2.97, 6.15, 27.6)],
)
def test_vjm_deflections_equal_paper(x, fx, fy, fz):
    """Values printed in the paper, to half a unit of the last digit (27.145 is printed as 27.2)."""
    computed = deflections(compliance(IFW.mechanism, x))
    assert np.all(np.abs(computed - [fx, fy, fz]) <= [0.005, 0.005, 0.06])


def arm(bend, metre=1.0):
    """Return the SI stiffness of three parallel hinges and two springs, computed in another unit.

    The unit of length is `metre` per metre; `bend` (rad) is the angle of the elbow.
    """
    # Lengths in the other unit: N m/rad becomes N (unit)/rad.
    unit = np.array([metre] * 3 + [1.0] * 3)
    spring = 1e-8 * np.diag(metre / unit**2)
    elbow, forearm = 0.5 * X, rotation_z(bend) @ X
    wrist = elbow + 0.5 * forearm
    joints = [(point / metre, about(*Z)) for point in (O, elbow, wrist)]
    springs = [(point / metre, spring) for point in (elbow, wrist)]
    K = stiffness((wrist + 0.2 * forearm) / metre, joints, springs)
    assert np.array_equal(K, K.T)
    return K / np.outer(unit, unit) * metre


@pytest.mark.parametrize("metre", [1e-6, 1e-3, 1e3, 1e6])
@pytest.mark.parametrize(("bend", "rank"), [(0.0, 4), (1e-3, 3)])
def test_stretched_hinges_release_two_motions(bend, rank, metre):
    """Three hinges with parallel axes release two motions when in line and three when bent."""
    K = arm(bend)
    assert np.linalg.matrix_rank(K, tol=1e-6 * K.max()) == rank
    assert np.abs(arm(bend, metre) - K).max() <= 1e-8 * K.max()
    # Along x two springs act in series; a force along x does not rotate them about z.
    assert bend or K[0, 0] == pytest.approx(1e8 / 2.0, rel=1e-12)


def test_joint_motion_replaces_rigid_spring():
    """Spring compliance diag(c, c, c, c, c, 0) is singular; with a hinge about z K exists."""
    spring = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 0.0]) * 1e-9
    K = stiffness(O, [(O, about(*Z))], [(O, spring)])
    assert_allclose(K, np.diag([1, 1 / 2, 1 / 3, 1 / 4, 1 / 5, 0]) * 1e9, rtol=1e-12, atol=1e-3)


@pytest.mark.parametrize(
    ("joints", "springs", "words"),
    [
        ([(O, along(*X)), (O, about(*Z)), (O, along(*Y))], [], "a force along z"),
        ([], [(-0.4 * X, [1, 1, 1, 1, 1, 0])], "a moment about z"),
        (
            [(O, about(*Z)), (O, along(4, -3, 0))],
            [(O, [0, 0, 1, 1, 1, 1])],
            r"a force along \(0.6, 0.8, 0\) through the loaded",
        ),
    ],
)
def test_chain_without_compliance_names_direction(joints, springs, words):
    """Joints or springs that leave one force direction rigid: it is named in words."""
    compliances = [(frame, 1e-9 * np.diag(diagonal)) for frame, diagonal in springs]
    with pytest.raises(ComputationError, match=rf"arm is rigid against {words}"):
        stiffness(O, joints, compliances)


def spring_behind(*joints):
    """Return the 6×6 stiffness of a spring in series with passive joints."""
    return stiffness(O, joints, [(O, 1e-9 * np.diag([1.0, 2.0, 3.0, 40.0, 50.0, 60.0]))])


@pytest.mark.parametrize(
    ("K", "words"),
    [
        (
            spring_behind((-0.5 * X, about(*Z))),
            r"turn about z through \(-0.5, 0, 0\) m from the loaded",
        ),
        (spring_behind((O, along(3, 4, 0))), r"translate along \(0.6, 0.8, 0\)"),
        (
            spring_behind((O, about(*X)), (O, about(*Y))),
            "turn about x .* and turn about y through the",
        ),
        (np.zeros((6, 6)), ".* translate along x and translate along y"),
        # By rounding the stiffness of a free motion may also be negative.
        (np.diag([1e9, 1e9, -1e3, 1e7, 1e7, 1e7]), "translate along z: .* negative"),
        (np.diag([1e9, 1e9, -1e-2, 1e7, 1e7, 1e7]), "translate along z: .* negative"),
    ],
)
def test_free_platform_reports_motion(K, words):
    """A singular platform stiffness: its free motion in words, such as a turn about a point."""
    with pytest.raises(ComputationError, match=f"free to {words}"):
        vjm.platform_compliance(K)


@pytest.mark.parametrize("side", [0.1, 0.002])
@pytest.mark.parametrize("angle", np.linspace(0.1, 3.0, 5))
def test_free_platform_of_slender_leg_is_refused(side, angle):
    """Leg of slenderness 10 to 500 on one hinge: the free motion is found up to EA L²/EI = 3e6."""
    I = side**4 / 12.0
    leg = constant_leg(1.0, EA=2e11 * side**2, EIy=2e11 * I, EIz=2e11 * I, GJ=3e11 * I, mass=1.0)
    turned = rotation_z(angle)
    spring = turn_matrix(given_compliance(leg), turned)
    K = stiffness(turned @ X, [(O, about(*Z))], [(turned @ X, spring)])
    with pytest.raises(ComputationError, match=r"free to turn about z through \("):
        vjm.platform_compliance(K)


def test_tool_offset_changes_compliance():
    """A rigid offset X gives C_P = X C_B Xᵀ; the planar deflection grows to 13.6 µm.

    The paper prints no sign of the offset; 13.6 µm results with the tool on the −z side.
    """
    offset, tool = np.array([0.0, 0.0, -0.155]), 1e-9 * np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0])
    robot = variant_of_ifw(tool_offset=offset)
    at_b, at_p = compliance(IFW.mechanism, 0.4975), compliance(robot, 0.4975)
    assert_allclose(at_p, move_compliance(at_b, offset), rtol=1e-11, atol=1e-20)
    largest = max(deflections(compliance(robot, x))[:2].max() for x in stations(robot, 21))
    assert largest == pytest.approx(13.6, abs=0.05)  # digits printed
    with_tool = compliance(variant_of_ifw(tool_offset=offset, tool_compliance=tool), 0.4975)
    assert_allclose(with_tool, at_p + tool, rtol=1e-12)
