"""Bodies of a mechanism: shapes, frames and interfaces.

A part is a body given by a CAD file or a mesh, with interfaces on selected faces.
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
    """Faces by their name in the file: a physical group, or a label of the CAD system."""

    name: str


@dataclass(frozen=True)
class ByCylinder:
    """Faces on one cylinder of `radius` (m), a bore or a boss. Lengths in m, axes of the file.

    Its axis has the direction `axis` (any direction if None) through `point` (the interface's own
    point if None), within `tolerance` (a fraction of the radius if None).
    """

    radius: float
    axis: Triple | None = None
    point: Triple | None = None
    tolerance: float | None = None


@dataclass(frozen=True)
class ByPlane:
    """Faces in one plane with the outward `normal`. `point`, `tolerance`: see `ByCylinder`."""

    normal: Triple
    point: Triple | None = None
    tolerance: float | None = None


Selection: TypeAlias = ByFaces | ByName | ByCylinder | ByPlane


@dataclass(frozen=True)
class PartInterface:
    """Faces of a part to which a joint is attached, and their coupling to its six motions.

    `coupling`: "rigid" (the faces move as one rigid body), "average" (area-weighted mean motion of
    the faces, which may deform), "pin" (bores: radially constrained, free to slide along and about
    the axis). None if the robot file does not specify it.
    """

    selection: Selection
    coupling: Coupling | None = None


@dataclass(frozen=True, eq=False)
class Part:
    """A solid from a STEP, BREP or mesh `file`. Body axes are the file's, in metres.

    `material` is isotropic. `interfaces` by the name of their point. `unit` is the length unit if
    the file has none. `unknowns` of the finest mesh; None for the default number.
    """

    file: Path
    material: Material
    interfaces: Mapping[str, PartInterface]
    unit: LengthUnit | None = None
    unknowns: int | None = None


@dataclass(frozen=True, eq=False)
class Frame:
    """Position (3, m) of an origin and rotation (3×3) with the axes as columns.

    Both are expressed in the parent frame: base axes for a body, axes of its body for an
    interface.
    """

    position: Array = field(default_factory=lambda: np.zeros(3))
    rotation: Array = field(default_factory=lambda: np.eye(3))

    def __matmul__(self, inner: "Frame") -> "Frame":
        """Compose two frames: `inner`, given in this frame, expressed in this frame's parent."""
        return Frame(self.position + self.rotation @ inner.position, self.rotation @ inner.rotation)

    def inverse(self) -> "Frame":
        """Parent frame, expressed in this frame."""
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

    A leg has two interfaces, the first at the origin of the body's axes, the second at `length`
    along x. A part and a rigid body have any number. `loss` is the loss factor of its stiffness.
    """

    name: str
    shape: Shape
    interfaces: Mapping[str, Frame]
    loss: float = 0.0
