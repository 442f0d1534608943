"""What carries the strain energy of a mechanism's first modes: which bodies, which deformation."""

from collections.abc import Callable, Mapping, Sequence
from itertools import cycle

import numpy as np

from lumped.arrays import Array
from lumped.legs import ConstantLeg
from lumped.mechanism.mechanism import Mechanism
from lumped.system.joint_motion import Portion
from validation.adequacy.mechanism.path import known_legs
from validation.case import Skip
from validation.context import Context
from validation.drawing.style import YELLOW, csv_of
from validation.exhibits import PATH
from validation.models.mechanism_modes import PostureModes
from validation.report.figures.declared import FigureGroup, Shown
from validation.report.figures.mechanism.drawn_modes import finite_elements
from validation.report.figures.mechanism.mode_names import DRIVES as _DRIVES
from validation.report.figures.mechanism.mode_names import JOINTS as _JOINTS
from validation.report.figures.mechanism.mode_names import PARTS, by_kind
from validation.report.figures.stacked_bars import (
    DRIVES,
    JOINTS,
    KINDS,
    Shares,
    energy_table,
    stacked_bars,
)
from validation.solids.robots import SHARED_SOLIDS

Portions = Mapping[Portion, Array]
SIXTY = 60
_KINDS = {_DRIVES: DRIVES, _JOINTS: JOINTS, **KINDS, PARTS: "#7a7f87"}
# Bodies: none of the colours above.
_BODIES = ("#8c6d46", "#b9a7d6", "#7f9f3f", "#444444", YELLOW, "#a8c7c9", "#c98ca7", "#5b5ea6")
figures = FigureGroup(PATH, SHARED_SOLIDS)


@figures.figure(
    "mechanism.strain-energy", "Where the strain energy of the first modes sits", effort=2.0
)
def energies(context: Context) -> Shown:
    """A stacked bar for each mode: by kind of deformation, and by drives, joints and bodies."""
    found = _sixty(context)
    mechanism, frequencies = found.posture.mechanism, found.modes.frequencies
    by_body = _by_body(found.strain, mechanism)
    bodies = [name for name in by_body if name not in _KINDS]
    panels = {
        "(a) by what they do": _kinds_first(by_kind(found.strain, mechanism)),
        "(b) by what they are": by_body,
    }
    colours = _KINDS | dict(zip(bodies, cycle(_BODIES), strict=False))
    return Shown(
        f"The first {len(frequencies)} modes of the {_model(mechanism)} in the middle of the path, "
        f"{frequencies[0]:.4g} to {frequencies[-1]:.4g} Hz. "
        f"{_kinds_said(mechanism)}Bodies of one shape are taken together; the table of the figure "
        "has each by itself.",
        stacked_bars(panels, colours, 4, frequencies),
        data=csv_of(energy_table(frequencies, found.strain)),
    )


def _sixty(context: Context) -> PostureModes:
    mechanism = context.robot_file.mechanism
    if not (known_legs(mechanism) or mechanism.parts):
        raise Skip("all bodies are rigid: their modes sit in the drives and joints alone")
    return finite_elements(context, SIXTY)


def _model(mechanism: Mechanism) -> str:
    return "model of parts as solids" if mechanism.parts else "beam model"


def _kinds_said(mechanism: Mechanism) -> str:
    if not known_legs(mechanism):
        return "Parts bend, twist and stretch at once. "
    return (
        "Bending y is deflection along a leg's own z axis, bending z along its y axis, both with "
        "their shear. "
    )


def _by_body(strain: Portions, mechanism: Mechanism) -> Shares:
    """Shares of drives, of joints and of legs, those of one shape together."""
    groups: dict[object, list[str]] = {name: [name] for name in mechanism.parts}
    for name, leg in known_legs(mechanism).items():
        groups.setdefault(leg if isinstance(leg, ConstantLeg) else name, []).append(name)
    label = {name: _listed(names) for names in groups.values() for name in names}
    return _summed(
        strain, lambda part: label.get(part.of) or (_DRIVES if part.kind == "drive" else _JOINTS)
    )


def _summed(strain: Portions, what: Callable[[Portion], str]) -> Shares:
    """Shares summed by `what` they are."""
    parts: dict[str, list[Portion]] = {}
    for part in strain:
        parts.setdefault(what(part), []).append(part)
    return _kinds_first(
        {key: np.sum([strain[part] for part in own], axis=0) for key, own in parts.items()}
    )


def _kinds_first(shares: Shares) -> Shares:
    ordered = [key for key in _KINDS if key in shares]
    return {key: shares[key] for key in (*ordered, *(key for key in shares if key not in _KINDS))}


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) <= 3 else f"{names[0]} to {names[-1]} ({len(names)})"
