"""Rules for whole robot files of schema 1 (biglide) and schema 2 (any mechanism)."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Annotated, Any, Literal, TypeAlias

from lumped.arrays import Array
from lumped.mechanism.length_unit import LENGTH_UNITS, METRE, UnitOfLength
from lumped.mechanism.mechanism import MOVES, Tool
from lumped.memo import memo
from lumped.model_choices import Ends
from lumped.robot_file.rules.rule import (
    Key,
    Named,
    Number,
    OneOf,
    Several,
    TableRule,
    Value,
    needed,
    table_of,
)
from lumped.robot_file.rules.tables.bodies import (
    BODY,
    PATTERN,
    POINT_OR_COPIES,
    BodyEntry,
    PatternEntry,
    RepeatedPointEntry,
)
from lumped.robot_file.rules.tables.joints import JOINT, JointEntry
from lumped.robot_file.rules.tables.requests import (
    Accept,
    Agree,
    Damping,
    Hammer,
    InputUncertainties,
    Loads,
    MeasuredValues,
    Responses,
)
from lumped.robot_file.rules.tables.sections import MATERIAL, MaterialEntry, OwnMaterials
from lumped.robot_file.rules.tables.values import (
    BODY_NAME,
    COMPLIANCE,
    COUNT,
    IN_PERCENT,
    INERTIA,
    LENGTH,
    LOSS,
    MASS,
    MASS_OR_NONE,
    MOST_BODIES,
    MOST_JOINTS,
    MOST_POSES,
    NAME,
    NUMBER,
    OFFSET,
    POINT_NAME,
    POSE,
    TEXT,
    TITLE,
    Triple,
)
from lumped.sections import Section

TOOL = TableRule(
    Tool,
    needed("body", BODY_NAME, "body that carries the tool"),
    needed("point", POINT_NAME, "loaded point of that body"),
    needed(
        "moves", Several(OneOf(MOVES)), "coordinates of the point that a pose prescribes, in order"
    ),
    Key("mass", MASS_OR_NONE, "point mass at the tool", default=0.0),
)


@dataclass(frozen=True, kw_only=True)
class PathEntry:
    """Poses in which `run` evaluates the robot (table [path]): a line, a grid or a list."""

    from_: Annotated[tuple[float, ...] | None, Value(POSE, "first pose")] = None
    to: Annotated[tuple[float, ...] | None, Value(POSE, "last pose")] = None
    count: Annotated[int | None, Value(COUNT, "number of poses from `from` to `to`")] = None
    counts: Annotated[
        tuple[int, ...] | None,
        Value(Several(COUNT), "instead of `count`: number of poses along each move, a grid"),
    ] = None
    poses: Annotated[
        tuple[tuple[float, ...], ...] | None,
        Value(Several(POSE, most=MOST_POSES), "instead of all these: a list of poses"),
    ] = None


Schema: TypeAlias = Annotated[
    Literal[1, 2], Value(OneOf((1, 2)), "version of the format: 2, or 1 for a biglide")
]
Name: TypeAlias = Annotated[str, Value(TITLE, "name in the report")]
Units: TypeAlias = Annotated[
    str,
    Value(
        OneOf(tuple(LENGTH_UNITS)),
        "unit of lengths: with mm, every value listed in m is in mm; all else stays",
    ),
]


@dataclass(frozen=True, kw_only=True)
class MechanismEntry:
    """Robot file of schema 2: any mechanism.

    In the record of a file, copies of entries with a pattern are entries of their own.
    """

    schema: Schema
    name: Name
    units: Units = METRE.name
    points: Annotated[
        Mapping[str, Triple | RepeatedPointEntry],
        Value(Named(NAME, POINT_OR_COPIES), "points in the reference posture"),
    ]
    bodies: Annotated[
        Mapping[str, BodyEntry],
        Value(Named(NAME, BODY, MOST_BODIES), "legs, rigid bodies and CAD parts"),
    ]
    joints: Annotated[
        Mapping[str, JointEntry], Value(Named(NAME, JOINT, MOST_JOINTS), "joints between bodies")
    ]
    tool: Annotated[Tool, Value(TOOL, "the loaded point")]
    patterns: Annotated[
        Mapping[str, PatternEntry], Value(Named(NAME, PATTERN), "patterns of copies by name")
    ] = field(default_factory=dict)
    materials: Annotated[
        Mapping[str, MaterialEntry], Value(Named(NAME, MATERIAL), "materials by name")
    ] = field(default_factory=dict)
    path: Annotated[
        PathEntry | None,
        Value(table_of(PathEntry), "poses of `run`; default: the reference posture"),
    ] = None
    loads: Loads = ()
    damping: Damping = None
    responses: Responses = ()
    accept: Accept = None
    agree: Agree = None
    measured: MeasuredValues = ()
    hammer: Hammer = None
    input_uncertainty: InputUncertainties = ()


MECHANISM = table_of(MechanismEntry)

# Coordinates of a pose of the biglide.
_BIGLIDE_MOVES = ("x",)
# Schema 1, the biglide: contents of schema 2 under other names, and three more numbers. Legs ten
# times as long are outside any family of one design.
_RATIO = Number(above=0.0, most=10.0, high=IN_PERCENT)
# With 1e4 N/m the paper's force of 1000 N displaces the drive by 0.1 m, too much for any drive.
_ACTUATOR_STIFFNESS = Number(
    "N/m",
    least=1e4,
    most=1e15,
    low="is this in N/µm or kN/mm?",
    high="more than any drive has; 1e15 is as good as rigid",
)


def _of_leg(name: str) -> Value:
    """Rule and meaning of the key `name`, which a leg of the biglide shares with other bodies."""
    key = BODY.keys[name]
    return Value(key.kind, key.meaning)


@dataclass(frozen=True, kw_only=True)
class BiglideLegEntry:
    """Leg of the biglide (tables [leg1] and [leg2])."""

    length: Annotated[float, Value(LENGTH, "distance between its joints")]
    mass: Annotated[float | None, Value(MASS, "mass; replaces a density")] = None
    material: Annotated[MaterialEntry | None, Value(MATERIAL, "material of the section")] = None
    ends: Annotated[Ends | None, _of_leg("ends")] = None
    compliance: Annotated[Array | None, _of_leg("compliance")] = None
    loss: Annotated[float | None, _of_leg("loss")] = None
    section: Annotated[Section | OwnMaterials | None, _of_leg("section")] = None
    inertia: Annotated[Array | None, _of_leg("inertia")] = None
    mass_centre: Annotated[float | None, _of_leg("mass_centre")] = None


@dataclass(frozen=True, kw_only=True)
class GeometryEntry:
    """Geometry of the biglide's slides and tool (table [geometry])."""

    a: Annotated[float, Value(LENGTH, "distance between the slides along x")]
    alpha: Annotated[float, Value(_RATIO, "factor on both lengths at the same stroke")] = 1.0
    tool_offset: Annotated[
        Triple, Value(Several(OFFSET, 3), "vector from B to the loaded point")
    ] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class PlatformEntry:
    """Platform of the biglide (table [platform]), which is a point mass."""

    mass: Annotated[float, Value(MASS, "mass at the loaded point")]


