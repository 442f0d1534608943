"""What a robot file of any mechanism may contain: its tables, keys, types, units and bounds."""

from typing import Annotated, Literal, TypeAlias

from msgspec import Meta, field

from lumped.legs import Ends
from lumped.mechanism.joint import JointKind
from lumped.mechanism.part import LengthUnit
from lumped.robot_file.mechanism.part_tables import Direction, InterfaceTable, Point
from lumped.robot_file.tables import (
    Accept,
    Compliance,
    Inertia,
    InputUncertainty,
    MaterialTable,
    MeasuredTable,
    Name,
    Offset,
    SectionTable,
    Table,
    Text,
    number,
)

Entry: TypeAlias = Annotated[
    str,
    Meta(
        pattern=r"^[\w-]{1,40}$",
        extra={"allowed": "1 to 40 letters, digits, _ or -"},
    ),
]
# 1e15: stiffer than any drive; a larger number would only cost digits.
DriveStiffness: TypeAlias = Annotated[
    float,
    Meta(
        gt=0.0,
        le=1e15,
        extra=number("N/m or N m/rad", "", 'more than any drive has; "rigid" holds it'),
    ),
]
# Metres and radians alike; what is out of reach is found by closing the loops.
PoseValue: TypeAlias = Annotated[
    float,
    Meta(ge=-100.0, le=100.0, extra=number("m or rad", "is this in mm?", "is this in mm?")),
]
LoadedMass: TypeAlias = Annotated[
    float, Meta(ge=0.0, le=1e5, extra=number("kg", "", "is this in g?"))
]
Move: TypeAlias = Literal["x", "y", "z", "phi_x", "phi_y", "phi_z"]
Count: TypeAlias = Annotated[
    int, Meta(ge=1, le=10000, extra={"allowed": "a whole number from 1 to 10000"})
]


class PlaceTable(Table, frozen=True):
    """`place` of a CAD part: where the file's origin lies and where its x and y axes point."""

    at: Entry | Point
    x: Direction = (1.0, 0.0, 0.0)
    y: Direction = (0.0, 1.0, 0.0)


class BodyTable(Table, frozen=True):
    """[bodies.NAME]: a leg (`from`, `to`), a rigid body (`points`) or a CAD part (`step`, `mesh`).

    A leg is given as in schema 1; `up` is where its z axis points as nearly as it can. `inertia`
    is about `centre` in base axes; of a leg about `mass_centre` (m from its root) in leg axes.
    """

    start: Entry | None = field(name="from", default=None)
    to: Entry | None = None
    up: Direction | None = None
    section: SectionTable | None = None
    material: Entry | MaterialTable | None = None
    mass: LoadedMass | None = None
    compliance: Compliance | None = None
    mass_centre: Offset | None = None
    points: list[Entry] | None = None
    centre: Entry | Point | None = None
    inertia: Inertia | None = None
    ends: Ends | None = None
    step: Text | None = None
    mesh: Text | None = None
    unit: LengthUnit | None = None
    place: PlaceTable | None = None
    interfaces: dict[Entry, InterfaceTable] | None = None


class DriveTable(Table, frozen=True):
    """`drive` of a joint: `stiffness` in every model, `simplified` in place of it in that one."""

    stiffness: DriveStiffness | Literal["rigid"]
    simplified: DriveStiffness | None = None


class JointTable(Table, frozen=True):
    """[joints.NAME]: `type` with `axis` or `axes`, the two bodies and `at` which point they meet.

    Two points are those of the first and of the second body, apart along the axis.
    """

    type: JointKind
    between: tuple[Entry, Entry]
    at: Entry | tuple[Entry, Entry]
    axis: Direction | None = None
    axes: tuple[Direction, Direction] | None = None
    drive: DriveTable | None = None
    compliance: Compliance | None = None


class ToolTable(Table, frozen=True):
    """[tool]: the loaded point, what a pose prescribes of it, a mass (kg) there."""

    body: Entry
    point: Entry
    moves: list[Move]
    mass: LoadedMass = 0.0


class PathTable(Table, frozen=True):
    """[path]: `from` a pose `to` another in `count` steps or a grid of `counts`; or `poses`."""

    start: list[PoseValue] | None = field(name="from", default=None)
    to: list[PoseValue] | None = None
    count: Count | None = None
    counts: list[Count] | None = None
    poses: list[list[PoseValue]] | None = None


class MechanismTables(Table, frozen=True):
    """A whole robot file of schema 2."""

    schema: Literal[1, 2]
    name: Name
    points: dict[Entry, Point]
    bodies: dict[Entry, BodyTable]
    joints: dict[Entry, JointTable]
    tool: ToolTable
    materials: dict[Entry, MaterialTable] = field(default_factory=dict)
    path: PathTable | None = None
    accept: Accept | None = None
    measured: list[MeasuredTable] = field(default_factory=list)
    input_uncertainty: list[InputUncertainty] = field(default_factory=list)
