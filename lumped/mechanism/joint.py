"""Joints between two interfaces: kind, axes, drive and compliance."""

from dataclasses import dataclass, replace
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError, InputError

# A new kind must be added to every `match` on this type; the type checker finds omissions.
JointKind: TypeAlias = Literal[
    "fixed", "revolute", "prismatic", "cylindrical", "universal", "spherical", "planar"
]
# Number of axes that define a joint of each kind.
AXES: dict[JointKind, int] = {
    "fixed": 0,
    "revolute": 1,
    "prismatic": 1,
    "cylindrical": 1,
    "universal": 2,
    "spherical": 0,
    "planar": 1,
}
# Units of the coordinates of a joint of each kind, one for each free twist.
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


# Sine of the angle below which two directions count as parallel: vectors are typed with six digits.
SMALLEST_SINE = 1e-5
# Tolerance for round-off on the length 1 of a unit vector.
_UNIT = 1e-9


@dataclass(frozen=True)
class Side:
    """One side of a joint: a body (or "ground") and the name of its interface."""

    body: str
    point: str


@dataclass(frozen=True)
class BallScrew:
    """Ball screw of a drive: shaft, nut and bearings in series. A longer shaft is softer.

    `axial` is EA (N) of the shaft with its root diameter. A bearing holds one end of the shaft
    axially. In the reference posture the nut is `length` (m) away from it. This distance increases
    with the coordinate of the joint if `sign` is 1, and decreases if `sign` is −1. `span` (m) is
    the distance between this bearing and a second one that holds the shaft axially. None if the
    second end of the shaft can slide. `bearing` is the compliance (m/N) of each bearing, `nut` that
    of the nut.
    """

    axial: float
    length: float
    sign: float
    span: float | None
    bearing: float
    nut: float

    def stiffness(self, coordinate: Array | float) -> Array:
        """Stiffness (N/m) at one or several coordinates (m) of the joint.

        1/k = L/EA + bearing + nut (ISO 3408-4), with the length L of the shaft between bearing and
        nut. If there are two bearings, the two parts of the shaft, each with its bearing, act in
        parallel. Raises ComputationError if the nut is beyond a bearing.
        """
        length = np.asarray(self.length + self.sign * np.asarray(coordinate))
        lengths = [length] if self.span is None else [length, self.span - length]
        shortest = float(min(part.min() for part in lengths))
        if shortest < 0.0:
            raise ComputationError(
                f"the nut is {-1e3 * shortest:.4g} mm beyond a bearing of its shaft; must be "
                "between the bearing and the shaft's other end"
            )
        shaft = np.sum([1.0 / (part / self.axial + self.bearing) for part in lengths], axis=0)
        return np.asarray(1.0 / (1.0 / shaft + self.nut))


@dataclass(frozen=True)
class Drive:
    """Actuator of a joint, with a stiffness along the joint's free twist.

    `stiffness` is in N/m or N m/rad. None if the drive is rigid. `simplified` is the stiffness in
    the simplified model (rigid bodies on elastic drives). None if it is equal to `stiffness`.
    `loss` is the loss factor of both stiffnesses. `inertia` (kg or kg m²) is the inertia of the
    rotor times the square of the gear ratio. It moves with the elastic deflection of the drive.
    `damping` (N s/m or N m s/rad) is the constant of a viscous dashpot parallel to the stiffness.
    The stiffness of a drive with a ball `screw` depends on the posture, and `stiffness` is its
    value in the reference posture.
    """

    stiffness: float | None = None
    simplified: float | None = None
    loss: float = 0.0
    inertia: float = 0.0
    damping: float = 0.0
    screw: BallScrew | None = None

    def at(self, coordinate: float) -> "Drive":
        """Drive with its stiffness at `coordinate` (m) of the joint."""
        if self.screw is None:
            return self
        return replace(self, stiffness=float(self.screw.stiffness(coordinate)), screw=None)


@dataclass(frozen=True, eq=False)
class Joint:
    """A joint between two interfaces.

    `axes` (n×3) are unit vectors in base axes of the reference posture. Revolute, prismatic,
    cylindrical and planar joints have one; for a planar joint it is the normal of the plane. A
    universal joint has two, the first fixed in the first body and the second in the second body.
    Fixed and spherical joints have none. The interfaces may be apart along the axis of a prismatic
    or cylindrical joint.

    `compliance` (6×6, SI) acts in series with the free twists and has the loss factor `loss`. It is
    given in base axes of the reference posture and rotates with the first body. It is zero in
    directions in which the joint is rigid. None if the joint is rigid in all directions. `damping`
    (6×6, in N s/m and N m s/rad, same axes) is the matrix of viscous dashpots between the two
    bodies, parallel to the free twists and the compliance. None if there are no dashpots. Raises
    InputError if the axes do not fit the kind of joint.
    """

    name: str
    kind: JointKind
    first: Side
    second: Side
    axes: Array
    drive: Drive | None = None
    compliance: Array | None = None
    loss: float = 0.0
    damping: Array | None = None

    def __post_init__(self) -> None:
        if faults := self._faults():
            raise InputError(f"joint {self.name}: {fault}" for fault in faults)

    def _faults(self) -> list[str]:
        """Faults of the axes (number, length, parallel), and of the shapes of both matrices."""
        count = AXES[self.kind]
        if np.shape(self.axes) != (count, 3):
            shape = "×".join(map(str, np.shape(self.axes)))
            return [f"axes {shape}: a {self.kind} joint has {count}×3"]
        lengths = np.linalg.norm(self.axes, axis=1)
        faults = [
            f"axis {number} has length {length:.6g}: must be a unit vector"
            for number, length in enumerate(lengths, start=1)
            if not abs(length - 1.0) <= _UNIT
        ]
        if not faults and count > 1 and np.linalg.norm(np.cross(*self.axes)) < SMALLEST_SINE:
            faults.append("axes are parallel: the joint would turn about one axis only")
        for name, matrix in (("compliance", self.compliance), ("damping", self.damping)):
            if matrix is not None and np.shape(matrix) != (6, 6):
                faults.append(f"{name} must be 6×6")
        return faults
