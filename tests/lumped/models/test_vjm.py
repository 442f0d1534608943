"""Virtual joints: hand-computed limits, the invariants of eq. (3), and the paper's demonstrator."""

import numpy as np
import pytest
from like_ifw import IFW, like_ifw, placed_at, stations
from numpy.testing import assert_allclose

from lumped.errors import ComputationError
from lumped.legs import constant_leg, given_compliance
from lumped.models import serial_chains, vjm
from lumped.models.bodies import tip_compliances
from lumped.screws import move_compliance, rotation_z, turn_matrix

X, Y, Z = np.eye(3)
O = np.zeros(3)
MICROMETRE_PER_KILONEWTON = 1e-9


def along(axis):
    """Twist of a slide."""
    return np.array([*axis, 0.0, 0.0, 0.0])


def about(axis):
    """Twist of a hinge."""
    return np.array([0.0, 0.0, 0.0, *axis])


def deflections(compliance):
    """|planar| under fx, |planar| under fy, z under fz, in µm at 1000 N."""
    planar = np.linalg.norm(compliance[:2, :2], axis=0)
    return np.array([*planar, compliance[2, 2]]) / MICROMETRE_PER_KILONEWTON


def compliance(robot, x, springs=None):
    """At the loaded point with B at `x` (m), legs as given or by their tip compliances."""
    (at,) = placed_at(robot, x)
    return serial_chains.compliance(at, springs or tip_compliances(robot))


@pytest.mark.parametrize(
    ("x", "fx", "fy", "fz"),
    [(0.145, 0.42, 8.76, 26.1), (0.4975, 8.81, 4.19, 27.2), (0.850, 2.97, 6.15, 27.6)],
)
def test_demonstrator_with_the_appendix_matrices(x, fx, fy, fz):
    """Known values, to half a unit of the last printed digit; 27.145 is printed as 27.2."""
    found = deflections(compliance(IFW.mechanism, x))
    assert np.all(np.abs(found - [fx, fy, fz]) <= [0.005, 0.005, 0.06])


SOFTEST = 1e7  # N/m and N m/rad, the softest stiffness that a random spring has


def random_parts(rng):
    """End, joints and springs of a chain some metres long; compliances span two decades."""
    joints, springs = [], []
    kinds = rng.choice(["prismatic", "revolute", "spring"], rng.integers(9))
    for kind in ["spring", *kinds]:
        place = 2.0 * rng.normal(size=3)
        if kind == "spring":
            axes = np.linalg.qr(rng.normal(size=(6, 6)))[0]
            springs.append((place, axes @ np.diag(10.0 ** rng.uniform(-9, -7, 6)) @ axes.T))
        else:
            axis = rng.normal(size=3)
            twist = along(axis) if kind == "prismatic" else about(axis)
            joints.append((place, twist / np.linalg.norm(axis)))
    return rng.normal(size=3), joints, springs


@pytest.mark.parametrize("seed", range(20))
def test_a_chain_is_its_springs_seen_by_loads_that_no_joint_yields_to(seed):
    """Independent formulation: f = Zλ with JqᵀZ = 0 gives K = Z (ZᵀSθZ)⁻¹ Zᵀ, whatever the unit."""
    end, joints, springs = random_parts(np.random.default_rng(seed))
    chain = vjm.serial_chain(end, joints, springs)
    K, S, Jq = vjm.chain_stiffness(chain), chain.compliance, chain.passive
    independent = int(np.sum(np.linalg.svd(Jq, compute_uv=False) > 1e-6))
    Z = np.linalg.svd(Jq)[0][:, independent:] if independent else np.eye(6)
    expected = Z @ np.linalg.solve(Z.T @ S @ Z, Z.T)
    largest = max(float(np.abs(K).max()), SOFTEST)
    # condition of ZᵀSθZ: two decades of springs, a reach of ten metres squared
    assert np.abs(K - expected).max() <= 1e-8 * largest
    assert np.array_equal(K, K.T)
    # 1e-12: rounding times a reach of ten metres, squared
    assert np.abs(K @ Jq).max(initial=0.0) <= 1e-12 * largest * np.abs(Jq).max(initial=1.0)
    assert np.linalg.eigvalsh(K)[0] >= -1e-12 * largest
    # Lengths from µm to Mm: N m per rad becomes N (unit) per rad, decisions stay the same.
    metre = [1e-6, 1e-3, 1e3, 1e6][seed % 4]
    unit = np.array([metre] * 3 + [1.0] * 3)
    moved = [(place / metre, twist) for place, twist in joints]
    sprung = [(place / metre, own / np.outer(unit, unit) * metre) for place, own in springs]
    converted = vjm.chain_stiffness(vjm.serial_chain(end / metre, moved, sprung))
    assert np.abs(converted / np.outer(unit, unit) * metre - K).max() <= 1e-8 * largest