@dataclass(frozen=True, kw_only=True)
class ActuatorsEntry:
    """Drives of the biglide in the simplified model (table [actuators])."""

    stiffness: Annotated[float, Value(_ACTUATOR_STIFFNESS, "stiffness along y")]
    loss: Annotated[float, Value(LOSS, "loss factor")] = 0.0


@dataclass(frozen=True, kw_only=True)
class FootEntry:
    """Elastic feet of both legs of the biglide (table [foot])."""

    compliance: Annotated[Array, Value(COMPLIANCE, "compliance at the revolute joint, robot axes")]
    loss: Annotated[float, Value(LOSS, "loss factor")] = 0.0
    inertia: Annotated[Array | None, Value(INERTIA, "used by the audit alone")] = None


@dataclass(frozen=True, kw_only=True)
class SpringEntry:
    """Spring between platform and tool of the biglide (table [tool])."""

    compliance: Annotated[
        Array, Value(COMPLIANCE, "compliance in series at the loaded point, robot axes")
    ]
    loss: Annotated[float, Value(LOSS, "loss factor")] = 0.0
    active: Annotated[bool, Value(OneOf((True, False)), "false: recorded, not used")] = True


@dataclass(frozen=True)
class Correction:
    """Corrected misprint in the source of the data (table [[corrections]]).

    The source has the value `printed` at `key`, the file the value `used`, for the given `reason`.
    """

    key: Annotated[str, Value(TEXT, "key that differs from the source")]
    printed: Annotated[float, Value(NUMBER, "value printed in the source")]
    used: Annotated[float, Value(NUMBER, "value in this file")]
    reason: Annotated[str, Value(TEXT, "reason of the correction")]


