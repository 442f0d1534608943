"""Figure of a finished run: how much of its tolerance each comparison uses."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from textwrap import fill

import numpy as np
from matplotlib.figure import Figure

from validation.drawing.style import GREEN, VERMILLION, WIDTH, Look, plot_style
from validation.run.outcome import Verdict

# in, of a row, and of the axis with legend; letters of a line of a row's name.
_ROW, _AROUND, _LETTERS = 0.36, 1.1, 38
# Smaller shares of a tolerance are drawn here: differences of round-off, and zero.
_SMALLEST = 1e-6
_LOOKS: Mapping[Verdict, Look] = {
    "agree": Look(GREEN, "o"),
    "disagree": Look(VERMILLION, "X"),
    "undecided": Look("#777777", "s"),
}


@dataclass(frozen=True)
class Compared:
    """A comparison: the section of its report, its verdict, and difference over tolerance."""

    section: str
    verdict: Verdict
    share: float


def finished_plot(comparisons: Sequence[Compared]) -> Figure:
    """One row for each section, a marker for each comparison, a line where tolerances end."""
    sections = list(dict.fromkeys(one.section for one in comparisons))
    with plot_style():
        size = (WIDTH, _AROUND + _ROW * len(sections))
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots()
        for verdict, look in _LOOKS.items():
            of_verdict = [one for one in comparisons if one.verdict == verdict]
            if of_verdict:
                axes.plot(
                    np.clip([one.share for one in of_verdict], _SMALLEST, None),
                    [sections.index(one.section) for one in of_verdict],
                    look.marker,
                    color=look.colour,
                    fillstyle="none",
                    markersize=6.0,
                    label=f"{verdict} ({len(of_verdict)})",
                )
        axes.axvline(1.0, color="black", linestyle="--", linewidth=1.0, label="tolerance")
        axes.set_xscale("log")
        axes.set_xlim(left=0.5 * _SMALLEST)
        axes.set_yticks(range(len(sections)), [fill(name, _LETTERS) for name in sections])
        axes.set_ylim(len(sections) - 0.5, -0.5)
        axes.set_xlabel(f"unexplained difference / tolerance (from {_SMALLEST:g})")
        figure.legend(loc="outside upper left", ncols=4)
    return figure
