"""What identification found, for people, for programs, and as a table for a robot file."""

import json
from dataclasses import asdict
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.placing import leg_frame
from lumped.screws import turn
from lumped.text import counted
from validation.agreement.accuracy import Accuracy
from validation.parts.identify import Identified

_COMPONENTS = ("x", "y", "z", "φx", "φy", "φz")
# Arrays by their own names, and what is uncertain with the name of its arrays.
_AS_THEY_ARE = ("stiffness", "compliance", "frequencies", "centre", "inertia")
_UNCERTAIN = {"compliance": "compliance", "frequencies": "frequency"}


def as_text(found: Identified, reached: Accuracy | None = None) -> str:
    """A page: mass, six numbers per interface with their uncertainties, frequencies, the table."""
    counts = ", ".join(map(str, found.unknowns))
    meshes = f"meshes of {counts} unknowns; {found.elements} tetrahedra in the finest"
    if len(found.unknowns) == 1:
        meshes = f"one mesh, as given, of {counts} unknowns"
    if found.straightened:
        meshes += f", {found.straightened} of them straightened"
    if not found.by_curvature:
        meshes += "; without sizes from curvature, with which gmsh does not mesh it"
    mass = f"mass {found.total:.6g} kg, centre ({_place(found.centre)}) m"
    if found.deviation is not None:
        mass += f", volume {found.deviation:+.1e} of the exact one"
        if found.part.exact and found.part.exact.error:
            share = found.part.exact.error / found.part.exact.volume
            mass += f" (integrated over its splines to {share:.0e})"
    axes = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
    inertia = " ".join(f"{found.inertia[place] + 0.0:.4g}" for place in axes)
    lines = [
        *(f"{found.part.path}: {found.part.size}", "", meshes),
        *([reached.text] if reached else []),
        mass,
        f"inertia about it (kg m²): {inertia}  (xx yy zz xy xz yz)",
        "",
    ]
    lines += [
        f"{interface.name}: faces {', '.join(map(str, interface.faces))} at "
        f"({_place(interface.point)}) m, {interface.coupling}; {interface.because}"
        for interface in found.interfaces
    ]
    lines += ["", *_compliances(found), "", *_frequencies(found), "", toml(found)]
    return "\n".join(lines)


def _place(point: Array) -> str:
    return ", ".join(f"{x + 0.0:.6g}" for x in point.round(9))


def _percent(share: float) -> str:
    return f"{100.0 * share:8.3f} %" if np.isfinite(share) else "       –  "


def _compliances(found: Identified) -> list[str]:
    first = found.interfaces[0].name
    if len(found.interfaces) == 1:
        return [f"only {first}: no stiffness between interfaces"]
    lines = [
        f"compliance with {first} clamped, axes of the file (m/N, rad/(N m)); ± of the "
        "meshes; averaged minus rigid interfaces"
    ]
    names = [f"{one.name} {axis:<2}" for one in found.interfaces[1:] for axis in _COMPONENTS]
    diagonals = map(
        np.diag, (found.compliance, found.compliance_refinement, found.compliance_bracket)
    )
    return lines + [
        f"  {name} {value:12.5e}  ± {_percent(open_ / value)}  {_percent(bracket / value)}"
        for name, value, open_, bracket in zip(names, *diagonals, strict=True)
    ]


def _frequencies(found: Identified) -> list[str]:
    heading = (
        f"frequencies with {found.interfaces[0].name} clamped (Hz); {found.counted} counted below "
        f"{found.counted_below:.6g} Hz, none missing; columns as above"
    )
    rows = zip(found.frequencies, found.frequency_refinement, found.frequency_bracket, strict=True)
    return [heading] + [
        f"  {number:<4} {value:12.2f}  ± {_percent(open_ / value)}  {_percent(bracket / value)}"
        for number, (value, open_, bracket) in enumerate(rows, start=1)
    ]


def toml(found: Identified) -> str:
    """The body as a table for a robot file of schema 2: a leg of two interfaces by its 6×6."""
    name = found.part.path.stem
    if len(found.interfaces) != 2:
        held = counted(len(found.interfaces), "interface")
        return (
            f"# {name} has {held}: a leg known by a 6×6 has two. Name the file itself in a robot "
            "(step = …), or take all numbers from --json or --out."
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


def as_json(found: Identified, reached: Accuracy | None = None) -> str:
    """Everything for programs: SI, the file's axes; null where there is no number."""
    arrays = {name: _plain(values) for name, values in as_arrays(found).items()}
    document = {
        "schema": 1,
        "part": str(found.part.path),
        "unit": found.part.unit,
        "interfaces": [
            {
                "name": one.name,
                "faces": one.faces,
                "point": one.point.tolist(),
                "coupling": one.coupling,
                "because": one.because,
            }
            for one in found.interfaces
        ],
        "unknowns": found.unknowns,
        "straightened": found.straightened,
        "mass": found.total,
        "volume_deviation": found.deviation,
        **({"accuracy": asdict(reached)} if reached else {}),
        "condensed_mass": arrays["mass"],
        **{name: arrays[name] for name in _AS_THEY_ARE},
        "modes_counted": {"count": found.counted, "below": found.counted_below},
        **{
            name: {what: arrays[f"{key}_{name}"] for what, key in _UNCERTAIN.items()}
            for name in ("uncertainty", "bracket")
        },
    }
    return json.dumps(document, allow_nan=False)


def _plain(values: Array) -> Any:
    entries = values.astype(object)
    entries[~np.isfinite(values)] = None
    return entries.tolist()


def as_arrays(found: Identified) -> dict[str, Array]:
    """The arrays of an .npz file."""
    return {
        **{name: getattr(found, name) for name in ("mass", *_AS_THEY_ARE)},
        "points": np.array([one.point for one in found.interfaces]),
        "total": np.array(found.total),
        "compliance_uncertainty": found.compliance_refinement,
        "compliance_bracket": found.compliance_bracket,
        "frequency_uncertainty": found.frequency_refinement,
        "frequency_bracket": found.frequency_bracket,
    }
