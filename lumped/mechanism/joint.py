"""Joints: which relative twists of two interfaces they leave free, and what gives way in them."""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError

# A further kind has its place in every `match` on this: the type checker lists those without it.
JointKind: TypeAlias = Literal[
    "fixed", "revolute", "prismatic", "cylindrical", "universal", "spherical", "planar"
]
# How many axes a kind has.
AXES: dict[JointKind, int] = {
    "fixed": 0,
    "revolute": 1,
    "prismatic": 1,
    "cylindrical": 1,
    "universal": 2,
    "spherical": 0,
    "planar": 1,
}
# Units of the coordinates of a kind, one for each of its free twists.
COORDINATES: dict[JointKind, tuple[str, ...]] = {
    "fixed": (),
    "revolute": ("rad",),
    "prismatic": ("m",),
    "cylindrical": ("m", "rad"),
    "universal": ("rad", "rad"),
    "spherical": ("rad", "rad", "rad"),
    "planar": ("m", "m", "rad"),
}
FREEDOMS = {kind: len(units) for kind, units in COORDINATES.items()}


# Sine of the angle below which two directions are one: what six digits give.
SMALLEST_SINE = 1e-5
# Rounding of a unit vector's length.
_UNIT = 1e-9


@dataclass(frozen=True)
class Side:
    """One side of a joint: a body (or "ground") and the name of its interface."""

    body: str
    point: str


@dataclass(frozen=True)
class Drive:
    """What actuates a joint: `stiffness` on its free twist (N/m or N m/rad), None where rigid.

    `simplified`: the stiffness that the model of rigid bodies on elastic drives takes instead,
    where it stands for more than the drive; None where it does not. `loss` is the loss factor of
    either. `inertia` (kg or kg m²) of the rotor, times its ratio squared: it moves as the stiffness
    gives way.
    """

    stiffness: float | None = None
    simplified: float | None = None
    loss: float = 0.0
    inertia: float = 0.0


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint between two interfaces.

    `axes` (n×3, unit vectors, base axes of the reference posture): one for revolute, prismatic,
    cylindrical and planar (its normal) joints, two for a universal joint (the first fixed in the
    first body, the second in the second), none for fixed and spherical ones. Interfaces may be
    apart along the axis of a prismatic or cylindrical joint. `compliance` (6×6, SI, base axes of
    the reference posture, fixed to the first body) is the joint's own give, in series; `loss` its
    loss factor. Raises InputError for axes that are not as said.
    """

    name: str
    kind: JointKind
    first: Side
    second: Side
    axes: Array
    drive: Drive | None = None
    compliance: Array | None = None
    loss: float = 0.0

    def __post_init__(self) -> None:
        if faults := self._faults():
            raise InputError(f"joint {self.name}: {fault}" for fault in faults)

    def _faults(self) -> list[str]:
        """What would silently be another joint: axes too few, not of unit length, or parallel."""
        count = AXES[self.kind]
        if np.shape(self.axes) != (count, 3):
            shape = "×".join(map(str, np.shape(self.axes)))
            return [f"axes {shape}: a {self.kind} joint has {count}×3"]
        lengths = np.linalg.norm(self.axes, axis=1)
        faults = [
            f"axis {place} has length {length:.6g}: must be a unit vector"
            for place, length in enumerate(lengths, start=1)
            if not abs(length - 1.0) <= _UNIT
        ]
        if not faults and count > 1 and np.linalg.norm(np.cross(*self.axes)) < SMALLEST_SINE:
            faults.append("axes are parallel: the joint would turn about one alone")
        if self.compliance is not None and np.shape(self.compliance) != (6, 6):
            faults.append("compliance must be 6×6")
        return faults
