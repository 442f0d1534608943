"""Bodies of a mechanism: shapes, frames and interfaces.

A part is a body whose geometry is a CAD file or a mesh, with interfaces on selected faces.
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
    """Selection of faces by their numbers, as printed by `flexproof faces`."""

    faces: tuple[int, ...]


@dataclass(frozen=True)
class ByName:
    """Selection of faces by a name in the file: a physical group, or a label of the CAD system."""

    name: str


@dataclass(frozen=True)
class ByCylinder:
    """Selection of the faces on one cylinder, a bore or a boss. Lengths are in m.

    The cylinder has the given `radius`. Its axis is parallel to `axis` (axes of the file) and
    passes through `point`. The radius and the position may differ by `tolerance` from those of the
    faces. If `axis` is None, any direction is accepted. If `point` is None, it is the point of the
    interface. If `tolerance` is None, it is a fraction of the radius.
    """

    radius: float
    axis: Triple | None = None
    point: Triple | None = None
    tolerance: float | None = None


@dataclass(frozen=True)
class ByPlane:
    """Selection of the faces in one plane with the outward normal `normal` (axes of the file).

    The plane contains `point` (m) within `tolerance` (m). If `point` is None, it is the point of
    the interface. If `tolerance` is None, a default is used.
    """

    normal: Triple
    point: Triple | None = None
    tolerance: float | None = None


Selection: TypeAlias = ByFaces | ByName | ByCylinder | ByPlane


@dataclass(frozen=True)
class PartInterface:
    """Faces of a part to which a joint is attached, and their coupling to the interface.

    The interface has six motions (three translations and three rotations). With `coupling` "rigid"
    the faces follow these motions as a rigid body. With "average" the area-weighted mean motion of
    the faces follows them, and the faces may deform. With "pin" only the radial motion of a bore
    follows them, and the bore can slide along its axis and about it. None if the robot file does
    not specify the coupling.
    """

    selection: Selection
    coupling: Coupling | None = None


@dataclass(frozen=True, eq=False)
class Part:
    """A solid body from a STEP, BREP or mesh `file`. Body axes are the axes of the file, in metres.

    `material` is isotropic. The keys of `interfaces` are the names of their points. `unit` is the
    unit of length of a file that does not specify one. `unknowns` is the number of unknowns of the
    finest mesh. If it is None, a default is used.
    """

    file: Path
    material: Material
    interfaces: Mapping[str, PartInterface]
    unit: LengthUnit | None = None
    unknowns: int | None = None


@dataclass(frozen=True, eq=False)
class Frame:
    """Frame of a body or of an interface: its origin and its axes, expressed in a parent frame.

    `position` (3, in m) is the origin. The columns of `rotation` (3×3) are the axes. The parent of
    a body's frame is the base frame, and the parent of an interface's frame is that of its body.
    """

    position: Array = field(default_factory=lambda: np.zeros(3))
    rotation: Array = field(default_factory=lambda: np.eye(3))

    def __matmul__(self, inner: "Frame") -> "Frame":
        """Compose two frames: express `inner`, given in this frame, in the parent of this frame."""
        return Frame(self.position + self.rotation @ inner.position, self.rotation @ inner.rotation)

    def inverse(self) -> "Frame":
        """The parent frame expressed in this frame."""
        return Frame(-self.rotation.T @ self.position, self.rotation.T)


@dataclass(frozen=True, eq=False)
class Rigid:
    """Rigid body, in body axes.

    `mass` is in kg. `centre` (3, in m) is the mass centre. `inertia` (3×3, in kg m²) is about the
    mass centre.
    """

    mass: float = 0.0
    centre: Array = field(default_factory=lambda: np.zeros(3))
    inertia: Array = field(default_factory=lambda: np.zeros((3, 3)))


Shape: TypeAlias = Leg | Part | Rigid


@dataclass(frozen=True, eq=False)
class Body:
    """A body of a mechanism: its shape, and the frames of its interfaces by name of their point.

    A leg has two interfaces: the root at the origin of the body axes and the tip at x = `length`. A
    part or a rigid body has any number. `loss` is the loss factor of the body's stiffness.
    """

    name: str
    shape: Shape
    interfaces: Mapping[str, Frame]
    loss: float = 0.0
