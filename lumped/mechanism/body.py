"""Bodies of a mechanism and their frames: what they are made of, where others take hold of them.

A part is a body as it is: a CAD file or a mesh, and which of its faces others take hold of.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.legs import Leg, Material

Coupling: TypeAlias = Literal["rigid", "average", "pin"]
LengthUnit: TypeAlias = Literal["m", "mm", "cm", "inch"]
Triple: TypeAlias = tuple[float, float, float]

METRES: dict[str, float] = {"m": 1.0, "cm": 1e-2, "mm": 1e-3, "inch": 0.0254}


@dataclass(frozen=True)
class ByFaces:
    """Faces by their numbers, as `flexproof faces` prints them."""

    faces: tuple[int, ...]


@dataclass(frozen=True)
class ByName:
    """Faces by the name that the file gives them: a physical group, a label of the CAD system."""

    name: str


@dataclass(frozen=True)
class ByCylinder:
    """Faces on one cylinder of `radius` (m), a bore or a boss; lengths in m, the file's axes.

    Its axis runs along `axis` (any direction where None) through `point` (the interface's own
    point where None), within `tolerance` (a part of the radius where None).
    """

    radius: float
    axis: Triple | None = None
    point: Triple | None = None
    tolerance: float | None = None


@dataclass(frozen=True)
class ByPlane:
    """Faces in one plane with the outward `normal`, through `point` as for a cylinder."""

    normal: Triple
    point: Triple | None = None
    tolerance: float | None = None


Selection: TypeAlias = ByFaces | ByName | ByCylinder | ByPlane


@dataclass(frozen=True)
class PartInterface:
    """Which faces others take hold of, and how.

    `coupling`: "rigid" (the faces move as one rigid body), "average" (their area-weighted mean
    motion, the faces free to deform), "pin" (bores: held radially, free to slide along and about
    the axis); None where nobody said so.
    """

    selection: Selection
    coupling: Coupling | None = None


@dataclass(frozen=True, eq=False)
class Part:
    """A solid from a STEP, BREP or mesh `file`; body axes are the file's, in metres.

    `material` is isotropic; `unit` of length where the file itself names none; `interfaces` by the
    name of their point. `unknowns` of the finest of its meshes, where others than usual are wanted.
    """

    file: Path
    material: Material
    interfaces: Mapping[str, PartInterface]
    unit: LengthUnit | None = None
    unknowns: int | None = None


@dataclass(frozen=True, eq=False)
class Frame:
    """A place: `position` (3, m) of its origin and `rotation` (3×3), its axes as columns.

    Both are given in the frame that it is seen from: a body's frame in base axes, an interface's
    in the axes of its body.
    """

    position: Array = field(default_factory=lambda: np.zeros(3))
    rotation: Array = field(default_factory=lambda: np.eye(3))

    def __matmul__(self, inner: "Frame") -> "Frame":
        """A frame seen from this one, as it is seen from where this one is seen from."""
        return Frame(self.position + self.rotation @ inner.position, self.rotation @ inner.rotation)

    def inverse(self) -> "Frame":
        """Where this frame is seen from, as it is seen from this frame."""
        return Frame(-self.rotation.T @ self.position, self.rotation.T)


@dataclass(frozen=True, eq=False)
class Rigid:
    """Rigid body of `mass` (kg), `centre` (3, m) and `inertia` (3×3, kg m²) about it, body axes."""

    mass: float = 0.0
    centre: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))


Shape: TypeAlias = Leg | Part | Rigid


@dataclass(frozen=True, eq=False)
class Body:
    """A body: its shape, and its interfaces by the name of their point, in body axes.

    A leg has two interfaces, the first at the origin of the body's axes, the
    second at `length` along x; a part and a rigid body have any number. `loss` is the loss factor
    of its stiffness.
    """

    name: str
    shape: Shape
    interfaces: Mapping[str, Frame]
    loss: float = 0.0
