"""Legs as they are: a CAD file or a mesh, and which of its faces others take hold of."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, TypeAlias

from lumped.legs import Material

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
    name of their point.
    """

    file: Path
    material: Material
    interfaces: Mapping[str, PartInterface]
    unit: LengthUnit | None = None
