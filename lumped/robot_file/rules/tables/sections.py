"""Materials and cross-sections in robot files, also sections of several materials."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Annotated, Any, NamedTuple, Self, TypeAlias

from lumped.mechanism.length_unit import METRE, UnitOfLength
from lumped.robot_file.rules.rule import (
    Either,
    Key,
    Number,
    OneOf,
    Rule,
    Several,
    TableRule,
    Value,
    needed,
    table_of,
)
from lumped.robot_file.rules.tables.values import (
    DIAMOND,
    IN_GPA,
    IN_MM,
    LOSS,
    MATERIAL_NAME,
    POINT_NAME,
)
from lumped.sections import (
    SHAPES,
    Composite,
    CompositePart,
    Laminate,
    LaminateBox,
    LaminateTube,
    Layer,
    Section,
    SectionProperties,
)
from lumped.text import did_you_mean, shown

# 1 MPa is the modulus of soft rubber, 2e12 Pa is above diamond (1.2e12). Numbers of GPa or MPa are
# below 1e6.
_YOUNGS_MODULUS = Number("Pa", least=1e6, most=2e12, low=IN_GPA, high=DIAMOND)
# Lower limit: G = E/2(1+ν) of the softest material, rounded down. Upper limit: half the limit of E.
_SHEAR_MODULUS = Number("Pa", least=3e5, most=1e12, low=IN_GPA, high=DIAMOND)
# Limits of isotropic elasticity, both excluded.
_POISSONS_RATIO = Number(above=-1.0, below=0.5)
# 25 kg/m³ is the density of structural foam, 25000 kg/m³ is above osmium (22600).
_DENSITY = Number("kg/m³", least=25.0, most=25e3, low="is this in g/cm³?", high="above osmium")
# 1 µm is thinner than any wall that carries a load.
_SIZE = Number("m", least=1e-6)
# 100 m as for points. A section typed in mm is refused because it is longer than its leg.
_CORNER = Several(Number("m", least=-100.0, most=100.0, low=IN_MM, high=IN_MM), 2)
# A curve approximated by 200 corners is computed in seconds.
_CORNERS = Several(_CORNER, most=200, least=3)
# 1e-12 m² and 1e-24 m⁴ are those of a square of 1 µm, 100 m² and 1e4 m⁴ of a square of 10 m.
_AREA = Number("m²", least=1e-12, most=100.0, high=IN_MM)
_MOMENT = Number("m⁴", least=1e-24, most=1e4, high=IN_MM)
_PRODUCT = Number("m⁴", least=-1e4, most=1e4, low=IN_MM, high=IN_MM)
_WARPING = Number("m⁶", least=0.0, most=1e6, high=IN_MM)
_OF_CENTRE = Number("m", least=-10.0, most=10.0, low=IN_MM, high=IN_MM)
# From the leg's axis; fibres at 90 run around it.
_ANGLE = Number("degrees", least=-180.0, most=180.0)
# √(E1/E2) of the stiffest and the softest fibres in a soft matrix is the limit.
_PLY_RATIO = Number(above=-10.0, below=10.0)


@dataclass(frozen=True, kw_only=True)
class MaterialEntry:
    """Elastic material. `G` is only for legs whose shear modulus differs from E/2(1 + ν)."""

    E: Annotated[float, Value(_YOUNGS_MODULUS, "Young's modulus")]
    nu: Annotated[float, Value(_POISSONS_RATIO, "Poisson's ratio")]
    rho: Annotated[float | None, Value(_DENSITY, "density; a leg can have a `mass` instead")] = None
    G: Annotated[
        float | None, Value(_SHEAR_MODULUS, "shear modulus of a leg; default E/2(1 + nu)")
    ] = None
    loss: Annotated[float, Value(LOSS, "loss factor")] = 0.0


MATERIAL = table_of(MaterialEntry)
MATERIAL_OR_NAME = Either(MATERIAL_NAME, MATERIAL)


@dataclass(frozen=True, kw_only=True)
class PlyEntry:
    """Constants of all layers of a laminate. Values of a single layer replace them."""

    E1: Annotated[float | None, Value(_YOUNGS_MODULUS, "Young's modulus along the fibres")] = None
    E2: Annotated[float | None, Value(_YOUNGS_MODULUS, "Young's modulus across the fibres")] = None
    G12: Annotated[float | None, Value(_SHEAR_MODULUS, "shear modulus in the layer")] = None
    nu12: Annotated[
        float | None, Value(_PLY_RATIO, "contraction across over strain along the fibres")
    ] = None
    rho: Annotated[float | None, Value(_DENSITY, "density")] = None
    thickness: Annotated[float | None, Value(_SIZE, "thickness")] = None


PLY = table_of(PlyEntry)


@dataclass(frozen=True, kw_only=True)
class LayerEntry(PlyEntry):
    """Layer of a laminate: its `angle` (degrees), and constants that replace those of `ply`."""

    angle: float


_LAYER = TableRule(
    LayerEntry, needed("angle", _ANGLE, "from the leg's axis to the fibres"), *PLY.keys.values()
)


@dataclass(frozen=True)
class LaminateWall:
    """Wall of a laminate tube or box, as described in a robot file.

    `sizes` are the outer dimensions (m) by the names of their keys. `layers` are in order from the
    inside. Each is an angle (degrees), or an entry whose constants replace those of `ply`.
    """

    shape: type[LaminateTube] | type[LaminateBox]
    ply: PlyEntry
    layers: tuple[float | LayerEntry, ...]
    sizes: Mapping[str, float]

    def resolved(self, materials: Mapping[str, MaterialEntry]) -> "LaminateWall":  # noqa: ARG002
        """The wall itself, unchanged, because it contains no names of materials."""
        return self

    def faults(self, unit: str = "m") -> list[str]:
        """Faults of the layers and of the shape, one text each. Lengths in texts are in `unit`."""
        missing = [
            f"layers[{number}].{name}: missing; must be given there or in ply"
            for number, layer in enumerate(self._layers, start=1)
            for name, value in layer.items()
            if value is None
        ]
        return missing[:1] or self.section.faults(unit)

    def material_faults(self, key: str) -> Iterator[str]:  # noqa: ARG002
        """No faults, because `faults` includes those of the layers' constants."""
        yield from ()

    @property
    def _layers(self) -> list[dict[str, Any]]:
        """Fields of each layer, by name. A value is None if neither layer nor `ply` defines it."""
        return [
            {
                name: getattr(self.ply, name, None) if value is None else value
                for name, value in self._own_values(layer).items()
            }
            for layer in self.layers
        ]

    @staticmethod
    def _own_values(layer: float | LayerEntry) -> dict[str, Any]:
        names = [field.name for field in fields(Layer)]
        if isinstance(layer, LayerEntry):
            return {name: getattr(layer, name) for name in names}
        return dict.fromkeys(names) | {"angle": layer}

    @property
    def section(self) -> Laminate:
        """Laminate section with this wall. Each layer must have all its constants."""
        return self.shape(tuple(Layer(**layer) for layer in self._layers), **self.sizes)


