"""Forces and stresses as text for the terminal.

Input: `Forces`. Output: lines with reactions, section forces and stresses.
"""

from collections.abc import Sequence

import numpy as np

from lumped.arrays import Array
from lumped.text import aligned
from validation.forces.record import Forces
from validation.forces.results import (
    REACTION_UNITS,
    REACTIONS,
    SECTION_FORCES,
    ForcesUnderLoad,
    largest_of,
    shown,
)

_INDENT = "    "
_NONE = (
    "  none: the mechanism cannot move as the load requires, or no wrench is given for this pose"
)


def as_text(forces: Forces) -> str:
    """Text with reactions, section forces and stresses, for each pose and load."""
    options = ", ".join(f"{name} {value}" for name, value in forces.options.items())
    lines = [f"{forces.robot}, {forces.model}" + (f" ({options})" if options else "")]
    for pose in forces.poses:
        for load, result in pose.loads.items():
            lines += ["", f"{pose.place}, load {load}"]
            lines += [_NONE] if result is None else _lines(result)
    return "\n".join(lines)


def _lines(result: ForcesUnderLoad) -> list[str]:
    scale = largest_of(result)
    lines = ["  joints on their second bodies, joint axes (x along the joint):"]
    headings = ["joint", *_with_units(REACTIONS), "drive"]
    rows = [
        [
            reaction.joint,
            *_texts(reaction.wrench, scale),
            "" if reaction.drive is None else _texts(np.array([reaction.drive]), scale)[0],
        ]
        for reaction in result.reactions
    ]
    lines.append(aligned(headings, rows, _INDENT))
    if result.members:
        lines.append("  legs, largest magnitudes along them, leg axes (x along the leg):")
        headings = ["leg", *_with_units(SECTION_FORCES)]
        rows = [
            [member.leg, *_texts(np.abs(member.forces).max(axis=0), scale)]
            for member in result.members
        ]
        lines.append(aligned(headings, rows, _INDENT))
    if result.stresses:
        lines.append("  largest von Mises stresses in their sections (beam theory):")
        for leg, stress in result.stresses.items():
            y, z = (f"{1e3 * value:.4g}" for value in stress.point)
            lines.append(
                f"{_INDENT}{leg}: {1e-6 * stress.largest:.4g} ± {1e-6 * stress.half_width:.2g} MPa "
                f"at {stress.station:.4g} m, in y = {y} mm, z = {z} mm "
                f"(σ {1e-6 * stress.normal:.4g} MPa, τ {1e-6 * stress.shear:.4g} MPa)"
            )
            if stress.parts:
                parts = ", ".join(f"{1e-6 * largest:.4g}" for largest in stress.parts)
                lines.append(f"{_INDENT}{leg}: in that section, largest in each part: {parts} MPa")
    for body, solid in result.solids.items():
        point = ", ".join(f"{value:.4g}" for value in solid.place)
        lines.append(
            f"{_INDENT}{body} as a solid: {1e-6 * solid.largest:.4g} ± "
            f"{1e-6 * solid.half_width:.2g} MPa at ({point}) m, farther than "
            f"{1e3 * solid.distance:.3g} mm from singular edges"
        )
    for leg, reason in result.without_stress.items():
        lines.append(f"{_INDENT}{leg}: no stress, {reason}")
    half_width = max(
        (float(reaction.half_width[:3].max()) for reaction in result.reactions), default=0.0
    )
    along = max((float(member.half_width[:3].max()) for member in result.members), default=0.0)
    lines.append(f"  half-width of the forces: joints {half_width:.2g} N, legs {along:.2g} N")
    if any(np.isnan(reaction.wrench).any() for reaction in result.reactions):
        lines.append(
            "  –: statically indeterminate; loops of rigid bodies carry any self-balanced forces"
        )
    return lines


def _with_units(names: Sequence[str]) -> list[str]:
    return [f"{name} ({unit})" for name, unit in zip(names, REACTION_UNITS, strict=True)]


def _texts(values: Array, scale: float) -> list[str]:
    return ["–" if value is None else f"{value:.5g}" for value in shown(values, scale)]
