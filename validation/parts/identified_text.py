"""Results of an identification as text, JSON, arrays and a table for a robot file.

Input: an `Identified` part, or a `FreePart` without supports. Output: text, JSON (schema 1) or
arrays, in SI units and the axes of the file.
"""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import msgspec
import numpy as np
from msgspec import UNSET, UnsetType

from lumped.arrays import Array
from lumped.mechanism.placing import leg_frame
from lumped.screws import turn
from lumped.text import counted
from validation.parts.free_modes import FreePart
from validation.parts.identify import Identified
from validation.record_fields import CountRecord, finite_items, json_text
from validation.uncertainty.refinement import Accuracy

_COMPONENTS = ("x", "y", "z", "φx", "φy", "φz")
# Arrays with equal names in JSON and .npz files. For arrays with uncertainties: the word with which
# the names of the uncertainties begin in .npz files.
_ARRAYS = ("stiffness", "compliance", "frequencies", "centre", "inertia")
_UNCERTAIN = {"compliance": "compliance", "frequencies": "frequency"}


class InterfaceRecord(msgspec.Struct, frozen=True, kw_only=True):
    """JSON object of an interface. `because` is the reason why its faces were chosen."""

    name: str
    faces: Sequence[int]
    point: Array
    coupling: str
    because: str


class IdentifiedRecord(msgspec.Struct, frozen=True, kw_only=True):
    """JSON document of `identify`, in SI units and the axes of the file.

    Arrays are nested lists, with None for a number that is unknown. `uncertainty` and `bracket`:
    half-widths due to meshes, and changes from rigid to averaged interfaces, of compliance and
    frequencies.
    """

    schema: Literal[1] = 1
    part: str
    unit: str
    interfaces: Sequence[InterfaceRecord]
    unknowns: tuple[int, ...]
    straightened: int
    mass: float
    volume_deviation: float | None
    accuracy: Accuracy | UnsetType = UNSET
    condensed_mass: Any
    stiffness: Any
    compliance: Any
    frequencies: Any
    centre: Any
    inertia: Any
    modes_counted: CountRecord
    uncertainty: Mapping[str, Any]
    bracket: Mapping[str, Any]


class FreePartRecord(msgspec.Struct, frozen=True, kw_only=True):
    """JSON document of `identify --free`, in SI units."""

    schema: Literal[1] = 1
    part: str
    unit: str
    unknowns: tuple[int, ...]
    straightened: int
    mass: float
    accuracy: Accuracy | UnsetType = UNSET
    rigid: int
    frequencies: Array
    centre: Array
    inertia: Array
    modes_counted: CountRecord
    # Half-widths due to meshes, with None for an unknown one.
    uncertainty: Mapping[str, Any]


def as_text(part: Identified | FreePart, accuracy: Accuracy | None = None) -> str:
    """Mass, and compliances and frequencies with their uncertainties, as text.

    For a part with interfaces, the last lines are a TOML table for a robot file. `accuracy`: result
    of the refinement by --accuracy, None without this option.
    """
    counts = ", ".join(map(str, part.unknowns))
    meshes = f"meshes of {counts} unknowns; {part.elements} tetrahedra in the finest"
    if len(part.unknowns) == 1:
        meshes = f"one mesh, from the file, of {counts} unknowns"
    mass = f"mass {part.total:.6g} kg, centre ({_coordinates(part.centre)}) m"
    if isinstance(part, FreePart):
        details = _free_frequencies(part)
    else:
        meshes, mass = meshes + _remarks_on_meshes(part), mass + _volume_deviation(part)
        details = _between_interfaces(part)
    heading = [f"{part.part.path}: {part.part.size}", "", meshes]
    return "\n".join([*heading, *([accuracy.text] if accuracy else []), mass, *details])


