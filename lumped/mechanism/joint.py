"""Joints: which relative twists of two interfaces they leave free, and what gives way in them."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

from lumped.arrays import Array

JointKind: TypeAlias = Literal[
    "fixed", "revolute", "prismatic", "cylindrical", "universal", "spherical", "planar"
]
# How many axes a kind has, and how many free twists.
AXES: dict[JointKind, int] = {
    "fixed": 0,
    "revolute": 1,
    "prismatic": 1,
    "cylindrical": 1,
    "universal": 2,
    "spherical": 0,
    "planar": 1,
}
FREEDOMS: dict[JointKind, int] = {
    "fixed": 0,
    "revolute": 1,
    "prismatic": 1,
    "cylindrical": 2,
    "universal": 2,
    "spherical": 3,
    "planar": 3,
}


@dataclass(frozen=True)
class Side:
    """One side of a joint: a body (or "ground") and the name of its interface."""

    body: str
    point: str


@dataclass(frozen=True)
class Drive:
    """What actuates a joint: `stiffness` on its free twist (N/m or N m/rad), None where rigid.

    `simplified`: the stiffness that the model of rigid bodies on elastic drives takes instead,
    where it stands for more than the drive; None where it does not.
    """

    stiffness: float | None = None
    simplified: float | None = None


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint between two interfaces.

    `axes` (n×3, unit vectors, base axes of the reference posture): one for revolute, prismatic,
    cylindrical and planar (its normal) joints, two for a universal joint (the first fixed in the
    first body, the second in the second), none for fixed and spherical ones. Interfaces may be
    apart along the axis of a prismatic or cylindrical joint. `compliance` (6×6, SI, base axes of
    the reference posture, fixed to the first body) is the joint's own give, in series.
    """

    name: str
    kind: JointKind
    first: Side
    second: Side
    axes: Array
    drive: Drive | None = None
    compliance: Array | None = None
