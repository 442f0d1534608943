"""Joints: twists that every kind leaves free, physics.md section 7, and axes of another kind."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from lumped.errors import InputError
from lumped.mechanism.free_twists import twists_left_free
from lumped.mechanism.joint import Joint, Side

AXIS = np.array([2.0, -1.0, 2.0]) / 3.0
OTHER = np.array([1.0, 0.0, -1.0]) / np.sqrt(2.0)
# Both bodies have turned since the reference posture, about axes that are none of the joint's.
FIRST = Rotation.from_rotvec([0.0, 0.42, 0.56]).as_matrix()
SECOND = Rotation.from_rotvec([-0.4, 0.0, 0.0]).as_matrix()


def found(kind, axes):
    """Twists as rows."""
    joint = Joint("j", kind, Side("a", "P"), Side("b", "P"), np.array(axes).reshape(-1, 3))
    return twists_left_free(joint, FIRST, SECOND).T


@pytest.mark.parametrize(
    ("kind", "axes", "expected"),
    [
        ("fixed", [], np.zeros((0, 6))),
        ("revolute", [AXIS], [[0, 0, 0, *FIRST @ AXIS]]),
        ("prismatic", [AXIS], [[*FIRST @ AXIS, 0, 0, 0]]),
        ("cylindrical", [AXIS], [[*FIRST @ AXIS, 0, 0, 0], [0, 0, 0, *FIRST @ AXIS]]),
        ("universal", [AXIS, OTHER], [[0, 0, 0, *FIRST @ AXIS], [0, 0, 0, *SECOND @ OTHER]]),
        ("spherical", [], np.eye(6)[3:]),
    ],
)
def test_each_kind_leaves_its_own_twists_free(kind, axes, expected):
    assert found(kind, axes) == pytest.approx(np.array(expected), abs=1e-15)


def test_a_planar_joint_slides_across_its_normal_and_turns_about_it():
    one, other, turn = found("planar", [AXIS])
    normal = FIRST @ AXIS
    assert turn == pytest.approx([0, 0, 0, *normal], abs=1e-15)
    assert np.cross(one[:3], other[:3]) == pytest.approx(normal, abs=1e-15)
    assert [*one[3:], *other[3:], one @ other] == pytest.approx([0.0] * 7, abs=1e-15)


@pytest.mark.parametrize(
    ("axes", "said"),
    [
        ([AXIS], r"axes 1×3: a universal joint has 2×3"),
        ([AXIS, -AXIS], "axes are parallel"),
        ([AXIS, 2.0 * OTHER], "axis 2 has length 2: must be a unit vector"),
    ],
)
def test_axes_that_are_another_joint(axes, said):
    with pytest.raises(InputError, match=said):
        found("universal", axes)
