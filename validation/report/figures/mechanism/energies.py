"""What carries the strain energy of a mechanism's first modes: which bodies, which deformation."""

from collections.abc import Mapping, Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes

from lumped.arrays import Array
from lumped.legs import ConstantLeg
from lumped.mechanism.mechanism import Mechanism
from validation.adequacy.mechanism.path import known_legs
from validation.case import Skip
from validation.context import Context
from validation.drawing.style import (
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    YELLOW,
    canvas,
    csv_of,
    plot_style,
    svg_of,
)
from validation.exhibits import PATH, Drawing, Figure
from validation.models.mechanism_modes import PostureModes
from validation.report.figures.curves.lines import legend_above
from validation.report.figures.mechanism.drawn_modes import finite_elements
from validation.solids.robots import SHARED_SOLIDS

_PARTS = "parts"
_ID = "mechanism.strain-energy"
SIXTY = 60
_TITLE = "Where the strain energy of the first modes sits"
_KINDS = {
    "drives": BLUE,
    "give of joints": GREEN,
    "bending y": VERMILLION,
    "bending z": ORANGE,
    "torsion": PURPLE,
    "tension": SKY,
    _PARTS: "#7a7f87",
}
# Bodies: none of the colours above.
_BODIES = ("#8c6d46", "#b9a7d6", "#7f9f3f", "#444444", YELLOW, "#a8c7c9", "#c98ca7", "#5b5ea6")
Shares = Mapping[str, Array]


def drawings() -> tuple[Drawing, ...]:
    """The energies of the first sixty modes."""
    return (Drawing(_ID, _TITLE, energies, section=PATH, group=SHARED_SOLIDS, effort=2.0),)


def energies(context: Context) -> Figure:
    """A stacked bar for each mode: by kind of deformation, and by drives, joints and bodies."""
    found = _sixty(context)
    mechanism = found.posture.mechanism
    panels = {
        "(a) by what they do": (_by_kind(found.strain, mechanism), _KINDS),
        "(b) by what they are": _by_body(found.strain, mechanism),
    }
    count = len(found.modes.frequencies)
    with plot_style():
        drawn, places = canvas(rows=2, height=6.2)
        for axes, (title, (shares, colours)) in zip(places, panels.items(), strict=True):
            _bars(axes, shares, colours, count)
            axes.set_title(title)
        places[1].set_xlabel("mode")
        legend_above(drawn, columns=4)
        svg = svg_of(drawn)
    columns = {
        "mode": list(range(1, count + 1)),
        "frequency (Hz)": found.modes.frequencies.tolist(),
    } | {f"{part} (%)": (100.0 * share).tolist() for part, share in found.strain.items()}
    return Figure(
        id=_ID,
        title=_TITLE,
        caption=f"The first {count} modes of the {_model(mechanism)} in the middle of the path, "
        f"{found.modes.frequencies[0]:.4g} to {found.modes.frequencies[-1]:.4g} Hz. "
        f"{_kinds_said(mechanism)}Bodies of one shape are taken together; the table of the figure "
        "has each by itself.",
        section=PATH,
        svg=svg,
        data=csv_of(columns),
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


def _by_kind(strain: Shares, mechanism: Mechanism) -> Shares:
    legs = known_legs(mechanism)
    found: dict[str, Array] = {}
    for part, share in strain.items():
        name, _, kind = part.partition(" ")
        if name in mechanism.parts:
            kind = _PARTS
        elif name not in legs:
            kind = "drives" if kind == "drive" else "give of joints"
        found[kind] = found.get(kind, np.zeros(len(share))) + share
    return {kind: found[kind] for kind in _KINDS if kind in found}


def _by_body(strain: Shares, mechanism: Mechanism) -> tuple[Shares, Mapping[str, str]]:
    """Shares of drives, of joints and of legs, those of one shape together, and their colours."""
    groups: dict[object, list[str]] = {name: [name] for name in mechanism.parts}
    for name, leg in known_legs(mechanism).items():
        groups.setdefault(leg if isinstance(leg, ConstantLeg) else name, []).append(name)
    label = {name: _listed(names) for names in groups.values() for name in names}
    found: dict[str, Array] = {}
    for part, share in strain.items():
        name, _, kind = part.partition(" ")
        key = label.get(name, "drives" if kind == "drive" else "give of joints")
        found[key] = found.get(key, np.zeros(len(share))) + share
    bodies = [key for key in found if key not in _KINDS]
    ordered = [key for key in _KINDS if key in found] + bodies
    colours = dict(_KINDS) | dict(zip(bodies, cycle(_BODIES), strict=False))
    return {key: found[key] for key in ordered}, colours


def _listed(names: Sequence[str]) -> str:
    return ", ".join(names) if len(names) <= 3 else f"{names[0]} to {names[-1]} ({len(names)})"


def _bars(axes: Axes, shares: Shares, colours: Mapping[str, str], count: int) -> None:
    modes, bottom = np.arange(1, count + 1), np.zeros(count)
    for name, share in shares.items():
        axes.bar(modes, 100.0 * share, bottom=bottom, width=0.86, color=colours[name], label=name)
        bottom += 100.0 * share
    axes.set(xlim=(0.3, count + 0.7), ylim=(0.0, 100.0), ylabel="strain energy (%)")
    axes.set_xticks([1, *range(5, count + 1, 5)])
    axes.grid(visible=False, axis="x")