def _free_frequencies(part: FreePart) -> list[str]:
    rows = zip(part.frequencies, part.frequency_refinement, strict=True)
    return [
        "",
        f"rigid-body motions, counted and omitted: {part.rigid}",
        f"frequencies without supports (Hz); {part.counted} counted below "
        f"{part.counted_below:.6g} Hz, none missing; ± half-width of the meshes",
        *(
            f"  {number:<4} {value:12.2f}  ± {_percent(half_width / value)}"
            for number, (value, half_width) in enumerate(rows, start=1)
        ),
    ]


def _remarks_on_meshes(identified: Identified) -> str:
    remarks = ""
    if identified.straightened:
        remarks += f", {identified.straightened} of them straightened"
    if not identified.by_curvature:
        remarks += "; element sizes do not follow the curvature, because gmsh fails with such sizes"
    return remarks


def _volume_deviation(identified: Identified) -> str:
    if identified.deviation is None:
        return ""
    text = f", volume differs by {identified.deviation:+.1e} from the exact one"
    exact = identified.part.exact
    if exact and exact.error:
        text += f" (integrated over its splines to {exact.error / exact.volume:.0e})"
    return text


def _between_interfaces(identified: Identified) -> list[str]:
    """Inertia, interfaces, compliances, frequencies and TOML table of a part with interfaces."""
    entries = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
    inertia = " ".join(f"{identified.inertia[entry] + 0.0:.4g}" for entry in entries)
    interfaces = [
        f"{interface.name}: faces {', '.join(map(str, interface.faces))} at "
        f"({_coordinates(interface.point)}) m, {interface.coupling}; {interface.reason}"
        for interface in identified.interfaces
    ]
    return [
        f"inertia about the centre (kg m²): {inertia}  (xx yy zz xy xz yz)",
        *("", *interfaces),
        *("", *_compliances(identified)),
        *("", *_frequencies(identified)),
        *("", toml(identified)),
    ]


def _coordinates(point: Array) -> str:
    return ", ".join(f"{x + 0.0:.6g}" for x in point.round(9))


def _percent(share: float) -> str:
    return f"{100.0 * share:8.3f} %" if np.isfinite(share) else "       –  "


def _compliances(identified: Identified) -> list[str]:
    first = identified.interfaces[0].name
    if len(identified.interfaces) == 1:
        return [f"{first} is the only interface, so that there is no stiffness between interfaces"]
    lines = [
        f"compliance with {first} clamped, axes of the file (m/N, rad/(N m)); ± half-width of the "
        "meshes; averaged minus rigid interfaces; both relative"
    ]
    names = [
        f"{interface.name} {axis:<2}"
        for interface in identified.interfaces[1:]
        for axis in _COMPONENTS
    ]
    diagonals = map(
        np.diag,
        (identified.compliance, identified.compliance_refinement, identified.compliance_bracket),
    )
    return lines + [
        f"  {name} {value:12.5e}  ± {_percent(half_width / value)}  {_percent(bracket / value)}"
        for name, value, half_width, bracket in zip(names, *diagonals, strict=True)
    ]


def _frequencies(identified: Identified) -> list[str]:
    counted = (
        "not counted, because no factor fits the memory: some may be missing"
        if identified.counted_below is None
        else f"{identified.counted} counted below {identified.counted_below:.6g} Hz, none missing"
    )
    heading = (
        f"frequencies with {identified.interfaces[0].name} clamped (Hz); {counted}; columns as "
        "above"
    )
    rows = zip(
        identified.frequencies,
        identified.frequency_refinement,
        identified.frequency_bracket,
        strict=True,
    )
    return [heading] + [
        f"  {number:<4} {value:12.2f}  "
        f"± {_percent(half_width / value)}  {_percent(bracket / value)}"
        for number, (value, half_width, bracket) in enumerate(rows, start=1)
    ]