@dataclass(frozen=True)
class CompositeParts:
    """Parts of a composite section, as described in a robot file.

    The material of a part is a record, or a name in [materials] until `resolved` replaces it.
    """

    parts: tuple["CompositePartEntry", ...]

    def resolved(self, materials: Mapping[str, MaterialEntry]) -> "CompositeParts":
        """Copy of the parts with materials in place of names that are in `materials`."""
        return CompositeParts(
            tuple(
                replace(part, material=materials[part.material])
                if isinstance(part.material, str) and part.material in materials
                else part
                for part in self.parts
            )
        )

    def faults(self, unit: str = "m") -> list[str]:
        """Faults of the shapes of the parts and of their positions, one text each.

        Lengths in texts are in `unit`.
        """
        parts = tuple(
            CompositePart(part.section, E=1.0, nu=0.0, rho=1.0, at=part.at) for part in self.parts
        )
        return Composite(parts).faults(unit)

    def material_faults(self, key: str) -> Iterator[str]:
        """Faults of the materials of the section at `key`."""
        for number, part in enumerate(self.parts, start=1):
            name, material = f"{key}.parts[{number}].material", part.material
            if isinstance(material, str):
                yield (
                    f"{name} = {shown(material)}: must be the name of one of [materials], or a "
                    "table"
                )
                continue
            if material.rho is None:
                yield f"{name}.rho: missing; the mass of the leg follows from the densities"
            if material.G is not None:
                yield f"{name}.G: does not belong to a composite; its materials are isotropic"
            if material.loss:
                yield f"{name}.loss: does not belong to a composite; give the loss of the leg"

    @property
    def section(self) -> Composite:
        """Composite section of the parts, whose materials must be resolved and have no faults."""
        return Composite(
            tuple(
                CompositePart(part.section, material.E, material.nu, material.rho, part.at)
                for part in self.parts
                if isinstance(material := part.material, MaterialEntry) and material.rho is not None
            )
        )


