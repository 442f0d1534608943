"""Strain energy of modes as stacked bars, a bar for each mode, of every robot."""

from collections.abc import Mapping

import numpy as np

from lumped.arrays import Array
from lumped.system.joint_motion import Portion
from validation.drawing.chart import legend_above
from validation.drawing.style import (
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    canvas,
    plot_style,
    svg_of,
)

Shares = Mapping[str, Array]
# Legs by what they do, in every figure.
KINDS = {"bending y": VERMILLION, "bending z": ORANGE, "torsion": PURPLE, "tension": SKY}
DRIVES, JOINTS = BLUE, GREEN
_HIGH = 2.8  # in
# So many bars, and shares from this one on, have room for numbers; on dark ground they are white.
_FEW, _LABELLED, _DARK = 8, 0.06, (DRIVES, JOINTS, VERMILLION)


def stacked_bars(
    panels: Mapping[str, Shares],
    colours: Mapping[str, str],
    legend_columns: int,
    frequencies: Array,
) -> str:
    """SVG of a panel for each title: shares (m, of 1) of each mode by name, from below to above.

    Few bars are wide enough for their numbers (%), and for the `frequencies` (m, Hz) below them.
    """
    few = len(frequencies) <= _FEW
    with plot_style():
        picture, places = canvas(rows=len(panels), height=_HIGH * len(panels) + 0.4)
        for axes, (title, shares) in zip(places, panels.items(), strict=True):
            count = len(next(iter(shares.values())))
            modes, bottom = np.arange(1, count + 1), np.zeros(count)
            for name, share in shares.items():
                bars = axes.bar(modes, 100.0 * share, 0.86, bottom, color=colours[name], label=name)
                bottom += 100.0 * share
                if few:
                    said = [f"{100.0 * one:.0f}" if one >= _LABELLED else "" for one in share]
                    ink = "white" if colours[name] in _DARK else "black"
                    axes.bar_label(bars, said, label_type="center", fontsize=8.5, color=ink)
            axes.set(xlim=(0.3, count + 0.7), ylim=(0.0, 100.0), ylabel="strain energy (%)")
            if few:
                axes.set_xticks(modes, [f"{n}: {f:.1f} Hz" for n, f in enumerate(frequencies, 1)])
            else:
                axes.set_xticks([1, *range(5, count + 1, 5)])
            axes.grid(visible=False, axis="x")
            axes.set_title(title)
        places[-1].set_xlabel("mode")
        legend_above(picture, legend_columns)
        return svg_of(picture)


def energy_table(frequencies: Array, strain: Mapping[Portion, Array]) -> dict[str, list[float]]:
    """Columns of the modes: number, frequency (Hz), share of each part (%)."""
    return {
        "mode": [float(k) for k in range(1, len(frequencies) + 1)],
        "frequency (Hz)": frequencies.tolist(),
    } | {f"{part} (%)": (100.0 * share).tolist() for part, share in strain.items()}
