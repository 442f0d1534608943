"""Interfaces of a CAD part as they are typed: which faces, which coupling, which point."""

from typing import Annotated, TypeAlias

from msgspec import Meta

from lumped.mechanism.part import (
    ByCylinder,
    ByFaces,
    ByName,
    ByPlane,
    Coupling,
    PartInterface,
    Selection,
)
from lumped.robot_file.tables import Length, Table, Text, number

# 100 m: beyond any robot with rigid legs, below one of 10 cm written in millimetres.
Coordinate: TypeAlias = Annotated[
    float,
    Meta(ge=-100.0, le=100.0, extra=number("m", "is this in mm?", "is this in mm?")),
]
Point: TypeAlias = tuple[Coordinate, Coordinate, Coordinate]
# Any length: a direction is made a unit vector.
Component: TypeAlias = Annotated[float, Meta(ge=-1e6, le=1e6)]
Direction: TypeAlias = tuple[Component, Component, Component]

_CHOICES = ("faces", "name", "cylinder", "plane")


class CylinderTable(Table, frozen=True):
    """`cylinder`: the bore or boss of that `radius` (m), its axis through the point or `point`."""

    radius: Length
    axis: Direction | None = None
    point: Point | None = None
    tolerance: Length | None = None


class PlaneTable(Table, frozen=True):
    """`plane`: the flat faces of that outward `normal` through the point or `point` (m)."""

    normal: Direction
    point: Point | None = None
    tolerance: Length | None = None


class InterfaceTable(Table, frozen=True):
    """An interface of a CAD part: its faces in one of four ways, and how they are held.

    `point`: its reference point (m, the file's axes) where it has no name of a point in a robot.
    """

    faces: list[int] | None = None
    name: Text | None = None
    cylinder: CylinderTable | None = None
    plane: PlaneTable | None = None
    coupling: Coupling | None = None
    point: Point | None = None


def choice_faults(table: InterfaceTable, key: str) -> list[str]:
    """The fault of an interface whose faces are said in no way or in several."""
    given = [choice for choice in _CHOICES if getattr(table, choice) is not None]
    if len(given) == 1:
        return []
    said = f"has {' and '.join(given)}" if given else "does not say which faces"
    return [f"{key}: {said}; must have one of {', '.join(_CHOICES)}"]


def interface_of(table: InterfaceTable) -> PartInterface:
    """The interface of a table without faults."""
    chosen: Selection
    if table.cylinder is not None:
        cylinder = table.cylinder
        chosen = ByCylinder(cylinder.radius, cylinder.axis, cylinder.point, cylinder.tolerance)
    elif table.plane is not None:
        chosen = ByPlane(table.plane.normal, table.plane.point, table.plane.tolerance)
    elif table.name is not None:
        chosen = ByName(table.name)
    else:
        chosen = ByFaces(tuple(table.faces or ()))
    return PartInterface(chosen, table.coupling)
