"""Rules of robot files: all keys with their allowed values and meanings.

Limits that only detect wrong units are wide: nothing that has been built lies outside, but the
usual mistakes do (millimetres, gigapascals, a stiffness in place of a compliance).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Self, get_args

from lumped.acceptance.quantities import MOST_MODES, UNIT_LOADS
from lumped.acceptance.requirement import (
    MODEL_KINDS,
    MOST_ELEMENTS,
    SMALLEST_MEASURED,
    SMALLEST_SHARE,
    AgreementLimits,
    Requirement,
    SolidEnds,
)
from lumped.legs import Ends
from lumped.mechanism.body import Coupling, LengthUnit
from lumped.mechanism.catalogue.ball_contact import SIZES, Arrangement
from lumped.mechanism.catalogue.ball_guide import Lines
from lumped.mechanism.catalogue.directions import DIRECTIONS, Direction
from lumped.mechanism.joint import JointKind
from lumped.mechanism.length_unit import COORDINATES, LENGTH_UNITS, METRE, UnitOfLength
from lumped.mechanism.mechanism import MOVES
from lumped.memo import memo
from lumped.robot_file.rules.matrices import SquareMatrix
from lumped.robot_file.rules.rule import (
    Either,
    Key,
    Named,
    Number,
    OneOf,
    Pose,
    Rule,
    Several,
    TableRule,
    Text,
    needed,
)
from lumped.robot_file.rules.several_materials import (
    CompositeTable,
    LaminateTable,
    OwnMaterials,
)
from lumped.sections import (
    SHAPES,
    Composite,
    Laminate,
    LaminateBox,
    LaminateTube,
    Section,
    SectionProperties,
)
from lumped.text import did_you_mean, shown

_MM, _GPA, _DIAMOND = "is this in mm?", "is this in GPa or MPa?", "above diamond"
_PERCENT = "is this in percent?"
# 100 m is longer than any robot with rigid legs, and less than a leg of 10 cm typed in millimetres
# would be (100 "m"). 0.1 mm is shorter than the legs of flexure stages.
_LENGTH = Number("m", above=0.0, most=100.0, high=_MM, slip=1e-4)
# 10 m is longer than any tool, and a tool of 1 cm typed in millimetres exceeds it.
_OFFSET = Number("m", least=-10.0, most=10.0, low=_MM, high=_MM)
_POINT = Several(Number("m", least=-100.0, most=100.0, low=_MM, high=_MM), 3)
# One limit for metres and radians. Poses out of reach are found when the loops are closed.
COORDINATE = Number(COORDINATES, least=-100.0, most=100.0, low=_MM, high=_MM)
_POSE = Pose(COORDINATE)
# Directions may have any length, because they are normalised.
_DIRECTION = Several(Number(least=-1e6, most=1e6), 3)
# 1e5 kg is a hundred tonnes in one leg or platform. 1 µg is less than the smallest silicon part.
_MASS = Number("kg", above=0.0, most=1e5, high="is this in g?", slip=1e-9)
_MASS_OR_NONE = Number("kg", least=0.0, most=1e5, high="is this in g?")
# 1 MPa is the modulus of soft rubber, 2e12 Pa is above diamond (1.2e12). Numbers of GPa or MPa are
# below 1e6.
_YOUNGS_MODULUS = Number("Pa", least=1e6, most=2e12, low=_GPA, high=_DIAMOND)
# Lower limit: G = E/2(1+ν) of the softest material, rounded down. Upper limit: half the limit of E.
_SHEAR_MODULUS = Number("Pa", least=3e5, most=1e12, low=_GPA, high=_DIAMOND)
# Limits of isotropic elasticity, both excluded.
_POISSONS_RATIO = Number(above=-1.0, below=0.5)
# 25 kg/m³ is the density of structural foam, 25000 kg/m³ is above osmium (22600).
_DENSITY = Number("kg/m³", least=25.0, most=25e3, low="is this in g/cm³?", high="above osmium")
# 1e15 is stiffer than any drive. A larger number would only increase round-off.
_STIFFEST = 'more than any drive has; "rigid" holds it'
# 1e-12 N m/rad is a thousandth of the softest silicon hinges.
_STIFFNESS = Number("N/m or N m/rad", above=0.0, most=1e15, high=_STIFFEST, slip=1e-12)
# 1e4 kg m² is a flywheel of two metres, 1e-18 kg m² a silicon cube of 30 µm. 1e6 rad/m is a screw
# of 6 µm pitch, 1e-6 is the reciprocal.
_ROTOR = Number("kg m²", above=0.0, most=1e4, high="is this in g cm²?", slip=1e-18)
_RATIO = Number("rad/rad or rad/m", above=0.0, most=1e6, slip=1e-6)
_COMPLIANCE = SquareMatrix(6, "m/N, rad/N and rad/(N m)", compliance=True)
_INERTIA = SquareMatrix(3, "kg m²", compliance=False)
# 1 is an error of 100 %.
_SHARE = Number(least=SMALLEST_SHARE, most=1.0, high=_PERCENT, example="(0.05 is 5 %)")
# 1 is the loss factor of highly damped rubber.
_LOSS = Number(least=0.0, most=1.0, high=_PERCENT)
# The loops of a hundred bodies and two hundred joints are closed in a second. No robot has as many.
_MOST_BODIES, _MOST_JOINTS, MOST_POSES = 100, 200, 10_000
_COUNT = Number(least=1, most=MOST_POSES, whole=True)
_MODES = Number(least=1, most=MOST_MODES, whole=True)
_NUMBER, _TEXT = Number(), Text()
# Control characters (C0, C1), line ends and marks that change the direction of text.
_UNPRINTED = r"\x00-\x1f\x7f-\x9f\u2028-\u202e\u2066-\u2069"
_TITLE = Text(rf"[^{_UNPRINTED}]{{1,100}}", "a text of 1 to 100 characters on one line")
_FILE = Text(rf"[^{_UNPRINTED}]{{1,1000}}", "the name of a file, 1 to 1000 characters")
_NAME = Text(r"[\w-]{1,40}", "1 to 40 letters, digits, _ or -")
_BODY_NAME, _MATERIAL_NAME, _POINT_NAME = (
    replace(_NAME, among=table) for table in ("bodies", "materials", "points")
)

# 1 µm is thinner than any wall that carries a load.
_SIZE = Number("m", least=1e-6)


@dataclass(frozen=True)
class SectionRule(Rule):
    """Rule for a shape of `lumped.sections` with its dimensions (m). The shape checks them."""

    written = (dict,)
    unit: UnitOfLength = METRE
    shapes: tuple[str, ...] = tuple(SHAPES)

    @property
    def allowed(self) -> str:
        return f"a table with a shape and its sizes in {self.unit.name}"

    @property
    def schema(self) -> dict[str, Any]:
        return {"oneOf": [_shape_table(shape, self.unit).schema for shape in self.shapes]}

    def faults(self, value: object, key: str) -> list[str]:
        if not isinstance(value, dict):
            return [self.refused(value, key)]
        shape, shapes = value.get("shape"), f"must be one of {', '.join(self.shapes)}"
        if shape is None:
            return [f"{key}.shape: missing; {shapes}"]
        if not isinstance(shape, str) or shape not in self.shapes:
            advice = did_you_mean(str(shape), self.shapes)
            return [f"{key}.shape = {shown(shape)}: {shapes}{advice}"]
        faults = _shape_table(shape, self.unit).faults(value, key)
        # The dimensions are used as typed, because the faults of a shape do not depend on the unit.
        typed = faults or SectionRule().read(value).faults(self.unit.name)
        return faults or [f"{key}.{fault}" for fault in typed]

    def read(self, value: Any) -> Section | OwnMaterials:
        keys = _shape_table(value["shape"], self.unit).read(value)
        match SHAPES[keys.pop("shape")]:
            case kind if kind is Composite:
                return CompositeTable(**keys)
            case kind if kind is LaminateTube or kind is LaminateBox:
                return LaminateTable(kind, keys.pop("ply") or {}, keys.pop("layers"), keys)
            case kind:
                return kind(**keys)

    def within(self, value: Any, key: str) -> Iterator[tuple[str, Rule, Any]]:
        if isinstance(value, dict):
            yield from _shape_table(value["shape"], self.unit).within(value, key)

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:  # noqa: ARG002
        return replace(self, unit=unit)


# 100 m as for points. A section typed in mm is refused because it is longer than its leg.
_CORNER = Several(Number("m", least=-100.0, most=100.0, low=_MM, high=_MM), 2)
# A curve approximated by 200 corners is computed in seconds.
_CORNERS = Several(_CORNER, most=200, least=3)
# 1e-12 m² and 1e-24 m⁴ are those of a square of 1 µm, 100 m² and 1e4 m⁴ of a square of 10 m.
_AREA = Number("m²", least=1e-12, most=100.0, high=_MM)
_MOMENT = Number("m⁴", least=1e-24, most=1e4, high=_MM)
_PRODUCT = Number("m⁴", least=-1e4, most=1e4, low=_MM, high=_MM)
_OF_CENTRE = Number("m", least=-10.0, most=10.0, low=_MM, high=_MM)
# Shapes with an outline of one material.
_PLAIN_SHAPES = tuple(
    shape
    for shape, kind in SHAPES.items()
    if not issubclass(kind, Composite | Laminate | SectionProperties)
)
# From the leg's axis; fibres at 90 run around it.
_ANGLE = Number("degrees", least=-180.0, most=180.0)
_PLY_KEYS = (
    Key("E1", _YOUNGS_MODULUS, "Young's modulus along the fibres"),
    Key("E2", _YOUNGS_MODULUS, "Young's modulus across the fibres"),
    Key("G12", _SHEAR_MODULUS, "shear modulus in the layer"),
    # √(E1/E2) of the stiffest and the softest fibres in a soft matrix is the limit.
    Key("nu12", Number(above=-10.0, below=10.0), "contraction across over strain along the fibres"),
    Key("rho", _DENSITY, "density"),
    Key("thickness", _SIZE, "thickness"),
)
_LAYER = TableRule(needed("angle", _ANGLE, "from the leg's axis to the fibres"), *_PLY_KEYS)
_LAMINATE_KEYS = (
    Key("ply", TableRule(*_PLY_KEYS), "keys of all layers that do not give their own"),
    needed(
        "layers",
        Several(Either(_ANGLE, _LAYER), most=200, least=1),
        "angles (degrees) of the layers from the inside, or tables with an angle and own keys",
    ),
)
# Rules of the shapes whose keys are not all outer dimensions or wall thicknesses.
_OWN_KEYS: dict[str, tuple[Key, ...]] = {
    "properties": (
        needed("A", _AREA, "area"),
        needed("Iy", _MOMENT, "∫z² dA about the centroid: bending along z"),
        needed("Iz", _MOMENT, "∫y² dA about the centroid: bending along y"),
        needed("J", _MOMENT, "torsion constant"),
        Key("Iyz", _PRODUCT, "∫yz dA about the centroid", default=0.0),
        Key("Ay", _AREA, "shear area κA along y; default: no shear deformation"),
        Key("Az", _AREA, "shear area κA along z; given with Ay"),
        Key("ys", _OF_CENTRE, "y of the shear centre from the centroid", default=0.0),
        Key("zs", _OF_CENTRE, "z of the shear centre from the centroid", default=0.0),
    ),
    "polygon": (
        needed("outline", _CORNERS, "its corners [y, z] in order, from any origin"),
        Key("holes", Several(_CORNERS, most=20), "the corners of each hole", default=()),
    ),
}


def _shape_table(shape: str, unit: UnitOfLength) -> TableRule:
    """Rule for the table of a shape with its dimensions in `unit`, in their usual order."""
    kind: Any = SHAPES[shape]
    sizes = (
        needed(field.name, _SIZE, "outer dimension or wall thickness") for field in fields(kind)
    )
    keys = _OWN_KEYS.get(shape) or tuple(sizes)
    if issubclass(kind, Laminate):
        keys = (*(key for key in keys if key.name != "layers"), *_LAMINATE_KEYS)
    if kind is Composite:
        keys = (needed("parts", _PARTS, "parts that touch along edges, each of one material"),)
    table = TableRule(needed("shape", OneOf((shape,)), "kind of section"), *keys)
    return table.in_unit(unit, ())


# Point of a leg's line, or share of the line's length.
_PLACE_ON_LINE = Either(
    _POINT_NAME, Number(least=0.0, most=1.0, high="this is a share of the line's length, not in m")
)


@dataclass(frozen=True)
class StationRule(SectionRule):
    """Rule for the section of a leg at a position `at` along its line, read as (at, section)."""

    shapes: tuple[str, ...] = (*_PLAIN_SHAPES, SectionProperties.shape)
    many = "tables with at, a shape and its sizes"

    @property
    def allowed(self) -> str:
        return f"a table with at, a shape and its sizes in {self.unit.name}"

    @property
    def schema(self) -> dict[str, Any]:
        tables = [_shape_table(shape, self.unit).schema for shape in self.shapes]
        return {
            "oneOf": [
                table
                | {
                    "properties": {"at": _PLACE_ON_LINE.schema, **table["properties"]},
                    "required": ["at", *table["required"]],
                }
                for table in tables
            ]
        }

    def faults(self, value: object, key: str) -> list[str]:
        if not isinstance(value, dict):
            return [self.refused(value, key)]
        rest = {name: entry for name, entry in value.items() if name != "at"}
        allowed = f"must be {_PLACE_ON_LINE.allowed}"
        position_faults = (
            _PLACE_ON_LINE.faults(value["at"], f"{key}.at")
            if "at" in value
            else [f"{key}.at: missing; {allowed}"]
        )
        return [*position_faults, *super().faults(rest, key)]

    def read(self, value: Any) -> Any:
        rest = {name: entry for name, entry in value.items() if name != "at"}
        return _PLACE_ON_LINE.read(value["at"]), super().read(rest)

    def within(self, value: Any, key: str) -> Iterator[tuple[str, Rule, Any]]:
        if isinstance(value, dict):
            yield from _PLACE_ON_LINE.within(value["at"], f"{key}.at")
            rest = {name: entry for name, entry in value.items() if name != "at"}
            yield from super().within(rest, key)


MATERIAL = TableRule(
    needed("E", _YOUNGS_MODULUS, "Young's modulus"),
    needed("nu", _POISSONS_RATIO, "Poisson's ratio"),
    Key("rho", _DENSITY, "density; a leg can have a `mass` instead"),
    Key("G", _SHEAR_MODULUS, "shear modulus of a leg; default E/2(1 + nu)"),
    Key("loss", _LOSS, "loss factor", default=0.0),
)


def _selected_faces(on_axis: Key, on_plane: Key) -> tuple[Key, ...]:
    """Keys that select faces of a part.

    `on_axis` is the key of a point on the axis of a cylinder, `on_plane` that of a point in a
    plane.
    """
    near = Key("tolerance", _LENGTH, "largest distance of faces from it")
    axis = Key("axis", _DIRECTION, "its direction; default: any")
    radius = needed("radius", _LENGTH, "radius of the bore or boss")
    normal = needed("normal", _DIRECTION, "outward normal")
    return (
        Key("faces", Several(Number(whole=True)), "numbers of faces, see `flexproof faces`"),
        Key("name", _TEXT, "name of faces in the part's file"),
        Key("cylinder", TableRule(radius, axis, on_axis, near), "all faces on a cylinder"),
        Key("plane", TableRule(normal, on_plane, near), "all flat faces in a plane"),
    )


_ON_IT = Key("point", _POINT, "a point on it; default: that of the interface")
INTERFACE = TableRule(
    *_selected_faces(_ON_IT, _ON_IT),
    Key("coupling", OneOf(get_args(Coupling)), "how the faces are held by the joint"),
    Key("point", _POINT, "reference point for `identify`; in a robot: the point of that name"),
)

_MATERIAL = Either(_MATERIAL_NAME, MATERIAL)
_COMPOSITE_PART = TableRule(
    needed("section", SectionRule(shapes=_PLAIN_SHAPES), "shape of the part"),
    needed("material", _MATERIAL, "a name in [materials], or a table"),
    Key("at", _CORNER, "position [y, z] of the shape's own origin", default=(0.0, 0.0)),
)
_PARTS = Several(_COMPOSITE_PART, most=20, least=2)
_LEG, _RIGID, _PART = ("leg",), ("rigid body",), ("part",)
_PLACE = TableRule(
    needed("at", Either(_POINT_NAME, _POINT), "origin of the file's axes"),
    Key("x", _DIRECTION, "direction of the file's x axis", default=(1.0, 0.0, 0.0)),
    Key("y", _DIRECTION, "direction of its y axis, made normal to x", default=(0.0, 1.0, 0.0)),
)
_UP = "direction of z, made normal to x; default [0, 0, 1], for a leg along z [1, 0, 0]"
_LINE_POINT = Either(_POINT_NAME, _POINT)
_THROUGH = Either(
    _LINE_POINT,
    TableRule(needed("arc", _LINE_POINT, "a point between two others, on the arc that joins them")),
)
_ENDS = "end faces kept plane (rigid) or free to warp; default: both are computed"
_TIP = "at `to` with `from` clamped, leg axes; replaces section and material, needs `mass`"
PATTERN = TableRule(
    needed("about", Either(OneOf(("x", "y", "z")), _DIRECTION), "axis of the symmetry"),
    needed("count", Number(least=2, most=36, whole=True), "number of copies over a turn"),
    Key("through", Either(_POINT_NAME, _POINT), "point on the axis; default: the origin"),
)
_PATTERN_NAME = replace(_NAME, among="patterns")
_COPIES = Key("pattern", Either(_PATTERN_NAME, PATTERN), "repeat as NAME1, NAME2, … about an axis")
_REPEATED_POINT = TableRule(needed("at", _POINT, "point of the first copy"), _COPIES)
_PLACE_OR_COPIES = Either(_POINT, _REPEATED_POINT)
BODY = TableRule(
    Key("from", _POINT_NAME, "point at the root", owners=_LEG),
    Key("to", _POINT_NAME, "point at the tip; x points from root to tip", owners=_LEG),
    Key("up", _DIRECTION, _UP, owners=_LEG),
    Key(
        "section",
        SectionRule(),
        "cross-section about its centroid; width along y, height along z",
        owners=_LEG,
    ),
    Key(
        "sections",
        Several(StationRule(), most=100, least=2),
        "instead of `section`: sections along the line, sizes linear in between; two at one "
        "position are a step",
        owners=_LEG,
    ),
    Key(
        "through",
        Several(_THROUGH, most=100, least=1),
        "points of the centre line between `from` and `to`; default: a straight line",
        owners=_LEG,
    ),
    Key("material", _MATERIAL, "a name in [materials], or a table", owners=_LEG + _PART),
    Key("mass", _MASS_OR_NONE, "mass; replaces a density", owners=_LEG + _RIGID),
    Key("compliance", _COMPLIANCE, _TIP, owners=_LEG),
    Key(
        "loss",
        _LOSS,
        "loss factor for a `compliance`, composite or laminate; other prisms: that of the material",
        owners=_LEG,
    ),
    Key("ends", OneOf(get_args(Ends)), _ENDS, owners=_LEG),
    Key(
        "mass_centre",
        _OFFSET,
        "position of the mass centre along x, for a `compliance`",
        owners=_LEG,
    ),
    Key("points", Several(_POINT_NAME), "points of the body, for joints and loads", owners=_RIGID),
    Key("centre", Either(_POINT_NAME, _POINT), "mass centre: a point or [x, y, z]", owners=_RIGID),
    Key(
        "inertia",
        _INERTIA,
        "inertia about the mass centre; base axes, for a leg: leg axes",
        owners=_LEG + _RIGID,
    ),
    Key("step", _FILE, "STEP or BREP file, relative to the robot file", owners=_PART),
    Key("mesh", _FILE, "mesh file, instead of `step`", owners=_PART),
    Key("unit", OneOf(get_args(LengthUnit)), "unit of length, for files without one", owners=_PART),
    Key("place", _PLACE, "position of the file's axes; default: base axes", owners=_PART),
    Key(
        "interfaces",
        Named(_POINT_NAME, INTERFACE),
        "interfaces by the name of their point",
        owners=_PART,
    ),
    _COPIES,
)


class _Axes(Several):
    """Rule for the axes of a universal joint. Joints of another kind have one `axis`."""

    def refused(self, value: object, key: str) -> str:
        return f"{super().refused(value, key)}; a joint of one axis has axis = [x, y, z]"


_TWO_NAMES = Either(_POINT_NAME, Several(_POINT_NAME, 2))
_SERIES = "compliance in series; base axes of the reference posture, turning with the first body"
# 1e9 N s/m: holds a tonne to a micrometre per second.
_DRIVE_DASHPOT = Number("N s/m or N m s/rad", above=0.0, most=1e9, slip=1e-12)
# 1 GPa to above steel; a screw of aluminium has 7e10.
_SCREW_MODULUS = Number("Pa", least=1e9, most=2e12, low=_GPA, high=_DIAMOND)
_SCREW_SPRING = Either(Number("N/m", above=0.0, most=1e15, slip=1e-12), OneOf(("rigid",)))
_NUT_LOAD = Number("N", above=0.0, most=1e7, slip=1e-6)
_NUT = TableRule(
    needed("rigidity", Number("N/m", above=0.0, most=1e15, slip=1e-12), "K of the nut's table"),
    needed("load_rating", _NUT_LOAD, "basic dynamic load rating Ca of the table"),
    Key("preload", _NUT_LOAD, "axial preload of the nut"),
    Key("load", _NUT_LOAD, "axial load of a nut with play, instead of `preload`"),
    Key("share", _SHARE, "load of K in the table / Ca; default 0.1 with preload, 0.3 with play"),
)
_SCREW = TableRule(
    needed("diameter", _LENGTH, "diameter of the shaft that carries tension: root diameter"),
    needed("length", _LENGTH, "from the bearing that holds the shaft to the nut, as drawn"),
    needed("nut", Either(_SCREW_SPRING, _NUT), "axial stiffness of the nut, or its table"),
    needed("bearing", _SCREW_SPRING, "axial stiffness of the bearing, of each if there are two"),
    Key("span", _LENGTH, "distance of a second bearing that holds the shaft; default: none"),
    Key(
        "positive",
        OneOf(("longer", "shorter")),
        "whether a positive motion makes the length longer or shorter",
        default="longer",
    ),
    Key("E", _SCREW_MODULUS, "Young's modulus of the shaft", default=2.06e11),
)
_DRIVE = TableRule(
    Key(
        "stiffness",
        Either(_STIFFNESS, OneOf(("rigid",))),
        "stiffness in every model; required without `screw`",
    ),
    Key("screw", _SCREW, "ball screw of a prismatic joint, instead of `stiffness`"),
    Key("simplified", _STIFFNESS, "stiffness in the simplified model, if different"),
    Key("loss", _LOSS, "loss factor of the stiffness", default=0.0),
    Key("damping", _DRIVE_DASHPOT, "viscous dashpot parallel to the stiffness", default=0.0),
    Key("inertia", _ROTOR, "inertia of the rotor; a linear motor has kg"),
    Key("ratio", _RATIO, "gear ratio: rotor turns per joint turn, or rad per m; default 1"),
)
_STIFF = 'more than any joint has; "rigid" holds it'


def _direction_keys() -> Iterator[tuple[str, Direction, str]]:
    """Name of each direction of a joint, the direction, and the kinds of joints that have it."""
    names = dict.fromkeys(name for directions in DIRECTIONS.values() for name in directions)
    for name in names:
        kinds = [kind for kind, directions in DIRECTIONS.items() if name in directions]
        yield name, DIRECTIONS[kinds[0]][name], ", ".join(kinds)


def _along_directions(rules: tuple[Rule, Rule], *, free: bool) -> TableRule:
    """Table of numbers along directions of joints, such as stiffnesses.

    `rules` are the rules for translations and for rotations. `free` is True if the table includes
    the directions along which the joint is free.
    """
    return TableRule(
        *(
            Key(name, rules[direction.turns], kinds)
            for name, direction, kinds in _direction_keys()
            if free or not direction.free
        )
    )


_JOINT_STIFFNESS = _along_directions(
    (
        Either(Number("N/m", above=0.0, most=1e15, high=_STIFF, slip=1e-12), OneOf(("rigid",))),
        Either(Number("N m/rad", above=0.0, most=1e15, high=_STIFF, slip=1e-12), OneOf(("rigid",))),
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
_DASHPOTS = "viscous dashpots along directions of the joint, free ones included"
_GROOVE = Number(above=0.5, most=0.6)
_BEARING = TableRule(
    Key("size", OneOf(tuple(SIZES)), "designation of a bearing whose inside is published"),
    Key("balls", Number(least=3, most=200, whole=True), "number of balls of a row, without `size`"),
    Key("ball_diameter", _LENGTH, "diameter of the balls"),
    Key("pitch_diameter", _LENGTH, "diameter of the circle of their centres"),
    Key("contact_angle", Number("°", least=0.0, most=75.0), "contact angle without load"),
    Key("inner_groove", _GROOVE, "radius of the inner groove / ball diameter; default 0.52"),
    Key("outer_groove", _GROOVE, "radius of the outer groove / ball diameter; default 0.53"),
    needed("preload", Number("N", above=0.0, most=1e7, slip=1e-6), "axial preload of each row"),
    Key("rows", Number(least=1, most=20, whole=True), "number of rows along the axis", default=1),
    Key("distance", _LENGTH, "distance of neighbouring rows; required for several"),
    Key("arrangement", OneOf(get_args(Arrangement)), "arrangement of several rows", default="O"),
)
_GUIDE = TableRule(
    needed("balls", Number(least=2, most=200, whole=True), "number of loaded balls of a row"),
    needed("ball_diameter", _LENGTH, "diameter of the balls"),
    needed("spacing", _LENGTH, "distance of neighbouring balls"),
    needed("width", _LENGTH, "distance of the rows along lateral"),
    needed("height", _LENGTH, "distance of the rows along normal"),
    Key("contact_angle", Number("°", above=0.0, below=90.0), "angle to lateral", default=45.0),
    Key("groove", _GROOVE, "radius of the grooves / ball diameter", default=0.52),
    Key("lines", OneOf(get_args(Lines)), "where lines of contact meet: outside (O)", default="O"),
    needed("preload", Number("N", above=0.0, most=1e7, slip=1e-6), "of upper on lower rows"),
)
_CATALOGUE = "instead of `compliance`: stiffness along directions of the joint, each required"
_JOINT_UP = "direction of a slide's normal; of the axis of a fixed or spherical joint"
JOINT = TableRule(
    needed("type", OneOf(get_args(JointKind)), "kind of joint"),
    needed("between", Several(_BODY_NAME, 2), 'two bodies; "ground" is one'),
    needed("at", _TWO_NAMES, "common point, or one of each body along a sliding axis"),
    Key("axis", _DIRECTION, "axis of sliding or turning; planar: the normal"),
    Key(
        "axes",
        _Axes(_DIRECTION, 2),
        "universal: axis fixed in the first body, axis fixed in the second",
    ),
    Key("drive", _DRIVE, "drive of a revolute or prismatic joint; default: passive"),
    Key("compliance", _COMPLIANCE, _SERIES),
    Key("stiffness", _JOINT_STIFFNESS, _CATALOGUE),
    Key("bearing", _BEARING, "instead of both: preloaded ball bearing of a revolute joint"),
    Key("guide", _GUIDE, "instead of all: carriage of a prismatic joint on four rows of balls"),
    Key("damping", _JOINT_DAMPING, _DASHPOTS),
    Key("up", _DIRECTION, _JOINT_UP),
    Key("loss", _LOSS, "loss factor of the compliance or stiffness", default=0.0),
    _COPIES,
)
TOOL = TableRule(
    needed("body", _BODY_NAME, "body that carries the tool"),
    needed("point", _POINT_NAME, "loaded point of that body"),
    needed(
        "moves", Several(OneOf(MOVES)), "coordinates of the point that a pose prescribes, in order"
    ),
    Key("mass", _MASS_OR_NONE, "point mass at the tool", default=0.0),
)
PATH = TableRule(
    Key("from", _POSE, "first pose"),
    Key("to", _POSE, "last pose"),
    Key("count", _COUNT, "number of poses from `from` to `to`"),
    Key("counts", Several(_COUNT), "instead of `count`: number of poses along each move, a grid"),
    Key("poses", Several(_POSE, most=MOST_POSES), "instead of all these: a list of poses"),
)

FORCE = Number("N or N m", least=-1e9, most=1e9)
# 1e5 m/s² is ten thousand times gravity. No tool moves at 1 km/s.
_PER_SECOND_SQUARED = Several(Number("m/s²", least=-1e5, most=1e5), 3)
_SPEED = Several(Number("m/s", least=-1e3, most=1e3, low=_MM, high=_MM), 3)
_THERE = "point of a body where the wrench acts; default: the tool"
_WHOSE = "body of `at`; default: that of the tool, else the first with that point"
# 1e9 N/m: beyond any load of a robot.
_PER_LENGTH = Several(Number("N/m or N m/m", least=-1e9, most=1e9), 6)
_STATION = Number("m", least=0.0, most=100.0, high=_MM)
_LINE = TableRule(
    needed("leg", _BODY_NAME, "leg of constant section, or with a 6×6"),
    needed("wrench", _PER_LENGTH, "forces and moments per length at `from`"),
    Key("end_wrench", _PER_LENGTH, "the same at `to`, linear between; default: as `wrench`"),
    Key("from", _STATION, "distance from the root where it begins; default: the root"),
    Key("to", _STATION, "distance from the root where it ends; default: the tip"),
    Key("axes", OneOf(("base", "leg")), "axes of the forces and moments", default="base"),
)
# 1 GPa: above the strength of most materials, and far above any hydraulic or contact pressure.
_PRESSURE = Number("Pa", least=-1e9, most=1e9)
_ON_FACES = TableRule(
    needed("body", _BODY_NAME, "CAD part whose faces it acts on"),
    needed("pressure", _PRESSURE, "pressure, positive into the body"),
    *_selected_faces(
        Key("point", _POINT, "a point on its axis, needed if several have this radius"),
        needed("point", _POINT, "a point on it, axes of the part's file"),
    ),
)
LOAD = TableRule(
    needed("name", _NAME, "name; judged as load:NAME"),
    Key("wrench", Several(FORCE, 6), "forces and moments, base axes"),
    Key("file", _FILE, "CSV file with a wrench for each pose of the path, instead of `wrench`"),
    Key("at", _POINT_NAME, _THERE),
    Key("body", _BODY_NAME, _WHOSE),
    Key("lines", Several(_LINE, most=100), "loads along legs"),
    Key("pressures", Several(_ON_FACES, most=100), "pressures on faces of CAD parts"),
    Key("gravity", _PER_SECOND_SQUARED, "acceleration of gravity on all bodies, base axes"),
    Key("acceleration", _PER_SECOND_SQUARED, "acceleration of the tool; inertia of all bodies"),
    Key("speed", _SPEED, "speed of the tool; inertia forces with its square"),
)
DAMPING = TableRule(needed("ratio", _LOSS, "damping ratio of every mode"))
# 3 kHz is ten times the first natural frequency of stiff machines. Bodies of a Delta robot that are
# accurate up to 3 kHz are computed in half a minute, up to 10 kHz in more than three minutes.
_FREQUENCY = Number("Hz", above=0.0, most=3e3, high="is this in 1/min?")
_MOTION = TableRule(
    needed("point", _POINT_NAME, "point whose displacement is computed"),
    Key("body", _BODY_NAME, "body of `point`; default: that of the tool, else the first with it"),
    Key("direction", _DIRECTION, "direction of the displacement; default: that of the force"),
)
_JUDGED_FREQUENCY = "frequency at which the response is judged, besides its peak"
RESPONSE = TableRule(
    needed("name", _NAME, "name; judged as response:NAME"),
    needed("direction", _DIRECTION, "direction of the force and of the displacement, base axes"),
    needed("from", _FREQUENCY, "first frequency"),
    needed("to", _FREQUENCY, "last frequency"),
    Key(
        "count", Number(least=2, most=MOST_POSES, whole=True), "number of frequencies", default=400
    ),
    Key("frequency", _FREQUENCY, _JUDGED_FREQUENCY),
    Key(
        "at",
        Either(_FREQUENCY, _POINT_NAME),
        "point where the force acts; default: the tool. A number is the `frequency`",
    ),
    Key("body", _BODY_NAME, _WHOSE),
    Key(
        "of",
        Either(_POINT_NAME, _MOTION),
        "point whose displacement is computed, or a table; default: where the force acts",
    ),
)
# 10 cm, because accepted tool errors are of the order of micrometres.
_DISPLACEMENT = Number("m", above=0.0, most=0.1, high="is this in µm?")
ACCEPT = TableRule(
    Key(
        "deflection",
        _SHARE,
        "largest relative error of deflections",
        default=Requirement.deflection,
    ),
    Key("displacement", _DISPLACEMENT, "largest error under [[loads]], instead of `deflection`"),
    Key(
        "frequency",
        _SHARE,
        "largest relative error of frequencies and their order",
        default=Requirement.frequency,
    ),
    Key("response", _SHARE, "largest relative error of responses", default=Requirement.response),
    Key("modes", _MODES, "number of frequencies that are judged", default=Requirement.modes),
    Key("rely", Several(OneOf(MODEL_KINDS)), "models whose inadequacy is exit code 1", default=()),
    *(Key(load.name, _SHARE, f"limit for {load}, instead of `deflection`") for load in UNIT_LOADS),
)
_ELEMENTS = Number(least=1, most=MOST_ELEMENTS, whole=True)
_FINE = "largest relative error of f1 to f4 and of deflections with these elements"
_UNEXPLAINED = "unexplained difference from solids of the same legs"
_SOLID_ENDS = 'end faces of these solids; "as given": `ends` of each leg, rigid without it'
AGREE = TableRule(
    Key(
        "elements",
        _ELEMENTS,
        "elements per leg, of segments and beams",
        default=AgreementLimits.elements,
    ),
    Key("convergence", _SHARE, _FINE, default=AgreementLimits.convergence),
    Key("compliance", _SHARE, f"{_UNEXPLAINED}: deflections", default=AgreementLimits.compliance),
    Key("frequency", _SHARE, f"{_UNEXPLAINED}: f1 to f4", default=AgreementLimits.frequency),
    Key("ends", OneOf(get_args(SolidEnds)), _SOLID_ENDS, default=AgreementLimits.ends),
)
# From below the resolution of instruments to above the compliance of structures. Zero is refused
# elsewhere, because errors are relative to the value.
_MEASURED = Number(least=-1e15, most=1e15)
_SPREAD = Number(above=0.0, most=1e15, slip=SMALLEST_MEASURED)
_TEST_LOAD = Number("N or N m", above=0.0, most=1e9, slip=1e-12)
MEASURED = TableRule(
    needed("quantity", _TEXT, "x y z phi_x phi_y phi_z, f1 f2 …, leg1.c22 … or response:NAME …"),
    needed(
        "value", _MEASURED, "value: m or rad under `load`, Hz, or SI of a compliance or response"
    ),
    needed("uncertainty", _SPREAD, "standard uncertainty, in the unit of the value"),
    needed("source", _TEXT, "origin of the value"),
    Key("pose", _POSE, "pose of the measurement, in the order of the moves", default=()),
    Key("load", _TEST_LOAD, "force or moment of the measurement", default=1.0),
)
MEASURED_VALUES = Several(MEASURED)
_NODE = Text(r"[1-9][0-9]{0,8}", "a number of up to nine digits")
_SENSOR = TableRule(
    needed("body", _NAME, "body of the node"),
    needed(
        "at", Either(_NAME, _POINT), "a point of the body, or the position in the reference posture"
    ),
    Key("x", _DIRECTION, "direction of the sensor's x axis", default=(1.0, 0.0, 0.0)),
    Key("y", _DIRECTION, "direction of its y axis, made normal to x", default=(0.0, 1.0, 0.0)),
)
# 0.2 % is a typical change of frequencies if robot and sensors are mounted again.
HAMMER = TableRule(
    needed("nodes", Named(_NODE, _SENSOR), "nodes by their numbers in the universal file"),
    Key("pose", _POSE, "pose of the test; default: the reference posture"),
    Key(
        "uncertainty",
        _SHARE,
        "relative standard uncertainty of frequencies, besides scatter",
        default=0.002,
    ),
    Key(
        "calibration",
        _SHARE,
        "relative standard uncertainty of responses, besides scatter",
        default=0.01,
    ),
    Key("averages", _COUNT, "number of blows that coherence is averaged over", default=1),
)
_INPUT_UNCERTAINTY = TableRule(
    needed("key", _TEXT, 'a number or matrix of this file, such as "leg1.length"'),
    needed("relative", _SHARE, "relative standard uncertainty"),
)
_UNITS = "unit of lengths: with mm, every value listed in m is in mm; all else stays"
_HEAD = (
    needed("schema", OneOf((1, 2)), "version of the format: 2, or 1 for a biglide"),
    needed("name", _TITLE, "name in the report"),
    Key("units", OneOf(tuple(LENGTH_UNITS)), _UNITS, default=METRE.name),
)
_ASKED = (
    Key("loads", Several(LOAD), "load cases, each judged", default=()),
    Key("damping", DAMPING, "damping of all modes, besides loss factors"),
    Key("responses", Several(RESPONSE), "responses to harmonic forces, each judged", default=()),
    Key("accept", ACCEPT, "limits on the errors of models"),
    Key("agree", AGREE, "limits on differences between formulations of the same legs"),
    Key("measured", MEASURED_VALUES, "measured values", default=()),
    Key("hammer", HAMMER, "nodes and pose of a modal test, see `--measured`"),
    Key(
        "input_uncertainty",
        Several(_INPUT_UNCERTAINTY),
        "uncertainties of numbers in this file",
        default=(),
    ),
)
MECHANISM = TableRule(
    *_HEAD,
    needed("points", Named(_NAME, _PLACE_OR_COPIES), "points in the reference posture"),
    needed("bodies", Named(_NAME, BODY, _MOST_BODIES), "legs, rigid bodies and CAD parts"),
    needed("joints", Named(_NAME, JOINT, _MOST_JOINTS), "joints between bodies"),
    needed("tool", TOOL, "the loaded point"),
    Key("patterns", Named(_NAME, PATTERN), "patterns of copies by name", default={}),
    Key("materials", Named(_NAME, MATERIAL), "materials by name", default={}),
    Key("path", PATH, "poses of `run`; default: the reference posture"),
    *_ASKED,
)

# Coordinates of a pose of the biglide.
_BIGLIDE_MOVES = ("x",)
# Schema 1, the biglide: contents of schema 2 under other names, and three more numbers. Legs ten
# times as long are outside any family of one design.
_RATIO = Number(above=0.0, most=10.0, high=_PERCENT)
# With 1e4 N/m the paper's force of 1000 N displaces the drive by 0.1 m, too much for any drive.
_ACTUATOR_STIFFNESS = Number(
    "N/m",
    least=1e4,
    most=1e15,
    low="is this in N/µm or kN/mm?",
    high="more than any drive has; 1e15 is as good as rigid",
)
_OF_LEGS = ("ends", "compliance", "loss", "section", "inertia", "mass_centre")
_BIGLIDE_LEG = TableRule(
    needed("length", _LENGTH, "distance between its joints"),
    Key("mass", _MASS, "mass; replaces a density"),
    Key("material", MATERIAL, "material of the section"),
    *(replace(BODY.keys[name], owners=()) for name in _OF_LEGS),
)
_GEOMETRY = TableRule(
    needed("a", _LENGTH, "distance between the slides along x"),
    Key("alpha", _RATIO, "factor on both lengths at the same stroke", default=1.0),
    Key(
        "tool_offset",
        Several(_OFFSET, 3),
        "vector from B to the loaded point",
        default=(0.0, 0.0, 0.0),
    ),
)
_FOOT = TableRule(
    needed("compliance", _COMPLIANCE, "compliance at the revolute joint, robot axes"),
    Key("loss", _LOSS, "loss factor", default=0.0),
    Key("inertia", _INERTIA, "used by the audit alone"),
)
_SPRING = TableRule(
    needed("compliance", _COMPLIANCE, "compliance in series at the loaded point, robot axes"),
    Key("loss", _LOSS, "loss factor", default=0.0),
    Key("active", OneOf((True, False)), "false: recorded, not used", default=True),
)
_CORRECTION = TableRule(
    needed("key", _TEXT, "key that differs from the source"),
    needed("printed", _NUMBER, "value printed in the source"),
    needed("used", _NUMBER, "value in this file"),
    needed("reason", _TEXT, "reason of the correction"),
)
_ACTUATORS = TableRule(
    needed("stiffness", _ACTUATOR_STIFFNESS, "stiffness along y"),
    Key("loss", _LOSS, "loss factor", default=0.0),
)
BIGLIDE = TableRule(
    *_HEAD,
    needed("type", OneOf(("biglide",)), "two slides along y, two legs that meet at B"),
    needed("geometry", _GEOMETRY, "geometry of slides and tool"),
    needed(
        "platform", TableRule(needed("mass", _MASS, "mass at the loaded point")), "carried by leg 1"
    ),
    needed("actuators", _ACTUATORS, "drives of the simplified model"),
    needed("leg1", _BIGLIDE_LEG, "leg from the slide on x = 0 to B"),
    needed("leg2", _BIGLIDE_LEG, "leg from the slide on x = a to B"),
    Key("foot", _FOOT, "foot of both legs; default: rigid"),
    Key("tool", _SPRING, "spring at the tool; default: rigid"),
    Key("corrections", Several(_CORRECTION), "misprints of the source", default=()),
    *_ASKED,
)


def rules_of(tables: Mapping[str, Any]) -> TableRule:
    """Rules for the tables of a file: those of its schema, in its unit of length."""
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
    """Unit of length of a file. Metre if none or a wrong one is given."""
    name = tables.get("units")
    return LENGTH_UNITS.get(name, METRE) if isinstance(name, str) else METRE


def _moves_of(tables: Mapping[str, Any]) -> tuple[str, ...]:
    """Moves of the tool. Empty if they have faults."""
    if not is_mechanism(tables):
        return _BIGLIDE_MOVES
    tool = tables.get("tool")
    moves = tool.get("moves") if isinstance(tool, dict) else None
    return () if TOOL.keys["moves"].kind.faults(moves, "") else tuple(moves or ())


@memo(16)
def _in_unit(rules: TableRule, unit: UnitOfLength, moves: tuple[str, ...]) -> TableRule:
    return rules.in_unit(unit, moves)
