"""Joints made in Python: axes that would silently be another joint are refused."""

import numpy as np
import pytest

from lumped.errors import InputError
from lumped.mechanism.joint import Joint, Side

X, Y = np.eye(3)[:2]
SIDES = Side("one", "P"), Side("other", "P")


@pytest.mark.parametrize(
    ("kind", "axes", "said"),
    [
        ("universal", [X], r"axes 1×3: a universal joint has 2×3"),
        ("universal", [X, -X], "axes are parallel"),
        ("universal", [X, 2.0 * Y], "axis 2 has length 2: must be a unit vector"),
        ("revolute", [[0.0, 0.0, 0.0]], "axis 1 has length 0"),
        ("revolute", X, "axes 3: a revolute joint has 1×3"),
    ],
)
def test_axes_that_are_another_joint(kind, axes, said):
    with pytest.raises(InputError, match=said):
        Joint("hinge", kind, *SIDES, np.array(axes))


def test_the_give_of_a_joint_is_6_by_6():
    with pytest.raises(InputError, match="joint hinge: compliance must be 6×6"):
        Joint("hinge", "fixed", *SIDES, np.zeros((0, 3)), compliance=np.eye(3))
