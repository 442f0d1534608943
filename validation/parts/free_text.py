"""Frequencies of a part without supports as text, JSON or arrays.

Input: a `FreePart`. Output: text, JSON (schema 1) or arrays, in SI units and the axes of the file.
"""

import json
from dataclasses import asdict

import numpy as np

from lumped.arrays import Array
from validation.parts.free_modes import FreePart
from validation.uncertainty.refinement import Accuracy


def as_text(part: FreePart, accuracy: Accuracy | None = None) -> str:
    """Text with mass, rigid-body motions, and frequencies with their half-widths."""
    counts = ", ".join(map(str, part.unknowns))
    meshes = f"meshes of {counts} unknowns; {part.elements} tetrahedra in the finest"
    if len(part.unknowns) == 1:
        meshes = f"one mesh, as given, of {counts} unknowns"
    centre = ", ".join(f"{x + 0.0:.6g}" for x in part.centre.round(9))
    lines = [
        *(f"{part.part.path}: {part.part.size}", "", meshes),
        *([accuracy.text] if accuracy else []),
        *(f"mass {part.total:.6g} kg, centre ({centre}) m", ""),
        f"rigid-body motions, counted and omitted: {part.rigid}",
        f"frequencies without supports (Hz); {part.counted} counted below "
        f"{part.counted_below:.6g} Hz, none missing; ± half-width of the meshes",
    ]
    for number, (value, half_width) in enumerate(
        zip(part.frequencies, part.frequency_refinement, strict=True), start=1
    ):
        share = f"{100.0 * half_width / value:8.3f} %" if np.isfinite(half_width) else "       –  "
        lines.append(f"  {number:<4} {value:12.2f}  ± {share}")
    return "\n".join(lines)


def as_json(part: FreePart, accuracy: Accuracy | None = None) -> str:
    """All results as JSON (schema 1), in SI units. null for an unknown number."""
    half_widths = part.frequency_refinement.astype(object)
    half_widths[~np.isfinite(part.frequency_refinement)] = None
    document = {
        "schema": 1,
        "part": str(part.part.path),
        "unit": part.part.unit,
        "unknowns": part.unknowns,
        "straightened": part.straightened,
        "mass": part.total,
        **({"accuracy": asdict(accuracy)} if accuracy else {}),
        "rigid": part.rigid,
        "frequencies": part.frequencies.tolist(),
        "centre": part.centre.tolist(),
        "inertia": part.inertia.tolist(),
        "modes_counted": {"count": part.counted, "below": part.counted_below},
        "uncertainty": {"frequency": half_widths.tolist()},
    }
    return json.dumps(document, allow_nan=False)


def as_arrays(part: FreePart) -> dict[str, Array]:
    """Arrays for an .npz file, in SI units and the axes of the file."""
    return {
        "frequencies": part.frequencies,
        "frequency_uncertainty": part.frequency_refinement,
        "centre": part.centre,
        "inertia": part.inertia,
        "total": np.array(part.total),
    }
