"""Virtual joints: hand-computed limits, the invariants of eq. (3), and the paper's demonstrator."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from like_ifw import IFW, like_ifw, placed_at, stations
from numpy.testing import assert_allclose
from scipy.spatial.transform import Rotation

from lumped.errors import ComputationError
from lumped.legs import constant_leg, given_compliance
from lumped.mechanism.biglide import Stroke, biglide
from lumped.models import serial_chains, vjm
from lumped.models.bodies import tip_compliances
from lumped.models.chains import ChainJoint, Fixed, VirtualSpring, chain_jacobians
from lumped.screws import move_compliance, rotation_z

X, Y, Z = np.eye(3)
MICROMETRE_PER_KILONEWTON = 1e-9


def passive(axis, kind="revolute", coordinate=0.0):
    return ChainJoint(kind, axis, coordinate)


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


KINDS = ["fixed", "prismatic", "revolute", "spring"]
SOFTEST = 1e7  # N/m and N m/rad, the softest stiffness that a random spring has


def independent_columns(Jq):
    """Rank of Jq, skipping the edge of a singular posture, where it is a matter of tolerance."""
    sizes = np.linalg.svd(Jq, compute_uv=False)
    assume(np.all((sizes > 1e-3) | (sizes < 1e-9)))
    return int(np.sum(sizes > 1e-6))


def random_chain(kinds, seed):
    """Chains whose springs' principal compliances span two decades, an own reach of metres."""
    rng = np.random.default_rng(seed)
    chain = []
    for kind in ["spring", *kinds, "fixed"]:
        chain.append(Fixed(rng.normal(size=3), Rotation.random(random_state=rng).as_matrix()))
        if kind == "spring":
            axes = np.linalg.qr(rng.normal(size=(6, 6)))[0]
            chain.append(VirtualSpring(axes @ np.diag(10.0 ** rng.uniform(-9, -7, 6)) @ axes.T))
        elif kind != "fixed":
            chain.append(ChainJoint(kind, rng.normal(size=3), rng.normal()))
    return tuple(chain)


chains = st.builds(
    random_chain, st.lists(st.sampled_from(KINDS), max_size=8), st.integers(0, 2**32 - 1)
)


@given(chains)
def test_invariants_on_random_chains(chain):
    """K = Kᵀ, K·Jq = 0, no negative eigenvalue, rank 6 − independent passive joints."""
    K = vjm.chain_stiffness(chain)
    Jq = chain_jacobians(chain).passive
    independent = independent_columns(Jq)
    largest = max(float(np.abs(K).max()), SOFTEST)
    assert np.array_equal(K, K.T)
    # 1e-12: rounding times a reach of ten metres, squared
    assert np.abs(K @ Jq).max(initial=0.0) <= 1e-12 * largest * np.abs(Jq).max(initial=1.0)
    values = np.linalg.eigvalsh(K)
    assert values[0] >= -1e-12 * largest
    # two decades of springs times a reach of some metres leave six decades to the zeros
    assert np.sum(values > 1e-9 * largest) == 6 - independent


@given(chains)
def test_stiffness_is_the_springs_seen_by_loads_that_no_joint_yields_to(chain):
    """Independent formulation: f = Zλ with JqᵀZ = 0 gives K = Z (ZᵀSθZ)⁻¹ Zᵀ."""
    jacobians = chain_jacobians(chain)
    S = jacobians.springs @ jacobians.compliance @ jacobians.springs.T
    independent = independent_columns(jacobians.passive)
    Z = np.linalg.svd(jacobians.passive)[0][:, independent:] if independent else np.eye(6)
    expected = Z @ np.linalg.solve(Z.T @ S @ Z, Z.T)
    found = vjm.chain_stiffness(chain)
    # condition of ZᵀSθZ: two decades of springs, a reach of ten metres squared
    assert np.abs(found - expected).max() <= 1e-8 * max(np.abs(found).max(), SOFTEST)


@given(chains, st.sampled_from([1e-6, 1e-3, 1e3, 1e6]))
def test_units_do_not_matter(chain, metre):
    """Lengths from µm to Mm: the same K after conversion, by the same decisions."""

    def convert(element):
        match element:
            case Fixed():
                return replace(element, translation=element.translation / metre)
            case ChainJoint(kind="prismatic"):
                return replace(element, coordinate=element.coordinate / metre)
            case VirtualSpring():
                unit = np.array([1.0 / metre] * 3 + [1.0] * 3)
                # N m per rad becomes N (unit) per rad
                return VirtualSpring(element.compliance * np.outer(unit, unit) * metre)
        return element

    independent_columns(chain_jacobians(chain).passive)
    unit = np.array([metre] * 3 + [1.0] * 3)
    converted = vjm.chain_stiffness(tuple(convert(element) for element in chain))
    found, expected = converted / np.outer(unit, unit) * metre, vjm.chain_stiffness(chain)
    # tolerance as in the test above
    assert np.abs(found - expected).max() <= 1e-8 * max(np.abs(expected).max(), SOFTEST)


def test_stretched_arm_of_three_parallel_joints():
    """In line, three parallel axes release two motions; a bent arm releases all three."""

    def arm(bend):
        spring = VirtualSpring(np.eye(6) * 1e-8)
        link = (Fixed(0.5 * X), spring)
        return (passive(Z), *link, passive(Z, coordinate=bend), *link, passive(Z), Fixed(0.2 * X))

    stretched, bent = vjm.chain_stiffness(arm(0.0)), vjm.chain_stiffness(arm(1e-3))
    assert np.linalg.matrix_rank(stretched, tol=1e-6 * stretched.max()) == 4
    assert np.linalg.matrix_rank(bent, tol=1e-6 * bent.max()) == 3
    # along x two springs in series; their rotation about z does not yield to a force along x
    assert stretched[0, 0] == pytest.approx(1e8 / 2.0, rel=1e-12)


