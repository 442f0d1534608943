"""What a robot file may contain: its tables, keys, types, units and bounds (schema 1).

Bounds that only catch wrong units are wide: nothing that has been built lies outside, and the
usual mistake (millimetres, gigapascals, a stiffness for a compliance) does.
"""

from dataclasses import dataclass
from typing import Annotated, Literal, TypeAlias

import msgspec
from msgspec import Meta, Struct

from lumped.acceptance.requirement import MODEL_KINDS, MOST_MODES, SMALLEST_SHARE, ModelKind
from lumped.legs import Ends


@dataclass(frozen=True)
class Bounds:
    """Unit of a number and what to ask the user whose number is `too_low` or `too_high`.

    Numbers above 0 but below `least` are slips of the exponent.
    """

    unit: str
    too_low: str = ""
    too_high: str = ""
    least: float = 0.0


@dataclass(frozen=True)
class SquareMatrix:
    """A symmetric matrix of `size` rows in `unit`; positive definite if it is a `compliance`."""

    size: int
    unit: str
    compliance: bool


def number(
    unit: str, too_low: str = "", too_high: str = "", least: float = 0.0
) -> dict[str, Bounds]:
    """What `Meta` carries of a number: its unit and what to ask where it is out of bounds."""
    return {"bounds": Bounds(unit, too_low, too_high, least)}


# 100 m: beyond any parallel robot with rigid legs, below a leg of 10 cm written in millimetres.
# 0.1 mm: shorter than the legs of flexure stages.
Length: TypeAlias = Annotated[
    float, Meta(gt=0.0, le=100.0, extra=number("m", too_high="is this in mm?", least=1e-4))
]
# Ten times as long: beyond any family of one design.
Ratio: TypeAlias = Annotated[
    float, Meta(gt=0.0, le=10.0, extra=number("", too_high="is this in percent?"))
]
# 10 m: a tool of 1 cm in millimetres is caught, no tool is as long.
Offset: TypeAlias = Annotated[
    float,
    Meta(ge=-10.0, le=10.0, extra=number("m", "is this in mm?", "is this in mm?")),
]
# 1e5 kg: a hundred tonnes in one leg or platform. 1 µg: less than the smallest silicon part.
Mass: TypeAlias = Annotated[
    float, Meta(gt=0.0, le=1e5, extra=number("kg", "", "is this in g?", least=1e-9))
]
# 1e4 N/m: a drive that gives way 0.1 m under the paper's 1000 N is not a drive.
# 1e15 N/m: stiffer than any; an "infinite" number would only cost digits.
ActuatorStiffness: TypeAlias = Annotated[
    float,
    Meta(
        ge=1e4,
        le=1e15,
        extra=number(
            "N/m", "is this in N/µm or kN/mm?", "more than any drive has; 1e15 is as good as rigid"
        ),
    ),
]
# 1 MPa: soft rubber; 2e12 Pa: above diamond (1.2e12). Moduli in GPa or MPa fall below.
YoungsModulus: TypeAlias = Annotated[
    float, Meta(ge=1e6, le=2e12, extra=number("Pa", "is this in GPa or MPa?", "above diamond"))
]
# G = E/2(1+ν) of the softest material above, rounded down; half of E's upper bound.
ShearModulus: TypeAlias = Annotated[
    float, Meta(ge=3e5, le=1e12, extra=number("Pa", "is this in GPa or MPa?", "above diamond"))
]
# The limits of isotropic elasticity; both open.
PoissonsRatio: TypeAlias = Annotated[float, Meta(gt=-1.0, lt=0.5, extra=number(""))]
# 25 kg/m³: structural foam; 25000 kg/m³: above osmium (22600).
Density: TypeAlias = Annotated[
    float, Meta(ge=25.0, le=25000.0, extra=number("kg/m³", "is this in g/cm³?", "above osmium"))
]
# 1: off by as much as there is.
Share: TypeAlias = Annotated[
    float, Meta(ge=SMALLEST_SHARE, le=1.0, extra=number("(0.05 is 5 %)", "", "is this in percent?"))
]
ModeCount: TypeAlias = Annotated[
    int, Meta(ge=1, le=MOST_MODES, extra={"allowed": f"a whole number from 1 to {MOST_MODES}"})
]
Models: TypeAlias = Annotated[
    list[ModelKind], Meta(extra={"allowed": f"an array of models, of {', '.join(MODEL_KINDS)}"})
]
Compliance: TypeAlias = Annotated[
    list[list[float]],
    Meta(extra={"matrix": SquareMatrix(6, "m/N, rad/N and rad/(N m)", compliance=True)}),
]
Inertia: TypeAlias = Annotated[
    list[list[float]], Meta(extra={"matrix": SquareMatrix(3, "kg m²", compliance=False)})
]
Name: TypeAlias = Annotated[
    str,
    Meta(
        min_length=1,
        max_length=100,
        pattern=r"^[^\x00-\x1f\x7f]+$",
        extra={"allowed": "a text of 1 to 100 characters on one line"},
    ),
]
Text: TypeAlias = Annotated[str, Meta(min_length=1, extra={"allowed": "a text"})]
# Shapes and their sizes are those of lumped.sections, which also says what is wrong with them.
SectionTable: TypeAlias = Annotated[dict[str, float | str], Meta(extra={"section": True})]