# Section with materials of its own, as described in a robot file, before it is built.
OwnMaterials: TypeAlias = CompositeParts | LaminateWall


@dataclass(frozen=True)
class SectionRule(Rule):
    """Rule for a cross-section: a shape of `lumped.sections` with its dimensions in `unit`.

    `shapes` are the names of the allowed shapes. Relations between dimensions are checked by the
    shape itself.
    """

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

    def read(self, value: Any) -> Any:
        return _shape_table(value["shape"], self.unit).read(value)

    def within(self, value: Any, key: str) -> Iterator[tuple[str, Rule, Any]]:
        if isinstance(value, dict):
            yield from _shape_table(value["shape"], self.unit).within(value, key)

    def in_unit(self, unit: UnitOfLength, moves: Sequence[str]) -> Self:  # noqa: ARG002
        return replace(self, unit=unit)


def _section(shape: str, **values: Any) -> Section | OwnMaterials:
    """Section from the name of its shape and the values of its keys.

    A composite or laminate is returned as described, because its materials may be names.
    """
    match SHAPES[shape]:
        case kind if kind is Composite:
            return CompositeParts(values["parts"])
        case kind if kind is LaminateTube or kind is LaminateBox:
            ply, layers = values.pop("ply") or PlyEntry(), values.pop("layers")
            return LaminateWall(kind, ply, layers, values)
        case kind:
            return kind(**values)


# Shapes with an outline of one material.
_PLAIN_SHAPES = tuple(
    shape
    for shape, kind in SHAPES.items()
    if not issubclass(kind, Composite | Laminate | SectionProperties)
)


@dataclass(frozen=True, kw_only=True)
class CompositePartEntry:
    """Part of a composite section, with its shape, material and position."""

    section: Annotated[Section, Value(SectionRule(shapes=_PLAIN_SHAPES), "shape of the part")]
    material: Annotated[
        MaterialEntry | str, Value(MATERIAL_OR_NAME, "a name in [materials], or a table")
    ]
    at: Annotated[
        tuple[float, float], Value(_CORNER, "position [y, z] of the shape's own origin")
    ] = (0.0, 0.0)


_PARTS = Several(table_of(CompositePartEntry), most=20, least=2)
_LAMINATE_KEYS = (
    Key("ply", PLY, "keys of all layers that do not give their own"),
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
        Key("Iw", _WARPING, "warping constant about the shear centre; `check` alone uses it"),
    ),
    "polygon": (
        needed("outline", _CORNERS, "its corners [y, z] in order, from any origin"),
        Key("holes", Several(_CORNERS, most=20), "the corners of each hole", default=()),
    ),
}


def _shape_table(shape: str, unit: UnitOfLength) -> TableRule:
    """Rule for the table of a section of the given `shape` with dimensions in `unit`."""
    kind: Any = SHAPES[shape]
    sizes = (
        needed(field.name, _SIZE, "outer dimension or wall thickness") for field in fields(kind)
    )
    keys = _OWN_KEYS.get(shape) or tuple(sizes)
    if issubclass(kind, Laminate):
        keys = (*(key for key in keys if key.name != "layers"), *_LAMINATE_KEYS)
    if kind is Composite:
        keys = (needed("parts", _PARTS, "parts that touch along edges, each of one material"),)
    table = TableRule(_section, needed("shape", OneOf((shape,)), "kind of section"), *keys)
    return table.in_unit(unit, ())


# Point of a leg's line, or share of the line's length.
_PLACE_ON_LINE = Either(
    POINT_NAME, Number(least=0.0, most=1.0, high="this is a share of the line's length, not in m")
)


class Station(NamedTuple):
    """Section of a leg at a position along its centre line.

    `at` is the name of a point of the line, or a fraction (0 to 1) of the line's length.
    """

    at: str | float
    section: Section


@dataclass(frozen=True)
class StationRule(SectionRule):
    """Rule for the section of a leg at a position `at` along its line, read as a `Station`."""

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

    def read(self, value: Any) -> Station:
        rest = {name: entry for name, entry in value.items() if name != "at"}
        return Station(_PLACE_ON_LINE.read(value["at"]), super().read(rest))

    def within(self, value: Any, key: str) -> Iterator[tuple[str, Rule, Any]]:
        if isinstance(value, dict):
            yield from _PLACE_ON_LINE.within(value["at"], f"{key}.at")
            rest = {name: entry for name, entry in value.items() if name != "at"}
            yield from super().within(rest, key)