def test_singular_spring_whose_rigid_direction_a_joint_releases():
    """Sθ = diag(c, c, c, c, c, 0) alone is singular; with a revolute joint about z K exists."""
    compliance = np.diag([1.0, 2.0, 3.0, 4.0, 5.0, 0.0]) * 1e-9
    K = vjm.chain_stiffness((passive(Z), VirtualSpring(compliance)))
    expected = np.diag([1.0, 1 / 2, 1 / 3, 1 / 4, 1 / 5, 0.0]) * 1e9
    assert_allclose(K, expected, rtol=1e-12, atol=1e-3)


@pytest.mark.parametrize(
    ("chain", "words"),
    [
        (
            (Fixed(X), passive(X, "prismatic"), passive(Z), passive(Y, "prismatic")),
            "a force along z",
        ),
        ((VirtualSpring(np.diag([1.0, 0.0, 1.0, 1.0, 1.0, 1.0]) * 1e-9),), "a force along y"),
        (
            (VirtualSpring(np.diag([1.0, 1.0, 1.0, 1.0, 1.0, 0.0]) * 1e-9), Fixed(0.4 * X)),
            "a moment about z",
        ),
        ((Fixed(), ChainJoint("prismatic", Y, drive="actuated")), "a force along x"),
        (
            (
                Fixed(X, rotation_z(np.arctan2(4.0, 3.0))),
                VirtualSpring(np.diag([0.0, 1.0, 1.0, 1.0, 1.0, 1.0]) * 1e-9),
                passive(Z),
                Fixed(Y),
            ),
            r"a force along \(0.6, 0.8, 0\) through \(0.8, -0.6, 0\) m",
        ),
    ],
)
def test_a_rigid_chain_is_named_with_its_direction(chain, words):
    with pytest.raises(ComputationError, match=rf"arm is rigid against {words}"):
        vjm.chain_stiffness(chain, "arm")


@pytest.mark.parametrize(
    ("chain", "words"),
    [
        ((passive(Z), Fixed(0.5 * X)), r"turn about z through \(-0.5, 0, 0\) m from the loaded"),
        ((passive(Y, "prismatic"),), "translate along y"),
        ((passive(3.0 * X + 4.0 * Y, "prismatic"),), r"translate along \(0.6, 0.8, 0\)"),
        ((passive(X), passive(Y)), "turn about x .* and turn about y through the loaded point"),
    ],
)
def test_a_free_platform_is_named_with_its_direction(chain, words):
    spring = VirtualSpring(np.diag([1.0, 2.0, 3.0, 40.0, 50.0, 60.0]) * 1e-9)
    K = vjm.robot_stiffness([(spring, *chain)])
    with pytest.raises(ComputationError, match=f"free to {words}"):
        vjm.platform_compliance(K)


def test_a_platform_without_chains_and_one_on_a_negative_spring():
    with pytest.raises(ComputationError, match="translate along x and translate along y"):
        vjm.platform_compliance(np.zeros((6, 6)))
    with pytest.raises(ComputationError, match="negative eigenvalue"):
        vjm.platform_compliance(np.diag([1e9, 1e9, -1e3, 1e7, 1e7, 1e7]))


@pytest.mark.parametrize("side", [0.1, 0.01, 0.002])
def test_a_free_platform_on_slender_legs_is_not_taken_for_a_soft_one(side):
    """A bar of slenderness 10 to 500 pinned at its root: EA L²/EI up to 3e6, still named free."""
    section = {"EA": side**2, "EIy": side**4 / 12.0, "EIz": side**4 / 12.0, "GJ": side**4 / 7.0}
    leg = constant_leg(1.0, **{name: 2e11 * value for name, value in section.items()}, mass=1.0)
    spring = VirtualSpring(given_compliance(leg))
    for angle in np.linspace(0.1, 3.0, 20):
        chain = (passive(Z, coordinate=angle), Fixed(X), spring)
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


@given(
    st.floats(0.3, 3.0),
    st.floats(0.3, 3.0),
    st.floats(0.05, 0.95),
    st.floats(0.0, 1.0),
    st.integers(0, 2**32 - 1),
)
def test_random_biglides_with_rigid_feet(l1, l2, share, place, seed):
    """Pinned legs: planar compliance is the truss of EA/L, whatever their bending and torsion."""
    rng = np.random.default_rng(seed)
    legs = [
        constant_leg(length, *(10.0 ** rng.uniform([8, 6, 6, 6], [9, 7, 7, 7])), mass=10.0)
        for length in (l1, l2)
    ]
    shortest = abs(l1 - l2)
    a = shortest + share * (l1 + l2 - shortest)
    robot = biglide("random", a, *legs, platform_mass=10.0, drive_stiffness=1e9)
    first, last = stations(robot, 2)
    x = first + place * (last - first)
    both = Stroke(a, l1, l2).legs_at(x)
    directions = np.column_stack([leg.rotation[:2, 0] for leg in both])
    assume(abs(np.linalg.det(directions)) > 0.05)  # away from aligned legs
    axial = np.diag([leg.timoshenko.EA / leg.length for leg in legs])
    expected = np.linalg.inv(directions @ axial @ directions.T)
    for theory in ("euler-bernoulli", "timoshenko"):
        found = compliance(robot, x, tip_compliances(robot, theory=theory))[:2, :2]
        # condition of the legs (1e4) and of the truss (1e3) times rounding, with margin
        assert np.abs(found - expected).max() <= 1e-9 * np.abs(expected).max()