def toml(identified: Identified) -> str:
    """TOML table for a robot file of schema 2, with the part as a leg specified by its 6×6.

    If the part does not have exactly two interfaces, the result is a TOML comment that names the
    alternatives.
    """
    name = identified.part.path.stem
    if len(identified.interfaces) != 2:
        number = counted(len(identified.interfaces), "interface")
        return (
            f"# {name} has {number}, but a leg specified by a 6×6 compliance has two. Enter the "
            "CAD file in the robot file (step = …), or use the values of --json or --out."
        )
    first, second = identified.interfaces
    axes = leg_frame(first.point, second.point).rotation
    rotation = turn(axes)
    compliance = rotation.T @ identified.compliance @ rotation
    rows = ",\n".join(
        "    [" + ", ".join(f"{value: .9e}" for value in row) + "]" for row in compliance
    )
    up = ", ".join(f"{x + 0.0:.12g}" for x in axes[:, 2].round(12))
    return (
        f"[bodies.{name}]  # identified from {identified.part.path.name}\n"
        f'from = "{first.name}"\nto = "{second.name}"\n'
        f"up = [{up}]  # in the axes of the file\n"
        f"mass = {identified.total:.9g}\ncompliance = [\n{rows},\n]"
    )


def as_json(part: Identified | FreePart, accuracy: Accuracy | None = None) -> str:
    """All results as JSON (schema 1), in SI units and file axes. null for an unknown number.

    `accuracy`: result of the refinement by --accuracy, None without this option.
    """
    if isinstance(part, FreePart):
        return json_text(_free_record(part, accuracy or UNSET))
    return json_text(_identified_record(part, accuracy or UNSET))


def _identified_record(identified: Identified, accuracy: Accuracy | UnsetType) -> IdentifiedRecord:
    arrays = {name: finite_items(values) for name, values in as_arrays(identified).items()}
    return IdentifiedRecord(
        part=str(identified.part.path),
        unit=identified.part.unit,
        interfaces=[
            InterfaceRecord(
                name=interface.name,
                faces=interface.faces,
                point=interface.point,
                coupling=interface.coupling,
                because=interface.reason,
            )
            for interface in identified.interfaces
        ],
        unknowns=identified.unknowns,
        straightened=identified.straightened,
        mass=identified.total,
        volume_deviation=identified.deviation,
        accuracy=accuracy,
        condensed_mass=arrays["mass"],
        **{name: arrays[name] for name in _ARRAYS},
        modes_counted=CountRecord(identified.counted, identified.counted_below),
        uncertainty=_uncertain(arrays, "uncertainty"),
        bracket=_uncertain(arrays, "bracket"),
    )


def _free_record(part: FreePart, accuracy: Accuracy | UnsetType) -> FreePartRecord:
    return FreePartRecord(
        part=str(part.part.path),
        unit=part.part.unit,
        unknowns=part.unknowns,
        straightened=part.straightened,
        mass=part.total,
        accuracy=accuracy,
        rigid=part.rigid,
        frequencies=part.frequencies,
        centre=part.centre,
        inertia=part.inertia,
        modes_counted=CountRecord(part.counted, part.counted_below),
        uncertainty={"frequency": finite_items(part.frequency_refinement)},
    )


def _uncertain(arrays: Mapping[str, Any], kind: str) -> dict[str, Any]:
    return {quantity: arrays[f"{key}_{kind}"] for quantity, key in _UNCERTAIN.items()}


def as_arrays(part: Identified | FreePart) -> dict[str, Array]:
    """Arrays for an .npz file, in SI units and the axes of the file."""
    if isinstance(part, FreePart):
        arrays = {name: getattr(part, name) for name in ("frequencies", "centre", "inertia")}
    else:
        arrays = {name: getattr(part, name) for name in ("mass", *_ARRAYS)} | {
            "points": np.array([interface.point for interface in part.interfaces]),
            "compliance_uncertainty": part.compliance_refinement,
            "compliance_bracket": part.compliance_bracket,
            "frequency_bracket": part.frequency_bracket,
        }
    shared = {"total": np.array(part.total), "frequency_uncertainty": part.frequency_refinement}
    return arrays | shared
