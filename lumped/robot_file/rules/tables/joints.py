"""Table [joints]: joints between bodies with their drives, bearings, guides and dashpots."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Literal, TypeAlias, get_args

from lumped.arrays import Array
from lumped.mechanism.catalogue.ball_contact import SIZES, Arrangement
from lumped.mechanism.catalogue.ball_guide import CARRIAGES, Lines, PreloadClass
from lumped.mechanism.catalogue.ball_nut import FIXED_BEARINGS, NUTS
from lumped.mechanism.catalogue.directions import DIRECTIONS, Direction
from lumped.mechanism.joint import JointKind
from lumped.robot_file.rules.rule import (
    Either,
    Key,
    Number,
    OneOf,
    Rule,
    Several,
    TableRule,
    Value,
    table_of,
)
from lumped.robot_file.rules.tables.bodies import Copies
from lumped.robot_file.rules.tables.values import (
    BODY_NAME,
    COMPLIANCE,
    DIAMOND,
    DIRECTION,
    IN_GPA,
    LENGTH,
    LOSS,
    POINT_NAME,
    SHARE,
    Spring,
    Triple,
)

_RIGID = OneOf(("rigid",))
# 1e15 is stiffer than any drive. A larger number would only increase round-off.
_STIFFEST = 'more than any drive has; "rigid" holds it'
# 1e-12 N m/rad is a thousandth of the softest silicon hinges.
_STIFFNESS = Number("N/m or N m/rad", above=0.0, most=1e15, high=_STIFFEST, slip=1e-12)
# 1e4 kg m² is a flywheel of two metres, 1e-18 kg m² a silicon cube of 30 µm. 1e6 rad/m is a screw
# of 6 µm pitch, 1e-6 is the reciprocal.
_ROTOR = Number("kg m²", above=0.0, most=1e4, high="is this in g cm²?", slip=1e-18)
_RATIO = Number("rad/rad or rad/m", above=0.0, most=1e6, slip=1e-6)
# 1e9 N s/m: holds a tonne to a micrometre per second.
_DRIVE_DASHPOT = Number("N s/m or N m s/rad", above=0.0, most=1e9, slip=1e-12)
# 1 GPa to above steel; a screw of aluminium has 7e10.
_SCREW_MODULUS = Number("Pa", least=1e9, most=2e12, low=IN_GPA, high=DIAMOND)
_SCREW_STIFFNESS = Number("N/m", above=0.0, most=1e15, slip=1e-12)
_SCREW_SPRING = Either(_SCREW_STIFFNESS, _RIGID)
_FORCE = Number("N", above=0.0, most=1e7, slip=1e-6)
_GROOVE = Number(above=0.5, most=0.6)


class _Axes(Several):
    """Rule for the key `axes` of a universal joint. Joints with one axis have the key `axis`."""

    def refused(self, value: object, key: str) -> str:
        return f"{super().refused(value, key)}; a joint of one axis has axis = [x, y, z]"


@dataclass(frozen=True, kw_only=True)
class NutEntry:
    """Catalogue data of the nut of a ball screw, with the load under which its stiffness is needed.

    The data are given by the built-in `size`, or by `rigidity`, `load_rating` and `share`. A nut
    without play has the key `preload`, a nut with play the key `load`.
    """

    size: Annotated[
        str | None, Value(OneOf(tuple(NUTS)), "designation of a nut whose table is built in")
    ] = None
    rigidity: Annotated[
        float | None, Value(_SCREW_STIFFNESS, "K of the nut's table, without `size`")
    ] = None
    load_rating: Annotated[
        float | None, Value(_FORCE, "basic dynamic load rating Ca of the table, without `size`")
    ] = None
    preload: Annotated[float | None, Value(_FORCE, "axial preload of the nut")] = None
    load: Annotated[
        float | None, Value(_FORCE, "axial load of a nut with play, instead of `preload`")
    ] = None
    share: Annotated[
        float | None,
        Value(SHARE, "load of K in the table / Ca; default 0.1 with preload, 0.3 with play"),
    ] = None


@dataclass(frozen=True, kw_only=True)
class ScrewEntry:
    """Ball screw of a prismatic joint."""

    diameter: Annotated[
        float | None,
        Value(LENGTH, "root diameter of the shaft, which carries tension, without `nut.size`"),
    ] = None
    length: Annotated[
        float, Value(LENGTH, "from the bearing that holds the shaft to the nut, as drawn")
    ]
    nut: Annotated[
        Spring | NutEntry,
        Value(
            Either(_SCREW_SPRING, table_of(NutEntry)),
            "axial stiffness of the nut, or its table",
        ),
    ]
    bearing: Annotated[
        float | str,
        Value(
            Either(_SCREW_STIFFNESS, OneOf(("rigid", *FIXED_BEARINGS))),
            "axial stiffness or designation of the bearing, of each if there are two",
        ),
    ]
    span: Annotated[
        float | None,
        Value(LENGTH, "distance of a second bearing that holds the shaft; default: none"),
    ] = None
    positive: Annotated[
        Literal["longer", "shorter"],
        Value(
            OneOf(("longer", "shorter")),
            "effect of a positive motion on the length",
        ),
    ] = "longer"
    E: Annotated[float, Value(_SCREW_MODULUS, "Young's modulus of the shaft")] = 2.06e11


@dataclass(frozen=True, kw_only=True)
class DriveEntry:
    """Drive of a revolute or prismatic joint, with a `stiffness` or a ball `screw`."""

    stiffness: Annotated[
        Spring | None,
        Value(Either(_STIFFNESS, _RIGID), "stiffness in every model; required without `screw`"),
    ] = None
    screw: Annotated[
        ScrewEntry | None,
        Value(table_of(ScrewEntry), "ball screw of a prismatic joint, instead of `stiffness`"),
    ] = None
    simplified: Annotated[
        float | None, Value(_STIFFNESS, "stiffness in the simplified model, if different")
    ] = None
    loss: Annotated[float, Value(LOSS, "loss factor of the stiffness")] = 0.0
    damping: Annotated[
        float, Value(_DRIVE_DASHPOT, "viscous dashpot parallel to the stiffness")
    ] = 0.0
    inertia: Annotated[
        float | None, Value(_ROTOR, "inertia of the rotor; a linear motor has kg")
    ] = None
    ratio: Annotated[
        float | None,
        Value(_RATIO, "gear ratio: rotor turns per joint turn, or rad per m; default 1"),
    ] = None


def _direction_keys() -> Iterator[tuple[str, Direction, str]]:
    """Name of each direction of a joint, the direction, and the kinds of joints that have it."""
    names = dict.fromkeys(name for directions in DIRECTIONS.values() for name in directions)
    for name in names:
        kinds = [kind for kind, directions in DIRECTIONS.items() if name in directions]
        yield name, DIRECTIONS[kinds[0]][name], ", ".join(kinds)


def _given(**values: Spring | None) -> Mapping[str, Spring]:
    """Values along directions of a joint, by the names of the directions, without None."""
    return {name: value for name, value in values.items() if value is not None}


def _along_directions(rules: tuple[Rule, Rule], *, free: bool) -> TableRule:
    """Rule for a table of numbers along named directions of joints, such as stiffnesses.

    `rules` are the rules for numbers along translations and along rotations. `free` is True if the
    table includes the directions along which the joint can move.
    """
    return TableRule(
        _given,
        *(
            Key(name, rules[direction.turns], kinds)
            for name, direction, kinds in _direction_keys()
            if free or not direction.free
        ),
    )


_STIFF = 'more than any joint has; "rigid" holds it'
_JOINT_STIFFNESS = _along_directions(
    (
        Either(Number("N/m", above=0.0, most=1e15, high=_STIFF, slip=1e-12), _RIGID),
        Either(Number("N m/rad", above=0.0, most=1e15, high=_STIFF, slip=1e-12), _RIGID),
    ),
    free=False,
)
_JOINT_DAMPING = _along_directions(
    (
        Number("N s/m", above=0.0, most=1e9, slip=1e-12),
        Number("N m s/rad", above=0.0, most=1e9, slip=1e-12),
    ),
    free=True,
)


@dataclass(frozen=True, kw_only=True)
class BearingEntry:
    """Preloaded ball bearing: the geometry of a row, the preload, and the arrangement of the rows.

    The geometry is given by a published `size`, or by the numbers from `balls` to `outer_groove`.
    Lengths are in m, angles in degrees.
    """

    size: Annotated[
        str | None,
        Value(OneOf(tuple(SIZES)), "designation of a bearing whose inside is published"),
    ] = None
    balls: Annotated[
        int | None,
        Value(Number(least=3, most=200, whole=True), "number of balls of a row, without `size`"),
    ] = None
    ball_diameter: Annotated[float | None, Value(LENGTH, "diameter of the balls")] = None
    pitch_diameter: Annotated[
        float | None, Value(LENGTH, "diameter of the circle of their centres")
    ] = None
    contact_angle: Annotated[
        float | None, Value(Number("°", least=0.0, most=75.0), "contact angle without load")
    ] = None
    inner_groove: Annotated[
        float | None, Value(_GROOVE, "radius of the inner groove / ball diameter; default 0.52")
    ] = None
    outer_groove: Annotated[
        float | None, Value(_GROOVE, "radius of the outer groove / ball diameter; default 0.53")
    ] = None
    preload: Annotated[float, Value(_FORCE, "axial preload of each row")]
    rows: Annotated[
        int, Value(Number(least=1, most=20, whole=True), "number of rows along the axis")
    ] = 1
    distance: Annotated[
        float | None, Value(LENGTH, "distance of neighbouring rows; required for several")
    ] = None
    arrangement: Annotated[
        Arrangement, Value(OneOf(get_args(Arrangement)), "arrangement of several rows")
    ] = "O"


@dataclass(frozen=True, kw_only=True)
class GuideEntry:
    """Carriage of a profile rail guide: a built-in `size`, or the geometry of its rows of balls.

    The geometry is given by the numbers from `balls` to `lines`. Lengths are in m, angles in
    degrees. `preload` is a class for a `size`, otherwise a force in N.
    """

    size: Annotated[
        str | None, Value(OneOf(tuple(CARRIAGES)), "size of a carriage whose table is built in")
    ] = None
    balls: Annotated[
        int | None,
        Value(
            Number(least=2, most=200, whole=True), "number of loaded balls of a row, without `size`"
        ),
    ] = None
    ball_diameter: Annotated[float | None, Value(LENGTH, "diameter of the balls")] = None
    spacing: Annotated[float | None, Value(LENGTH, "distance of neighbouring balls")] = None
    width: Annotated[float | None, Value(LENGTH, "distance of the rows along lateral")] = None
    height: Annotated[float | None, Value(LENGTH, "distance of the rows along normal")] = None
    contact_angle: Annotated[
        float | None, Value(Number("°", above=0.0, below=90.0), "angle to lateral; default 45")
    ] = None
    groove: Annotated[
        float | None, Value(_GROOVE, "radius of the grooves / ball diameter; default 0.52")
    ] = None
    lines: Annotated[
        Lines | None,
        Value(OneOf(get_args(Lines)), "contact lines meet outside (O, default) or inside"),
    ] = None
    preload: Annotated[
        float | PreloadClass,
        Value(
            Either(_FORCE, OneOf(get_args(PreloadClass))),
            "preload of upper on lower rows; a class with `size`",
        ),
    ]


# Numbers along directions of a joint, by the names of the directions.
AlongDirections: TypeAlias = Mapping[str, Spring]
_SERIES = "compliance in series; base axes of the reference posture, turning with the first body"
_CATALOGUE = "instead of `compliance`: stiffness along directions of the joint, each required"
_DASHPOTS = "viscous dashpots along directions of the joint, free ones included"
_JOINT_UP = "direction of a slide's normal; of the axis of a fixed or spherical joint"
_AXES = "universal: axis fixed in the first body, axis fixed in the second"
_AT = "common point, or one of each body along a sliding axis"


@dataclass(frozen=True, kw_only=True)
class JointEntry:
    """Joint between two bodies."""

    type: Annotated[JointKind, Value(OneOf(get_args(JointKind)), "kind of joint")]
    between: Annotated[tuple[str, str], Value(Several(BODY_NAME, 2), 'two bodies; "ground" is one')]
    at: Annotated[str | tuple[str, str], Value(Either(POINT_NAME, Several(POINT_NAME, 2)), _AT)]
    axis: Annotated[
        Triple | None, Value(DIRECTION, "axis of sliding or turning; planar: the normal")
    ] = None
    axes: Annotated[tuple[Triple, Triple] | None, Value(_Axes(DIRECTION, 2), _AXES)] = None
    drive: Annotated[
        DriveEntry | None,
        Value(table_of(DriveEntry), "drive of a revolute or prismatic joint; default: passive"),
    ] = None
    compliance: Annotated[Array | None, Value(COMPLIANCE, _SERIES)] = None
    stiffness: Annotated[AlongDirections | None, Value(_JOINT_STIFFNESS, _CATALOGUE)] = None
    bearing: Annotated[
        BearingEntry | None,
        Value(
            table_of(BearingEntry),
            "instead of both: preloaded ball bearing of a revolute joint",
        ),
    ] = None
    guide: Annotated[
        GuideEntry | None,
        Value(
            table_of(GuideEntry),
            "instead of all: carriage of a prismatic joint on four rows of balls",
        ),
    ] = None
    damping: Annotated[Mapping[str, float] | None, Value(_JOINT_DAMPING, _DASHPOTS)] = None
    up: Annotated[Triple | None, Value(DIRECTION, _JOINT_UP)] = None
    loss: Annotated[float, Value(LOSS, "loss factor of the compliance or stiffness")] = 0.0
    pattern: Copies = None


JOINT = table_of(JointEntry)