def test_stretched_arm_of_three_parallel_joints():
    """In line, three parallel axes release two motions; a bent arm releases all three."""

    def arm(bend):
        spring = np.eye(6) * 1e-8
        elbow = 0.5 * X
        wrist = elbow + 0.5 * rotation_z(bend) @ X
        joints = [(0.0 * X, about(Z)), (elbow, about(Z)), (wrist, about(Z))]
        end = wrist + 0.2 * rotation_z(bend) @ X
        return vjm.serial_chain(end, joints, [(elbow, spring), (wrist, spring)])

    stretched, bent = vjm.chain_stiffness(arm(0.0)), vjm.chain_stiffness(arm(1e-3))
    assert np.linalg.matrix_rank(stretched, tol=1e-6 * stretched.max()) == 4
    assert np.linalg.matrix_rank(bent, tol=1e-6 * bent.max()) == 3
    # along x two springs in series; their rotation about z does not yield to a force along x
    assert stretched[0, 0] == pytest.approx(1e8 / 2.0, rel=1e-12)


def test_singular_spring_whose_rigid_direction_a_joint_releases():
    """Sθ = diag(c, c, c, c, c, 0) alone is singular; with a revolute joint about z K exists."""
    spring = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 0.0]) * 1e-9
    K = vjm.chain_stiffness(vjm.serial_chain(O, [(O, about(Z))], [(O, spring)]))
    expected = np.diag([1.0, 1 / 2, 1 / 3, 1 / 4, 1 / 5, 0.0]) * 1e9
    assert_allclose(K, expected, rtol=1e-12, atol=1e-3)


@pytest.mark.parametrize(
    ("joints", "springs", "words"),
    [
        ([(O, along(X)), (O, about(Z)), (O, along(Y))], [], "a force along z"),
        ([], [(-0.4 * X, [1.0, 1.0, 1.0, 1.0, 1.0, 0.0])], "a moment about z"),
        (
            [(O, about(Z)), (O, along([4.0, -3.0, 0.0]))],
            [(O, [0.0, 0.0, 1.0, 1.0, 1.0, 1.0])],
            r"a force along \(0.6, 0.8, 0\) through the loaded",
        ),
    ],
)
def test_a_rigid_chain_is_named_with_its_direction(joints, springs, words):
    given = [(place, 1e-9 * np.diag(diagonal)) for place, diagonal in springs]
    with pytest.raises(ComputationError, match=rf"arm is rigid against {words}"):
        vjm.chain_stiffness(vjm.serial_chain(O, joints, given), "arm")


@pytest.mark.parametrize(
    ("joints", "words"),
    [
        ([(-0.5 * X, about(Z))], r"turn about z through \(-0.5, 0, 0\) m from the loaded"),
        ([(O, along([3.0, 4.0, 0.0]))], r"translate along \(0.6, 0.8, 0\)"),
        ([(O, about(X)), (O, about(Y))], "turn about x .* and turn about y through the loaded"),
    ],
)
def test_a_free_platform_is_named_with_its_direction(joints, words):
    spring = np.diag([1.0, 2.0, 3.0, 40.0, 50.0, 60.0]) * 1e-9
    K = vjm.robot_stiffness([vjm.serial_chain(O, joints, [(O, spring)])])
    with pytest.raises(ComputationError, match=f"free to {words}"):
        vjm.platform_compliance(K)


def test_a_platform_without_chains_and_one_on_a_negative_spring():
    with pytest.raises(ComputationError, match="translate along x and translate along y"):
        vjm.platform_compliance(np.zeros((6, 6)))
    # What rounding leaves of a free motion may be negative, too.
    for left in (-1e3, -1e-2):
        with pytest.raises(ComputationError, match=r"free to translate along z: .* negative"):
            vjm.platform_compliance(np.diag([1e9, 1e9, left, 1e7, 1e7, 1e7]))


@pytest.mark.parametrize("side", [0.1, 0.002])
def test_a_free_platform_on_slender_legs_is_not_taken_for_a_soft_one(side):
    """A bar of slenderness 10 to 500 pinned at its root: EA L²/EI up to 3e6, still named free."""
    section = {"EA": side**2, "EIy": side**4 / 12.0, "EIz": side**4 / 12.0, "GJ": side**4 / 7.0}
    leg = constant_leg(1.0, **{name: 2e11 * value for name, value in section.items()}, mass=1.0)
    for angle in np.linspace(0.1, 3.0, 10):
        turned = rotation_z(angle)
        spring = turn_matrix(given_compliance(leg), turned)
        chain = vjm.serial_chain(turned @ X, [(O, about(Z))], [(turned @ X, spring)])
        with pytest.raises(ComputationError, match=r"free to turn about z through \("):
            vjm.platform_compliance(vjm.chain_stiffness(chain))


def test_tool_offset_moves_the_loaded_point_and_tool_compliance_adds():
    """A rigid offset is C_P = X C_B Xᵀ; planar deflection grows to about 13.6 µm (notes §1).

    The sign of the offset is not printed; 13.6 µm is reached with the tool on the −z side.
    """
    offset = np.array([0.0, 0.0, -0.155])
    at_b, at_p = compliance(IFW.mechanism, 0.4975), compliance(like_ifw(tool_offset=offset), 0.4975)
    assert_allclose(at_p, move_compliance(at_b, offset), rtol=1e-11, atol=1e-20)
    robot = like_ifw(tool_offset=offset)
    largest = max(deflections(compliance(robot, x))[:2].max() for x in stations(robot, 41))
    assert largest == pytest.approx(13.6, abs=0.05)  # digits printed
    tool = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 6.0]) * 1e-9
    with_tool = compliance(like_ifw(tool_offset=offset, tool_compliance=tool), 0.4975)
    assert_allclose(with_tool, at_p + tool, rtol=1e-12)
