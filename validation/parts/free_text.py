"""Frequencies of a part without supports as text, JSON or arrays.

Input: a `FreePart`. Output: text, JSON (schema 1) or arrays, in SI units and the axes of the file.
"""

from collections.abc import Mapping
from typing import Any, Literal

import msgspec
import numpy as np
from msgspec import UNSET, UnsetType

from lumped.arrays import Array
from validation.parts.free_modes import FreePart
from validation.record_fields import CountRecord, finite_items, json_text
from validation.uncertainty.refinement import Accuracy


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


def as_text(part: FreePart, accuracy: Accuracy | None = None) -> str:
    """Text with mass, rigid-body motions, and frequencies with their half-widths.

    `accuracy`: result of the refinement by --accuracy, None without this option.
    """
    counts = ", ".join(map(str, part.unknowns))
    meshes = f"meshes of {counts} unknowns; {part.elements} tetrahedra in the finest"
    if len(part.unknowns) == 1:
        meshes = f"one mesh, from the file, of {counts} unknowns"
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
    """All results as JSON (schema 1), in SI units. null for an unknown number.

    `accuracy`: result of the refinement by --accuracy, None without this option.
    """
    return json_text(
        FreePartRecord(
            part=str(part.part.path),
            unit=part.part.unit,
            unknowns=part.unknowns,
            straightened=part.straightened,
            mass=part.total,
            accuracy=accuracy or UNSET,
            rigid=part.rigid,
            frequencies=part.frequencies,
            centre=part.centre,
            inertia=part.inertia,
            modes_counted=CountRecord(part.counted, part.counted_below),
            uncertainty={"frequency": finite_items(part.frequency_refinement)},
        )
    )


def as_arrays(part: FreePart) -> dict[str, Array]:
    """Arrays for an .npz file, in SI units and the axes of the file."""
    return {
        "frequencies": part.frequencies,
        "frequency_uncertainty": part.frequency_refinement,
        "centre": part.centre,
        "inertia": part.inertia,
        "total": np.array(part.total),
    }
