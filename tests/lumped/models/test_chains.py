"""Jacobians by twists against finite differences of a forward kinematics written here."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from lumped.errors import InputError
from lumped.models.chains import ChainJoint, Fixed, VirtualSpring, chain_jacobians

KINDS = ["fixed", "prismatic", "revolute", "actuated", "spring"]


def random_chain(kinds, seed):
    rng = np.random.default_rng(seed)
    chain = []
    for kind in kinds:
        if kind == "fixed":
            turn = Rotation.random(random_state=rng).as_matrix()
            chain.append(Fixed(translation=rng.normal(size=3), rotation=turn))
        elif kind == "spring":
            chain.append(VirtualSpring(np.eye(6)))
        else:
            drive = "actuated" if kind == "actuated" else "passive"
            joint = "revolute" if kind == "actuated" else kind
            chain.append(ChainJoint(joint, rng.normal(size=3), rng.normal(), drive))
    return tuple(chain)


def hat(twist):
    x, y, z, a, b, c = twist
    return np.array([[0, -c, b, x], [c, 0, -a, y], [-b, a, 0, z], [0, 0, 0, 0]], dtype=float)


def forward(chain, deflections):
    """End pose (4×4) of a chain whose springs are deflected by the given twists in turn."""
    pose, springs = np.eye(4), iter(deflections)
    for element in chain:
        match element:
            case Fixed():
                step = np.eye(4)
                step[:3, :3], step[:3, 3] = element.rotation, element.translation
            case ChainJoint():
                step = expm(hat(element.twist * element.coordinate))
            case VirtualSpring():
                step = expm(hat(next(springs)))
        pose = pose @ step
    return pose


def end_twist(plus, minus, h):
    """Eq. (7): translation rate of the end point, rotation rate from Ṙ Rᵀ, central difference."""
    rate = (plus - minus) / (2.0 * h)
    spin = rate[:3, :3] @ (0.5 * (plus + minus))[:3, :3].T
    return np.array([*rate[:3, 3], spin[2, 1], spin[0, 2], spin[1, 0]])


@given(st.lists(st.sampled_from(KINDS), min_size=1, max_size=8), st.integers(0, 2**32 - 1))
def test_jacobians_are_the_derivatives_of_the_end_pose(kinds, seed):
    chain = random_chain(kinds, seed)
    springs = sum(isinstance(element, VirtualSpring) for element in chain)
    rest = np.zeros((springs, 6))
    found = chain_jacobians(chain)
    # third derivatives h²/6 and rounding ε/h at h = 1e-5 on chains of a few metres
    h, tolerance = 1e-5, 1e-8

    columns = []
    for i, element in enumerate(chain):
        if isinstance(element, ChainJoint) and element.drive == "passive":
            moved = [
                (*chain[:i], replace(element, coordinate=element.coordinate + d), *chain[i + 1 :])
                for d in (h, -h)
            ]
            columns.append(end_twist(forward(moved[0], rest), forward(moved[1], rest), h))
    expected = np.array(columns).reshape(-1, 6).T
    assert_allclose(found.passive, expected, rtol=0, atol=tolerance * 10)

    columns = []
    for k in range(rest.size):
        step = np.zeros(rest.size)
        step[k] = h
        step = step.reshape(rest.shape)
        columns.append(end_twist(forward(chain, step), forward(chain, -step), h))
    expected = np.array(columns).reshape(-1, 6).T
    assert_allclose(found.springs, expected, rtol=0, atol=tolerance * 10)

    pose = forward(chain, rest)
    assert_allclose(found.end, pose[:3, 3], atol=1e-12)


def test_compliances_lie_in_the_order_of_the_springs():
    """Eq. (5): block diagonal, base first."""
    soft, hard = (
        VirtualSpring(2.0 * np.eye(6)),
        VirtualSpring(np.diag([1.0, 0.0, 0.0, 0.0, 0.0, 3.0])),
    )
    found = chain_jacobians((soft, Fixed(), hard)).compliance
    assert_allclose(np.diag(found), [2.0] * 6 + [1.0, 0.0, 0.0, 0.0, 0.0, 3.0])
    assert np.count_nonzero(found) == 8


@pytest.mark.parametrize("axis", [np.zeros(3), np.array([1.0, 0.0]), np.full(3, np.nan)])
def test_an_axis_without_direction_is_refused(axis):
    with pytest.raises(InputError, match="gives no direction"):
        ChainJoint("revolute", axis)


def test_springs_that_no_body_has_are_refused():
    with pytest.raises(InputError, match="foot: compliance must be a finite 6×6"):
        VirtualSpring(np.eye(3), "foot")
    with pytest.raises(InputError, match="foot: compliance is not symmetric"):
        VirtualSpring(np.eye(6) + np.diag([0.1] * 5, 1), "foot")
    with pytest.raises(InputError, match="foot: compliance has a negative eigenvalue"):
        VirtualSpring(np.diag([1e-9, 1e-9, 1e-9, 1e-7, 1e-7, -1e-12]), "foot")
