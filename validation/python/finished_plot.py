"""Plot of a finished run: unexplained difference over tolerance of each comparison.

Input: verdicts and ratios. Output: a matplotlib figure.
"""

from collections.abc import Mapping, Sequence
from textwrap import fill

import numpy as np
from matplotlib.figure import Figure

from validation.drawing.style import GREEN, VERMILLION, WIDTH, Look, plot_style
from validation.run.outcome import Outcome, Verdict

# Height of a row, and of the axis with legend (inches); characters per line of a row's name.
_ROW, _AROUND, _LETTERS = 0.36, 1.1, 38
# Smallest drawn ratio to the tolerance. Smaller ones, such as round-off and zero, are drawn there.
_SMALLEST = 1e-6
_LOOKS: Mapping[Verdict, Look] = {
    "agree": Look(GREEN, "o"),
    "disagree": Look(VERMILLION, "X"),
    "undecided": Look("#777777", "s"),
}


def finished_plot(outcomes: Sequence[Outcome]) -> Figure:
    """Plot with a row for each section, a marker for each comparison, a line at the tolerance."""
    sections = list(dict.fromkeys(outcome.case.section for outcome in outcomes))
    with plot_style():
        size = (WIDTH, _AROUND + _ROW * len(sections))
        figure = Figure(figsize=size, layout="constrained")
        axes = figure.subplots()
        for verdict, look in _LOOKS.items():
            group = [outcome for outcome in outcomes if outcome.verdict == verdict]
            if group:
                axes.plot(
                    np.clip([outcome.share for outcome in group], _SMALLEST, None),
                    [sections.index(outcome.case.section) for outcome in group],
                    look.marker,
                    color=look.colour,
                    fillstyle="none",
                    markersize=6.0,
                    label=f"{verdict} ({len(group)})",
                )
        axes.axvline(1.0, color="black", linestyle="--", linewidth=1.0, label="tolerance")
        axes.set_xscale("log")
        axes.set_xlim(left=0.5 * _SMALLEST)
        axes.set_yticks(range(len(sections)), [fill(name, _LETTERS) for name in sections])
        axes.set_ylim(len(sections) - 0.5, -0.5)
        axes.set_xlabel(f"unexplained difference / tolerance (from {_SMALLEST:g})")
        figure.legend(loc="outside upper left", ncols=4)
    return figure
