"""What identification found, for people, for programs, and as a table for a robot file."""

import json
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.placing import leg_frame
from lumped.screws import turn
from validation.parts.identify import Identified

_COMPONENTS = ("x", "y", "z", "φx", "φy", "φz")


def as_text(found: Identified) -> str:
    """A page: mass, six numbers per interface with their uncertainties, frequencies, the table."""
    lines = [f"{found.part.path}: {found.part.size}", ""]
    counts = ", ".join(str(count) for count in found.unknowns)
    lines.append(
        f"meshes of {counts} unknowns; {found.elements} tetrahedra in the finest"
        if len(found.unknowns) > 1
        else f"one mesh, as given, of {counts} unknowns"
    )
    if found.straightened:
        lines[-1] += f", {found.straightened} of them straightened"
    centre = ", ".join(f"{x + 0.0:.6g}" for x in found.centre.round(9))
    lines.append(f"mass {found.total:.6g} kg, centre ({centre}) m")
    if found.deviation is not None:
        lines[-1] += f", volume {found.deviation:+.1e} of the exact one"
    lines.append(
        "inertia about it (kg m²): "
        + " ".join(
            f"{found.inertia[i, j] + 0.0:.4g}"
            for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
        )
        + "  (xx yy zz xy xz yz)"
    )
    lines.append("")
    for interface in found.interfaces:
        place = ", ".join(f"{x + 0.0:.6g}" for x in interface.point.round(9))
        faces = ", ".join(map(str, interface.faces))
        lines.append(
            f"{interface.name}: faces {faces} at ({place}) m, {interface.coupling}; "
            f"{interface.because}"
        )
    lines += ["", *_compliances(found), "", *_frequencies(found), "", toml(found)]
    return "\n".join(lines)


def _percent(share: float) -> str:
    return f"{100.0 * share:8.3f} %" if np.isfinite(share) else "       –  "


def _compliances(found: Identified) -> list[str]:
    first = found.interfaces[0].name
    if len(found.interfaces) == 1:
        return [f"only {first}: no stiffness between interfaces"]
    lines = [
        f"compliance with {first} clamped, axes of the file (m/N, rad/(N m)); of the meshes; "
        "averaged less rigid"
    ]
    for k, interface in enumerate(found.interfaces[1:]):
        for i, component in enumerate(_COMPONENTS):
            row = 6 * k + i
            value = found.compliance[row, row]
            lines.append(
                f"  {interface.name} {component:<2} {value:12.5e}  "
                f"± {_percent(found.compliance_refinement[row, row] / value)}  "
                f"{_percent(found.compliance_bracket[row, row] / value)}"
            )
    return lines


def _frequencies(found: Identified) -> list[str]:
    lines = [
        f"frequencies with {found.interfaces[0].name} clamped (Hz); {found.counted} counted below "
        f"{found.counted_below:.6g} Hz, none missing; as above"
    ]
    rows = zip(found.frequencies, found.frequency_refinement, found.frequency_bracket, strict=True)
    for number, (value, refinement, bracket) in enumerate(rows, start=1):
        lines.append(
            f"  {number:<4} {value:12.2f}  ± {_percent(refinement / value)}  "
            f"{_percent(bracket / value)}"
        )
    return lines


def toml(found: Identified) -> str:
    """The body as a table for a robot file of schema 2: a leg of two interfaces by its 6×6."""
    name = found.part.path.stem
    if len(found.interfaces) != 2:
        return (
            f"# {name} has {len(found.interfaces)} interfaces: a leg known by a 6×6 has two. Name "
            "the file itself in a robot (step = …), or take all numbers from --json or --out."
        )
    first, second = found.interfaces
    axes = leg_frame(first.point, second.point).rotation
    block = turn(axes)
    compliance = block.T @ found.compliance @ block
    rows = ",\n".join(
        "    [" + ", ".join(f"{value: .9e}" for value in row) + "]" for row in compliance
    )
    up = ", ".join(f"{x + 0.0:.12g}" for x in axes[:, 2].round(12))
    return (
        f"[bodies.{name}]  # identified from {found.part.path.name}\n"
        f'from = "{first.name}"\nto = "{second.name}"\n'
        f"up = [{up}]  # in the axes of the file\n"
        f"mass = {found.total:.9g}\ncompliance = [\n{rows},\n]"
    )


def as_json(found: Identified) -> str:
    """Everything for programs: SI, the file's axes; null where there is no number."""

    def plain(values: Array) -> Any:
        entries = values.astype(object)
        entries[~np.isfinite(values)] = None
        return entries.tolist()

    document = {
        "schema": 1,
        "part": str(found.part.path),
        "unit": found.part.unit,
        "interfaces": [
            {
                "name": i.name,
                "faces": list(i.faces),
                "point": i.point.tolist(),
                "coupling": i.coupling,
                "because": i.because,
            }
            for i in found.interfaces
        ],
        "unknowns": list(found.unknowns),
        "straightened": found.straightened,
        "mass": found.total,
        "centre": found.centre.tolist(),
        "inertia": found.inertia.tolist(),
        "volume_deviation": found.deviation,
        "stiffness": found.stiffness.tolist(),
        "condensed_mass": found.mass.tolist(),
        "compliance": found.compliance.tolist(),
        "frequencies": found.frequencies.tolist(),
        "modes_counted": {"count": found.counted, "below": found.counted_below},
        "uncertainty": {
            "compliance": plain(found.compliance_refinement),
            "frequencies": plain(found.frequency_refinement),
        },
        "bracket": {
            "compliance": found.compliance_bracket.tolist(),
            "frequencies": found.frequency_bracket.tolist(),
        },
    }
    return json.dumps(document, ensure_ascii=False, allow_nan=False)


def as_arrays(found: Identified) -> dict[str, Array]:
    """The arrays of an .npz file."""
    return {
        "stiffness": found.stiffness,
        "mass": found.mass,
        "compliance": found.compliance,
        "frequencies": found.frequencies,
        "points": np.array([i.point for i in found.interfaces]),
        "centre": found.centre,
        "inertia": found.inertia,
        "total": np.array(found.total),
        "compliance_uncertainty": found.compliance_refinement,
        "compliance_bracket": found.compliance_bracket,
        "frequency_uncertainty": found.frequency_refinement,
        "frequency_bracket": found.frequency_bracket,
    }
