"""Tables [bodies], [points] and [patterns]: legs, rigid bodies, CAD parts, and their copies."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Annotated, Literal, TypeAlias, get_args

from lumped.arrays import Array
from lumped.mechanism.body import ByCylinder, ByPlane, Coupling, LengthUnit
from lumped.model_choices import Ends
from lumped.robot_file.rules.rule import (
    Either,
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
from lumped.robot_file.rules.tables.sections import (
    MATERIAL_OR_NAME,
    MaterialEntry,
    OwnMaterials,
    SectionRule,
    Station,
    StationRule,
)
from lumped.robot_file.rules.tables.values import (
    COMPLIANCE,
    DIRECTION,
    FILE,
    INERTIA,
    LENGTH,
    LOSS,
    MASS_OR_NONE,
    NAME,
    OFFSET,
    POINT,
    POINT_NAME,
    TEXT,
    Place,
    Triple,
)
from lumped.sections import Section


def cylinder_table(point: Key) -> TableRule:
    """Rule for a table that selects the faces of a part on a cylinder.

    `point` is the key for a point on the axis of the cylinder.
    """
    return TableRule(
        ByCylinder,
        needed("radius", LENGTH, "radius of the bore or boss"),
        Key("axis", DIRECTION, "its direction; default: any"),
        point,
        _NEAR,
    )


def plane_table(point: Key) -> TableRule:
    """Rule for a table that selects the faces of a part in a plane.

    `point` is the key for a point in the plane.
    """
    return TableRule(ByPlane, needed("normal", DIRECTION, "outward normal"), point, _NEAR)


_NEAR = Key("tolerance", LENGTH, "largest distance of faces from it")
_ON_IT = Key("point", POINT, "a point on it; default: that of the interface")
FaceNumbers: TypeAlias = Annotated[
    tuple[int, ...] | None,
    Value(Several(Number(whole=True)), "numbers of faces, see `flexproof faces`"),
]
FaceName: TypeAlias = Annotated[str | None, Value(TEXT, "name of faces in the part's file")]
ON_CYLINDER, IN_PLANE = "all faces on a cylinder", "all flat faces in a plane"


@dataclass(frozen=True, kw_only=True)
class InterfaceEntry:
    """Interface of a CAD part: its faces and their coupling.

    Exactly one of `faces`, `name`, `cylinder` and `plane` selects the faces.
    """

    faces: FaceNumbers = None
    name: FaceName = None
    cylinder: Annotated[ByCylinder | None, Value(cylinder_table(_ON_IT), ON_CYLINDER)] = None
    plane: Annotated[ByPlane | None, Value(plane_table(_ON_IT), IN_PLANE)] = None
    coupling: Annotated[
        Coupling | None, Value(OneOf(get_args(Coupling)), "coupling of the faces to the joint")
    ] = None
    point: Annotated[
        Triple | None,
        Value(POINT, "reference point for `identify`; in a robot: the point of that name"),
    ] = None


INTERFACE = table_of(InterfaceEntry)
_PLACE = Either(POINT_NAME, POINT)


@dataclass(frozen=True, kw_only=True)
class PlacementEntry:
    """Position and directions of the axes of a CAD file in base axes."""

    at: Annotated[Place, Value(_PLACE, "origin of the file's axes")]
    x: Annotated[Triple, Value(DIRECTION, "direction of the file's x axis")] = (1.0, 0.0, 0.0)
    y: Annotated[Triple, Value(DIRECTION, "direction of its y axis, made normal to x")] = (
        0.0,
        1.0,
        0.0,
    )


@dataclass(frozen=True, kw_only=True)
class ArcEntry:
    """Point of a leg's centre line on the arc that joins the points before and after it."""

    arc: Annotated[Place, Value(_PLACE, "a point between two others, on the arc that joins them")]


@dataclass(frozen=True, kw_only=True)
class PatternEntry:
    """Rotational symmetry: `count` copies about an axis in the direction `about`.

    The axis passes through the point `through`.
    """

    about: Annotated[
        Literal["x", "y", "z"] | Triple,
        Value(Either(OneOf(("x", "y", "z")), DIRECTION), "axis of the symmetry"),
    ]
    count: Annotated[
        int, Value(Number(least=2, most=36, whole=True), "number of copies over a turn")
    ]
    through: Annotated[Place | None, Value(_PLACE, "point on the axis; default: the origin")] = None


