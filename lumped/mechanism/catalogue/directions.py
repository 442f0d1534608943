"""Named directions of joints, and matrices of stiffness or damping along them.

The x axis of a joint is its axis. For a universal joint it is the normal of the two axes in the
reference posture, and for a spherical or fixed joint the direction `up`. The z axis of a prismatic
joint is as close to `up` as possible: x is along the slide, y is lateral and z is normal, and roll,
pitch and yaw are rotations about x, y and z. Joints of all other kinds have equal values along y
and z, so that the direction of z does not matter.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.joint import JointKind
from lumped.screws import turn_matrix


@dataclass(frozen=True)
class Direction:
    """Named direction of a joint, such as "axial" or "tilting", for translations or rotations.

    `components` are the indices (0 to 5) of the components of a twist (joint axes) that belong to
    the direction. `free` is True if the joint can move in these components.
    """

    components: tuple[int, ...]
    free: bool = False

    @property
    def turns(self) -> bool:
        """True if the direction is a rotation about an axis."""
        return self.components[0] >= 3


_AXIAL, _RADIAL, _TILTING = Direction((0,)), Direction((1, 2)), Direction((4, 5))
_TURNING, _TORSION = Direction((3,), free=True), Direction((3,))
DIRECTIONS: dict[JointKind, dict[str, Direction]] = {
    "fixed": {"axial": _AXIAL, "radial": _RADIAL, "torsion": _TORSION, "tilting": _TILTING},
    "revolute": {"axial": _AXIAL, "radial": _RADIAL, "tilting": _TILTING, "turning": _TURNING},
    "prismatic": {
        "normal": Direction((2,)),
        "lateral": Direction((1,)),
        "roll": _TORSION,
        "pitch": Direction((4,)),
        "yaw": Direction((5,)),
        "along": Direction((0,), free=True),
    },
    "cylindrical": {
        "radial": _RADIAL,
        "tilting": _TILTING,
        "along": Direction((0,), free=True),
        "turning": _TURNING,
    },
    # The moment of a universal joint is along x. It has the same compliance about all axes, since
    # x turns with the second body.
    "universal": {
        "axial": _AXIAL,
        "radial": _RADIAL,
        "torsion": Direction((3, 4, 5)),
        "turning": Direction((3, 4, 5), free=True),
    },
    "spherical": {
        "axial": _AXIAL,
        "radial": _RADIAL,
        "turning": Direction((3, 4, 5), free=True),
    },
    "planar": {
        "axial": _AXIAL,
        "tilting": _TILTING,
        "sliding": Direction((1, 2), free=True),
        "turning": _TURNING,
    },
}
# Pairs of directions, by kind, whose numbers need the direction `up` if they differ.
NEED_UP: dict[JointKind, tuple[tuple[str, str], ...]] = {
    "fixed": (("axial", "radial"), ("torsion", "tilting")),
    "prismatic": (("normal", "lateral"), ("pitch", "yaw")),
    "spherical": (("axial", "radial"),),
}


def joint_axes(kind: JointKind, axes: Array, up: Array | None) -> Array:
    """Axes x, y and z (3×3, as columns) of a joint in base axes of the reference posture.

    `axes` (n×3, unit vectors) are the n axes that define the joint, as in `Joint.axes`. `up` (3) is
    the direction in the module docstring. If it is None, axes that depend on it are arbitrary.
    """
    if kind in {"spherical", "fixed"}:
        x = np.eye(3)[0] if up is None else up / np.linalg.norm(up)
    elif kind == "universal":
        x = np.cross(*axes)
        x /= np.linalg.norm(x)
    else:
        x = axes[0]
    z = up if up is not None and kind == "prismatic" else np.eye(3)[np.argmin(np.abs(x))]
    y = np.cross(z, x)
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])


def joint_matrix(kind: JointKind, axes: Array, values: Mapping[str, float]) -> Array | None:
    """Symmetric 6×6 matrix in base axes, from `values` along named directions of a joint.

    The keys of `values` are names in `DIRECTIONS`. `axes` (3×3) are the axes from `joint_axes`. The
    matrix is zero along directions without a value. None if all values are zero.
    """
    diagonal = np.zeros(6)
    for name, value in values.items():
        diagonal[list(DIRECTIONS[kind][name].components)] = value
    if not diagonal.any():
        return None
    matrix = turn_matrix(np.diag(diagonal), axes)
    return np.asarray(0.5 * (matrix + matrix.T))
