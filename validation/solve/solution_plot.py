"""Plots of one model: deflections, frequencies, loads and responses.

Input: numbers in one or several poses. Output: matplotlib figures, bars for one pose and curves
over several.
"""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np
from matplotlib.figure import Figure

from lumped.arrays import Array, ComplexArray
from validation.drawing.chart import (
    Bars,
    Chart,
    Panel,
    Scale,
    Series,
    degrees,
    few_ticks,
    from_zero,
    octaves,
    power_ticks,
    powers,
)
from validation.drawing.plot import drawn_chart
from validation.drawing.style import BLUE, WIDTH, plot_style

DEFLECTION = "deflection along a force of 1000 N (µm)"
FREQUENCY = "natural frequency (Hz)"
DISPLACEMENT = "displacement (µm)"
FACTOR = "buckling factor"


def solution_plot(
    places: Sequence[str], abscissa: tuple[Array, str], deflections: Array, frequencies: Array
) -> Figure:
    """Plot of deflections and frequencies: bars for a single pose, curves for several.

    `deflections` (p×3, or p×2 in the plane; µm) and `frequencies` (p×m, Hz, NaN for a missing mode)
    belong to `places` (p). `abscissa`: p values and their label. Without modes there is no panel of
    frequencies.
    """
    quantities = [(DEFLECTION, ["x", "y", "z"][: deflections.shape[1]], deflections)]
    if frequencies.shape[1]:
        names = [f"f{mode}" for mode in range(1, frequencies.shape[1] + 1)]
        quantities.append((FREQUENCY, names, frequencies))
    if len(places) == 1:
        panels = [
            Panel(title=title, bars=[Bars(places[0], values[0])], names=names)
            for title, names, values in quantities
        ]
        chart = Chart(panels, "", columns=len(panels), high=2.2)
    else:
        x, label = abscissa
        panels = [
            Panel(
                [Series(name, x, values[:, k]) for k, name in enumerate(names)],
                title,
                scale=from_zero,
                staggered=False,
            )
            for title, names, values in quantities
        ]
        chart = Chart(panels, label, columns=len(panels), high=2.2, x_scale=_ticks(label))
    return drawn_chart(chart)


def _ticks(label: str) -> Scale:
    return partial(few_ticks, count=6, whole=label == "pose")


def loads_plot(
    abscissa: tuple[Array, str], displacements: Mapping[str, Array], factors: Mapping[str, Array]
) -> Figure:
    """Plot of the displacement (µm) under each load, and of the buckling factor.

    `displacements` and `factors` have p values for each load, one for each pose (NaN if there is
    none). Curves over `abscissa` (p values and their label); for a single pose, a mark for each
    load.
    """
    x, label = abscissa
    quantities = ((DISPLACEMENT, displacements, from_zero), (FACTOR, factors, powers))
    if len(x) == 1:
        return _marks_of_loads({title: values for title, values, _ in quantities})
    panels = [
        Panel(
            [Series(name, x, numbers) for name, numbers in values.items()],
            title,
            scale=scale,
            staggered=False,
        )
        for title, values, scale in quantities
    ]
    return drawn_chart(Chart(panels, label, columns=2, high=2.4, x_scale=_ticks(label)))


def _marks_of_loads(quantities: Mapping[str, Mapping[str, Array]]) -> Figure:
    """Plot with a row for each load and a logarithmic axis for each quantity.

    `quantities`: values by load, by title of the quantity. Zero and NaN have no mark.
    """
    names = list(quantities[DISPLACEMENT])
    rows = np.arange(len(names), 0, -1)
    with plot_style():
        figure = Figure(figsize=(WIDTH, 0.7 + 0.3 * len(names)), layout="constrained")
        panels = figure.subplots(1, len(quantities), sharey=True)
        for axes, (title, values) in zip(panels, quantities.items(), strict=True):
            sizes = np.array([values[name][0] for name in names])
            positive = np.isfinite(sizes) & (sizes > 0.0)
            axes.plot(sizes[positive], rows[positive], "o", color=BLUE)
            for size, row in zip(sizes[positive], rows[positive], strict=True):
                axes.annotate(
                    f"{size:.4g}", (size, row), (0.0, 5.0), textcoords="offset points", ha="center"
                )
            axes.set(title=title, xscale="log", ylim=(0.4, len(names) + 0.8))
            axes.margins(x=0.25)
            axes.set_yticks(rows, names)
            power_ticks(axes.xaxis)
    return figure


def responses_plot(curves: Mapping[str, tuple[Array, ComplexArray]]) -> Figure:
    """Plot of magnitude (µm/N) and phase of receptances (m/N) over frequencies (Hz), by name."""
    sizes = [Series(name, x, 1e6 * np.abs(values)) for name, (x, values) in curves.items()]
    phases = [
        Series(name, x, np.degrees(np.angle(1j * values)) - 90.0)
        for name, (x, values) in curves.items()
    ]
    panels = [
        Panel(sizes, "magnitude (µm/N)", scale=powers),
        Panel(phases, "phase (°)", scale=degrees),
    ]
    return drawn_chart(Chart(panels, "frequency (Hz)", 2, 3.0, x_scale=octaves))