PATTERN = table_of(PatternEntry)
_NAMED_PATTERN = Either(replace(NAME, among="patterns"), PATTERN)
Copies: TypeAlias = Annotated[
    PatternEntry | str | None, Value(_NAMED_PATTERN, "repeat as NAME1, NAME2, … about an axis")
]


@dataclass(frozen=True, kw_only=True)
class RepeatedPointEntry:
    """Point with copies about an axis, which are described by a pattern."""

    at: Annotated[Triple, Value(POINT, "point of the first copy")]
    pattern: Copies = None


POINT_OR_COPIES = Either(POINT, table_of(RepeatedPointEntry))
_LEG, _RIGID, _PART = ("leg",), ("rigid body",), ("part",)
_UP = "direction of z, made normal to x; default [0, 0, 1], for a leg along z [1, 0, 0]"
_SECTIONS = (
    "instead of `section`: sections along the line, sizes linear in between; two at one position "
    "are a step"
)
_THROUGH = "points of the centre line between `from` and `to`; default: a straight line"
_ENDS = "end faces kept plane (rigid) or free to warp; default: both are computed"
_TIP = "at `to` with `from` clamped, leg axes; replaces section and material, needs `mass`"
_BODY_LOSS = (
    "loss factor for a `compliance`, composite or laminate; other prisms: that of the material"
)
_BODY_INERTIA = "inertia about the mass centre; base axes, for a leg: leg axes"


@dataclass(frozen=True, kw_only=True)
class BodyEntry:
    """Body of a mechanism: a leg, a rigid body or a CAD part.

    Keys that belong to the other two kinds are None.
    """

    from_: Annotated[str | None, Value(POINT_NAME, "point at the root", _LEG)] = None
    to: Annotated[
        str | None, Value(POINT_NAME, "point at the tip; x points from root to tip", _LEG)
    ] = None
    up: Annotated[Triple | None, Value(DIRECTION, _UP, _LEG)] = None
    section: Annotated[
        Section | OwnMaterials | None,
        Value(
            SectionRule(), "cross-section about its centroid; width along y, height along z", _LEG
        ),
    ] = None
    sections: Annotated[
        tuple[Station, ...] | None,
        Value(Several(StationRule(), most=100, least=2), _SECTIONS, _LEG),
    ] = None
    through: Annotated[
        tuple[Place | ArcEntry, ...] | None,
        Value(Several(Either(_PLACE, table_of(ArcEntry)), most=100, least=1), _THROUGH, _LEG),
    ] = None
    material: Annotated[
        MaterialEntry | str | None,
        Value(MATERIAL_OR_NAME, "a name in [materials], or a table", _LEG + _PART),
    ] = None
    mass: Annotated[
        float | None, Value(MASS_OR_NONE, "mass; replaces a density", _LEG + _RIGID)
    ] = None
    compliance: Annotated[Array | None, Value(COMPLIANCE, _TIP, _LEG)] = None
    loss: Annotated[float | None, Value(LOSS, _BODY_LOSS, _LEG)] = None
    ends: Annotated[Ends | None, Value(OneOf(get_args(Ends)), _ENDS, _LEG)] = None
    mass_centre: Annotated[
        float | None,
        Value(OFFSET, "position of the mass centre along x, for a `compliance`", _LEG),
    ] = None
    points: Annotated[
        tuple[str, ...] | None,
        Value(Several(POINT_NAME), "points of the body, for joints and loads", _RIGID),
    ] = None
    centre: Annotated[Place | None, Value(_PLACE, "mass centre: a point or [x, y, z]", _RIGID)] = (
        None
    )
    inertia: Annotated[Array | None, Value(INERTIA, _BODY_INERTIA, _LEG + _RIGID)] = None
    step: Annotated[
        str | None, Value(FILE, "STEP or BREP file, relative to the robot file", _PART)
    ] = None
    mesh: Annotated[str | None, Value(FILE, "mesh file, instead of `step`", _PART)] = None
    unit: Annotated[
        LengthUnit | None,
        Value(OneOf(get_args(LengthUnit)), "unit of length, for files without one", _PART),
    ] = None
    place: Annotated[
        PlacementEntry | None,
        Value(table_of(PlacementEntry), "position of the file's axes; default: base axes", _PART),
    ] = None
    interfaces: Annotated[
        Mapping[str, InterfaceEntry] | None,
        Value(Named(POINT_NAME, INTERFACE), "interfaces by the name of their point", _PART),
    ] = None
    pattern: Copies = None


BODY = table_of(BodyEntry)
