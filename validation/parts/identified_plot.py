"""Plots of an identified part: its relative uncertainties, or frequencies without supports.

Input: uncertainties in per cent, or frequencies in Hz. Output: a matplotlib figure.
"""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from lumped.arrays import Array
from validation.drawing.style import BLUE, ORANGE, WIDTH, plot_style

MESHES, BRACKET = "half-width of the meshes", "averaged minus rigid interfaces"
# Width of a bar. Groups of bars have distance 1.
_BAR = 0.36


def identified_plot(
    components: Sequence[str], compliances: Array, modes: Sequence[str], frequencies: Array
) -> Figure:
    """Plot of relative uncertainties (%): compliances to the left, frequencies to the right.

    Rows of `compliances` (c×2) belong to the names `components`, rows of `frequencies` (m×2) to the
    names `modes`. Columns: half-width due to the meshes, and change from rigid to averaged
    interfaces. NaN if unknown.
    """
    quantities = [
        (title, names, values)
        for title, names, values in (
            ("compliance (%)", components, compliances),
            ("natural frequency (%)", modes, frequencies),
        )
        if len(names)
    ]
    with plot_style():
        figure = Figure(figsize=(WIDTH, 2.9), layout="constrained")
        panels = figure.subplots(1, len(quantities), squeeze=False).ravel()
        for axes, (title, names, values) in zip(panels, quantities, strict=True):
            positions = np.arange(len(names))
            for column, label, colour in ((0, MESHES, BLUE), (1, BRACKET, ORANGE)):
                offset = (column - 0.5) * _BAR
                axes.bar(positions + offset, values[:, column], _BAR, label=label, color=colour)
            axes.axhline(0.0, color="black", linewidth=0.8)
            axes.set_xticks(positions, names)
            axes.grid(visible=False, axis="x")
            axes.set_title(title)
        figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper left", ncols=2)
    return figure


def free_plot(frequencies: Array, half_widths: Array) -> Figure:
    """Bars of the frequencies (Hz) of a part without supports, with their half-widths (Hz)."""
    modes = [f"f{mode}" for mode in range(1, len(frequencies) + 1)]
    with plot_style():
        figure = Figure(figsize=(WIDTH, 2.9), layout="constrained")
        axes = figure.subplots()
        axes.bar(modes, frequencies, yerr=half_widths, color=BLUE)
        axes.grid(visible=False, axis="x")
        axes.set_title("natural frequency without supports (Hz)")
    return figure