@dataclass(frozen=True, kw_only=True)
class BiglideEntry:
    """Robot file of schema 1: the biglide."""

    schema: Schema
    name: Name
    units: Units = METRE.name
    type: Annotated[
        Literal["biglide"],
        Value(OneOf(("biglide",)), "two slides along y, two legs that meet at B"),
    ]
    geometry: Annotated[
        GeometryEntry, Value(table_of(GeometryEntry), "geometry of slides and tool")
    ]
    platform: Annotated[PlatformEntry, Value(table_of(PlatformEntry), "carried by leg 1")]
    actuators: Annotated[
        ActuatorsEntry, Value(table_of(ActuatorsEntry), "drives of the simplified model")
    ]
    leg1: Annotated[
        BiglideLegEntry, Value(table_of(BiglideLegEntry), "leg from the slide on x = 0 to B")
    ]
    leg2: Annotated[
        BiglideLegEntry, Value(table_of(BiglideLegEntry), "leg from the slide on x = a to B")
    ]
    foot: Annotated[
        FootEntry | None, Value(table_of(FootEntry), "foot of both legs; default: rigid")
    ] = None
    tool: Annotated[
        SpringEntry | None, Value(table_of(SpringEntry), "spring at the tool; default: rigid")
    ] = None
    corrections: Annotated[
        tuple[Correction, ...],
        Value(Several(table_of(Correction)), "misprints of the source"),
    ] = ()
    loads: Loads = ()
    damping: Damping = None
    responses: Responses = ()
    accept: Accept = None
    agree: Agree = None
    measured: MeasuredValues = ()
    hammer: Hammer = None
    input_uncertainty: InputUncertainties = ()


BIGLIDE = table_of(BiglideEntry)
RobotEntry: TypeAlias = MechanismEntry | BiglideEntry


def rules_of(tables: Mapping[str, Any]) -> TableRule:
    """Rule for all tables of a file, according to its schema and its unit of length."""
    unit = length_unit_of(tables)
    rules = MECHANISM if is_mechanism(tables) else BIGLIDE
    return rules if unit == METRE else _in_unit(rules, unit, _moves_of(tables))


def is_mechanism(tables: Mapping[str, Any]) -> bool:
    """True if the tables of a file are those of schema 2."""
    schema = tables.get("schema")
    # True equals 1 in Python, but is not a number in the file.
    schema = None if isinstance(schema, bool) else schema
    # If the number is mistyped, the other tables show which schema is meant.
    any_robot = not tables.keys().isdisjoint(("points", "bodies", "joints"))
    return schema == 2 or (schema != 1 and any_robot)


def length_unit_of(tables: Mapping[str, Any]) -> UnitOfLength:
    """Unit of length of a file. It is the metre if the file has no unit or an invalid one."""
    name = tables.get("units")
    return LENGTH_UNITS.get(name, METRE) if isinstance(name, str) else METRE


def _moves_of(tables: Mapping[str, Any]) -> tuple[str, ...]:
    """Moves of the tool in the tables of a file. Empty if they have faults."""
    if not is_mechanism(tables):
        return _BIGLIDE_MOVES
    tool = tables.get("tool")
    moves = tool.get("moves") if isinstance(tool, dict) else None
    return () if TOOL.keys["moves"].kind.faults(moves, "") else tuple(moves or ())


@memo(16)
def _in_unit(rules: TableRule, unit: UnitOfLength, moves: tuple[str, ...]) -> TableRule:
    return rules.in_unit(unit, moves)
