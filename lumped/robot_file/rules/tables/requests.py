"""Tables of loads, responses, limits, measured values, modal tests and uncertain inputs."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal, TypeAlias, get_args

from lumped.acceptance.quantities import UNIT_LOADS
from lumped.acceptance.requirement import (
    MODEL_KINDS,
    MOST_ELEMENTS,
    SMALLEST_MEASURED,
    AgreementLimits,
    Requirement,
    SolidEnds,
)
from lumped.mechanism.body import ByCylinder, ByPlane
from lumped.robot_file.rules.rule import (
    Either,
    Key,
    Named,
    Number,
    OneOf,
    Several,
    TableRule,
    Text,
    Value,
    needed,
    table_of,
)
from lumped.robot_file.rules.tables.bodies import (
    IN_PLANE,
    ON_CYLINDER,
    FaceName,
    FaceNumbers,
    cylinder_table,
    plane_table,
)
from lumped.robot_file.rules.tables.values import (
    BODY_NAME,
    COUNT,
    DIRECTION,
    FILE,
    IN_MM,
    LOSS,
    MODES,
    MOST_POSES,
    NAME,
    POINT,
    POINT_NAME,
    POSE,
    SHARE,
    TEXT,
    Place,
    Triple,
)

# Forces (N) along and moments (N m) about the base axes.
Wrench: TypeAlias = tuple[float, float, float, float, float, float]

FORCE = Number("N or N m", least=-1e9, most=1e9)
# 1e5 m/s² is ten thousand times gravity. No tool moves at 1 km/s.
_PER_SECOND_SQUARED = Several(Number("m/s²", least=-1e5, most=1e5), 3)
_SPEED = Several(Number("m/s", least=-1e3, most=1e3, low=IN_MM, high=IN_MM), 3)
_THERE = "point of a body where the wrench acts; default: the tool"
_WHOSE = "body of `at`; default: that of the tool, else the first with that point"
# 1e9 N/m: beyond any load of a robot.
_PER_LENGTH = Several(Number("N/m or N m/m", least=-1e9, most=1e9), 6)
_STATION = Number("m", least=0.0, most=100.0, high=IN_MM)
# 1 GPa: above the strength of most materials, and far above any hydraulic or contact pressure.
_PRESSURE = Number("Pa", least=-1e9, most=1e9)
# 3 kHz is ten times the first natural frequency of stiff machines. Bodies of a Delta robot that are
# accurate up to 3 kHz are computed in half a minute, up to 10 kHz in more than three minutes.
_FREQUENCY = Number("Hz", above=0.0, most=3e3, high="is this in 1/min?")
# 10 cm, because accepted tool errors are of the order of micrometres.
_DISPLACEMENT = Number("m", above=0.0, most=0.1, high="is this in µm?")
_ELEMENTS = Number(least=1, most=MOST_ELEMENTS, whole=True)
# From below the resolution of instruments to above the compliance of structures. Zero is refused
# elsewhere, because errors are relative to the value.
_MEASURED = Number(least=-1e15, most=1e15)
_SPREAD = Number(above=0.0, most=1e15, slip=SMALLEST_MEASURED)
_TEST_LOAD = Number("N or N m", above=0.0, most=1e9, slip=1e-12)
_NODE = Text(r"[1-9][0-9]{0,8}", "a number of up to nine digits")


@dataclass(frozen=True, kw_only=True)
class LineEntry:
    """Distributed load along a leg, part of a load case."""

    leg: Annotated[str, Value(BODY_NAME, "leg with a section, or with a 6×6 compliance")]
    wrench: Annotated[Wrench, Value(_PER_LENGTH, "forces and moments per length at `from`")]
    end_wrench: Annotated[
        Wrench | None,
        Value(_PER_LENGTH, "forces and moments per length at `to`; default: `wrench`"),
    ] = None
    from_: Annotated[
        float | None,
        Value(_STATION, "distance along the leg where it begins; default: the root"),
    ] = None
    to: Annotated[
        float | None, Value(_STATION, "distance along the leg where it ends; default: the tip")
    ] = None
    axes: Annotated[
        Literal["base", "leg"],
        Value(OneOf(("base", "leg")), "axes of the forces and moments"),
    ] = "base"


@dataclass(frozen=True, kw_only=True)
class PressureEntry:
    """Pressure on faces of a CAD part, part of a load case.

    Exactly one of `faces`, `name`, `cylinder` and `plane` selects the faces.
    """

    body: Annotated[str, Value(BODY_NAME, "CAD part whose faces it acts on")]
    pressure: Annotated[float, Value(_PRESSURE, "pressure, positive into the body")]
    faces: FaceNumbers = None
    name: FaceName = None
    cylinder: Annotated[
        ByCylinder | None,
        Value(
            cylinder_table(
                Key("point", POINT, "a point on its axis, needed if several have this radius")
            ),
            ON_CYLINDER,
        ),
    ] = None
    plane: Annotated[
        ByPlane | None,
        Value(
            plane_table(needed("point", POINT, "a point on it, axes of the part's file")), IN_PLANE
        ),
    ] = None


@dataclass(frozen=True, kw_only=True)
class LoadEntry:
    """Load case (table [[loads]]): the wrenches, accelerations and pressures that act together."""

    name: Annotated[str, Value(NAME, "name; judged as load:NAME")]
    wrench: Annotated[Wrench | None, Value(Several(FORCE, 6), "forces and moments, base axes")] = (
        None
    )
    file: Annotated[
        str | None,
        Value(FILE, "CSV file with a wrench for each pose of the path, instead of `wrench`"),
    ] = None
    at: Annotated[str | None, Value(POINT_NAME, _THERE)] = None
    body: Annotated[str | None, Value(BODY_NAME, _WHOSE)] = None
    lines: Annotated[
        tuple[LineEntry, ...] | None,
        Value(Several(table_of(LineEntry), most=100), "loads along legs"),
    ] = None
    pressures: Annotated[
        tuple[PressureEntry, ...] | None,
        Value(Several(table_of(PressureEntry), most=100), "pressures on faces of CAD parts"),
    ] = None
    gravity: Annotated[
        Triple | None,
        Value(_PER_SECOND_SQUARED, "acceleration of gravity on all bodies, base axes"),
    ] = None
    acceleration: Annotated[
        Triple | None,
        Value(_PER_SECOND_SQUARED, "acceleration of the tool; inertia of all bodies"),
    ] = None
    speed: Annotated[
        Triple | None, Value(_SPEED, "speed of the tool; inertia forces with its square")
    ] = None


@dataclass(frozen=True, kw_only=True)
class DampingEntry:
    """Damping of all modes (table [damping]), besides the loss factors of bodies and joints."""

    ratio: Annotated[float, Value(LOSS, "damping ratio of every mode")]


@dataclass(frozen=True, kw_only=True)
class MotionEntry:
    """Displacement that is computed as the response to a harmonic force: point and direction."""

    point: Annotated[str | None, Value(POINT_NAME, "point whose displacement is computed")]
    body: Annotated[
        str | None,
        Value(BODY_NAME, "body of `point`; default: that of the tool, else the first with it"),
    ] = None
    direction: Annotated[
        Triple | None,
        Value(DIRECTION, "direction of the displacement; default: that of the force"),
    ] = None


@dataclass(frozen=True, kw_only=True)
class ResponseEntry:
    """Response to a harmonic force (table [[responses]])."""

    name: Annotated[str, Value(NAME, "name; judged as response:NAME")]
    direction: Annotated[
        Triple, Value(DIRECTION, "direction of the force and of the displacement, base axes")
    ]
    from_: Annotated[float, Value(_FREQUENCY, "first frequency")]
    to: Annotated[float, Value(_FREQUENCY, "last frequency")]
    count: Annotated[
        int, Value(Number(least=2, most=MOST_POSES, whole=True), "number of frequencies")
    ] = 400
    frequency: Annotated[
        float | None,
        Value(_FREQUENCY, "frequency at which the response is judged, besides its peak"),
    ] = None
    at: Annotated[
        float | str | None,
        Value(
            Either(_FREQUENCY, POINT_NAME),
            "point where the force acts; default: the tool. A number is the `frequency`",
        ),
    ] = None
    body: Annotated[str | None, Value(BODY_NAME, _WHOSE)] = None
    of: Annotated[
        str | MotionEntry | None,
        Value(
            Either(POINT_NAME, table_of(MotionEntry)),
            "point whose displacement is computed, or a table; default: where the force acts",
        ),
    ] = None

    @property
    def point(self) -> str | None:
        """Name of the point where the force acts. None for the tool."""
        return self.at if isinstance(self.at, str) else None

    @property
    def judged_frequency(self) -> float | None:
        """Frequency (Hz) at which the response is judged besides its peak. None without one."""
        number = self.at if isinstance(self.at, float) else None
        return number if self.frequency is None else self.frequency

    @property
    def motion(self) -> MotionEntry:
        """Displacement that is computed as the response.

        Its point is None if it is the point where the force acts.
        """
        return self.of if isinstance(self.of, MotionEntry) else MotionEntry(point=self.of)


@dataclass(frozen=True, kw_only=True)
class AcceptEntry:
    """Accepted errors of models (table [accept]), as in `Requirement`.

    `limits` are relative limits on deflections under single unit loads, by the name of the load
    ("x" … "phi_z", "any_force").
    """

    deflection: float
    displacement: float | None
    frequency: float
    response: float
    modes: int
    rely: tuple[str, ...]
    limits: Mapping[str, float]


def _accept_entry(**values: Any) -> AcceptEntry:
    own = {load.name: values.pop(load.name) for load in UNIT_LOADS}
    limits = {name: limit for name, limit in own.items() if limit is not None}
    return AcceptEntry(**values, limits=limits)


ACCEPT = TableRule(
    _accept_entry,
    Key(
        "deflection",
        SHARE,
        "largest relative error of deflections",
        default=Requirement.deflection,
    ),
    Key("displacement", _DISPLACEMENT, "largest error under [[loads]], instead of `deflection`"),
    Key(
        "frequency",
        SHARE,
        "largest relative error of frequencies and their order",
        default=Requirement.frequency,
    ),
    Key("response", SHARE, "largest relative error of responses", default=Requirement.response),
    Key("modes", MODES, "number of frequencies that are judged", default=Requirement.modes),
    Key("rely", Several(OneOf(MODEL_KINDS)), "models whose inadequacy is exit code 1", default=()),
    *(Key(load.name, SHARE, f"limit for {load}, instead of `deflection`") for load in UNIT_LOADS),
)
_FINE = "largest relative error of f1 to f4 and of deflections with `elements`"
_UNEXPLAINED = "unexplained difference from solids of the same legs"
_SOLID_ENDS = 'end faces of the solids; "as given": `ends` of each leg, rigid without it'
AGREE = TableRule(
    AgreementLimits,
    Key(
        "elements",
        _ELEMENTS,
        "elements per leg, of segments and beams",
        default=AgreementLimits.elements,
    ),
    Key("convergence", SHARE, _FINE, default=AgreementLimits.convergence),
    Key("compliance", SHARE, f"{_UNEXPLAINED}: deflections", default=AgreementLimits.compliance),
    Key("frequency", SHARE, f"{_UNEXPLAINED}: f1 to f4", default=AgreementLimits.frequency),
    Key("ends", OneOf(get_args(SolidEnds)), _SOLID_ENDS, default=AgreementLimits.ends),
)


@dataclass(frozen=True, kw_only=True)
class MeasuredEntry:
    """Measured value (table [[measured]] or row of a CSV file)."""

    quantity: Annotated[
        str, Value(TEXT, "x y z phi_x phi_y phi_z, f1 f2 …, leg1.c22 … or response:NAME …")
    ]
    value: Annotated[
        float,
        Value(_MEASURED, "value: m or rad under `load`, Hz, or SI of a compliance or response"),
    ]
    uncertainty: Annotated[float, Value(_SPREAD, "standard uncertainty, in the unit of the value")]
    source: Annotated[str, Value(TEXT, "origin of the value")]
    pose: Annotated[
        tuple[float, ...], Value(POSE, "pose of the measurement, in the order of the moves")
    ] = ()
    load: Annotated[float, Value(_TEST_LOAD, "force or moment of the measurement")] = 1.0


MEASURED = table_of(MeasuredEntry)
MEASURED_VALUES = Several(MEASURED)


@dataclass(frozen=True, kw_only=True)
class NodeEntry:
    """Node of a modal test on a body: its position, and the directions of its axes."""

    body: Annotated[str, Value(NAME, "body of the node")]
    at: Annotated[
        Place,
        Value(
            Either(NAME, POINT),
            "a point of the body, or the position in the reference posture",
        ),
    ]
    x: Annotated[Triple, Value(DIRECTION, "direction of the sensor's x axis")] = (1.0, 0.0, 0.0)
    y: Annotated[Triple, Value(DIRECTION, "direction of its y axis, made normal to x")] = (
        0.0,
        1.0,
        0.0,
    )


@dataclass(frozen=True, kw_only=True)
class HammerEntry:
    """Modal test (table [hammer]): nodes by number, pose, and relative standard uncertainties."""

    nodes: Annotated[
        Mapping[str, NodeEntry],
        Value(Named(_NODE, table_of(NodeEntry)), "nodes by their numbers in the universal file"),
    ]
    pose: Annotated[
        tuple[float, ...] | None,
        Value(POSE, "pose of the test; default: the reference posture"),
    ] = None
    # 0.2 % is a typical change of frequencies if robot and sensors are mounted again.
    uncertainty: Annotated[
        float,
        Value(SHARE, "relative standard uncertainty of frequencies, besides scatter"),
    ] = 0.002
    calibration: Annotated[
        float, Value(SHARE, "relative standard uncertainty of responses, besides scatter")
    ] = 0.01
    averages: Annotated[int, Value(COUNT, "number of blows that coherence is averaged over")] = 1


@dataclass(frozen=True, kw_only=True)
class InputUncertaintyEntry:
    """Uncertainty of a number or a matrix in the file (table [[input_uncertainty]])."""

    key: Annotated[str, Value(TEXT, 'a number or matrix of this file, such as "leg1.length"')]
    relative: Annotated[float, Value(SHARE, "relative standard uncertainty")]


Loads: TypeAlias = Annotated[
    tuple[LoadEntry, ...], Value(Several(table_of(LoadEntry)), "load cases, each judged")
]
Damping: TypeAlias = Annotated[
    DampingEntry | None,
    Value(table_of(DampingEntry), "damping of all modes, besides loss factors"),
]
Responses: TypeAlias = Annotated[
    tuple[ResponseEntry, ...],
    Value(Several(table_of(ResponseEntry)), "responses to harmonic forces, each judged"),
]
Accept: TypeAlias = Annotated[AcceptEntry | None, Value(ACCEPT, "limits on the errors of models")]
Agree: TypeAlias = Annotated[
    AgreementLimits | None,
    Value(AGREE, "limits on differences between formulations of the same legs"),
]
MeasuredValues: TypeAlias = Annotated[
    tuple[MeasuredEntry, ...], Value(MEASURED_VALUES, "measured values")
]
Hammer: TypeAlias = Annotated[
    HammerEntry | None,
    Value(table_of(HammerEntry), "nodes and pose of a modal test, see `--measured`"),
]
InputUncertainties: TypeAlias = Annotated[
    tuple[InputUncertaintyEntry, ...],
    Value(Several(table_of(InputUncertaintyEntry)), "uncertainties of numbers in this file"),
]