class Table(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A table of a robot file; its fields are the keys."""


class Geometry(Table, frozen=True):
    """[geometry]: distance `a` of the slides, `tool_offset` from B to the loaded point (m).

    `alpha`: how many times as long both legs are, the stroke kept (eqs 10, 11 of the paper).
    """

    a: Length
    alpha: Ratio = 1.0
    tool_offset: tuple[Offset, Offset, Offset] = (0.0, 0.0, 0.0)


class Platform(Table, frozen=True):
    """[platform]: `mass` (kg) at the loaded point."""

    mass: Mass


class Actuators(Table, frozen=True):
    """[actuators]: `stiffness` (N/m) of the simplified model."""

    stiffness: ActuatorStiffness


class Foot(Table, frozen=True):
    """[foot]: 6×6 `compliance` in robot axes; `inertia` (3×3, kg m²) is for the audit alone."""

    compliance: Compliance
    inertia: Inertia | None = None


class Tool(Table, frozen=True):
    """[tool]: 6×6 `compliance` in series at the loaded point, robot axes, unless not `active`."""

    compliance: Compliance
    active: bool = True


class MaterialTable(Table, frozen=True):
    """`material` of a leg: E, G (Pa), ν, ρ (kg/m³); without G isotropic, without ρ by the mass."""

    E: YoungsModulus
    nu: PoissonsRatio
    rho: Density | None = None
    G: ShearModulus | None = None


class LegTable(Table, frozen=True):
    """[leg1], [leg2]: `compliance` and `mass`, or `section` and `material`, maybe `ends`.

    `inertia` (3×3 at the mass centre, leg axes, kg m²) and `mass_centre` (m from the root) are
    for the audit alone.
    """

    length: Length
    ends: Ends | None = None
    mass: Mass | None = None
    compliance: Compliance | None = None
    section: SectionTable | None = None
    material: MaterialTable | None = None
    inertia: Inertia | None = None
    mass_centre: Offset | None = None


class Accept(Table, frozen=True):
    """[accept]: relative errors that are accepted of a model, and the models relied on.

    `deflection` for all static quantities, which x … phi_z and any_force override one by one;
    `frequency` for the first `modes` natural frequencies and their order.
    """

    deflection: Share = 0.05
    frequency: Share = 0.05
    modes: ModeCount = 4
    rely: Models = msgspec.field(default_factory=list)
    x: Share | None = None
    y: Share | None = None
    z: Share | None = None
    phi_x: Share | None = None
    phi_y: Share | None = None
    phi_z: Share | None = None
    any_force: Share | None = None


class Correction(Table, frozen=True):
    """One of [[corrections]]: at `key` the source prints `printed`, the file uses `used`."""

    key: Text
    printed: float
    used: float
    reason: Text


class MeasuredTable(Table, frozen=True):
    """One of [[measured]]; see `lumped.acceptance.measured` for what is allowed of its numbers."""

    quantity: Text
    value: float
    uncertainty: float
    source: Text
    pose: list[float] = msgspec.field(default_factory=list)
    load: float = 1.0


class InputUncertainty(Table, frozen=True):
    """One of [[input_uncertainty]]: relative standard uncertainty of what stands at `key`."""

    key: Text
    relative: Share


class RobotTables(Table, frozen=True):
    """A whole robot file."""

    schema: Literal[1, 2]
    name: Name
    type: Literal["biglide"]
    geometry: Geometry
    platform: Platform
    actuators: Actuators
    leg1: LegTable
    leg2: LegTable
    foot: Foot | None = None
    tool: Tool | None = None
    accept: Accept | None = None
    corrections: list[Correction] = msgspec.field(default_factory=list)
    measured: list[MeasuredTable] = msgspec.field(default_factory=list)
    input_uncertainty: list[InputUncertainty] = msgspec.field(default_factory=list)
