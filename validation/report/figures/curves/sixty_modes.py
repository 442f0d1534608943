"""Which parts carry the strain energy of the first sixty modes of the solid robot."""

import numpy as np
from matplotlib.axes import Axes

from fem.bodies.leg_energies import DISTORTION
from lumped.arrays import Array
from validation.context import Context
from validation.drawing.style import (
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    canvas,
    csv_of,
    plot_style,
    svg_of,
)
from validation.exhibits import SOLID_ROBOT, Drawing, Figure
from validation.solids.sixty import ALONE, SIXTY, SixtyModes, in_the_feet, sixty

_ID = "robot.solid.sixty-modes"
_TITLE = f"Where the strain energy of the first {SIXTY} modes of the solid robot sits"
# From the bottom of the bars to their top.
_COLOURS = {
    "foot": BLUE,
    "tool": GREEN,
    "bending y": VERMILLION,
    "bending z": ORANGE,
    "torsion": PURPLE,
    "tension": SKY,
    DISTORTION: "#bbbbbb",
}
_MEANINGS = {"bending y": "bending out of the plane", "bending z": "bending in the plane"}


def drawings() -> tuple[Drawing, ...]:
    """The energies of the first sixty modes at the centre of the stroke."""
    return (
        Drawing(_ID, _TITLE, energies, section=SOLID_ROBOT, group="robot.solid.sixty", effort=8.0),
    )


def energies(context: Context) -> Figure:
    """One stacked bar for each mode, above for leg 1 and its foot, below for leg 2 and its foot."""
    found = sixty(context)
    with plot_style():
        picture, (first, second) = canvas(rows=2, height=5.6)
        for number, axes in ((1, first), (2, second)):
            _bars(axes, found, number)
            axes.set_title(f"({'ab'[number - 1]}) foot {number} and leg {number}")
        second.set(xlabel="mode")
        handles, labels = first.get_legend_handles_labels()
        picture.legend(handles, labels, loc="outside upper left", ncols=3, columnspacing=1.6)
        svg = svg_of(picture)
    return Figure(
        id=_ID,
        title=_TITLE,
        caption=_caption(found),
        section=SOLID_ROBOT,
        svg=svg,
        data=_table(found),
    )


def _bars(axes: Axes, found: SixtyModes, number: int) -> None:
    modes = np.arange(1, SIXTY + 1)
    bottom = np.zeros(SIXTY)
    for kind, colour in _COLOURS.items():
        share = _share(found, kind, number)
        if share is None:
            continue
        meaning = _MEANINGS.get(kind, kind)
        axes.bar(modes, 100.0 * share, bottom=bottom, width=0.86, color=colour, label=meaning)
        bottom += 100.0 * share
    axes.set(xlim=(0.3, SIXTY + 0.7), ylim=(0.0, 100.0), ylabel="strain energy (%)")
    axes.set_xticks([1, *range(5, SIXTY + 1, 5)])
    axes.grid(visible=False, axis="x")


def _share(found: SixtyModes, kind: str, number: int) -> Array | None:
    """Share of a kind in foot or leg `number`; the tool goes with leg 1, as the platform does."""
    if kind == "tool":
        return found.shares.get("tool") if number == 1 else None
    name = f"foot {number}" if kind == "foot" else f"leg {number} {kind}"
    return found.shares.get(name)


def _caption(found: SixtyModes) -> str:
    feet = in_the_feet(found)
    most = int(np.argmax(feet))
    distorted = np.sum([s for part, s in found.shares.items() if DISTORTION in part], axis=0)
    return (
        f"Both legs as solids with rigid end faces, B at x = {found.x:.4g} m, "
        f"{found.frequencies[0]:.0f} Hz to {found.frequencies[-1]:.0f} Hz; the bars of both "
        "pictures together are 100 %. The feet hold at most "
        f"{100.0 * feet[most]:.0f} % (mode {most + 1}): "
        + (
            "there is a mode of the feet alone. "
            if feet[most] > ALONE
            else "none of these modes is due to the feet, that is to the actuators, alone. "
        )
        + "Tension, torsion and bending with its shear are the projection of the "
        "solid's stresses on those of beam theory; section distortion is all that is left. It is "
        f"more than half of the energy in {int(np.sum(distorted > 0.5))} modes, which no beam "
        "model can show."
    )


def _table(found: SixtyModes) -> str:
    columns: dict[str, list[float]] = {
        "mode": [float(k) for k in range(1, SIXTY + 1)],
        "frequency (Hz)": found.frequencies.tolist(),
    }
    for part, share in found.shares.items():
        columns[f"{part} (%)"] = (100.0 * share).tolist()
    return csv_of(columns)
