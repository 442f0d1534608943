"""Panels of several models' curves, and below each what they differ from one of them."""

from collections.abc import Mapping
from typing import NamedTuple, TypeAlias

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas
from matplotlib.ticker import FuncFormatter, MaxNLocator

from lumped.arrays import Array
from validation.drawing.style import (
    Look,
    canvas,
    csv_of,
    marked,
    plot_style,
    short_number,
    svg_of,
)
from validation.exhibits import Figure
from validation.report.figures.curves.lines import from_zero, legend_above, percent_scale

# in, of a row of panels and of the differences below it.
_HIGH, _LOW = 2.0, 1.5
POSE = "pose"
# Intervals of an axis at most; letters that fit below all axes of a row.
_TICKS, _ROOM = 4, 87
Curves: TypeAlias = Mapping[str, tuple[Array, Look]]


class Panel(NamedTuple):
    """Values by model (m, one a pose), and their `differences` from the reference in percent."""

    curves: Curves
    differences: Curves


class Abscissa(NamedTuple):
    """What panels are drawn over: numbers with their label, and the table's columns for them."""

    x: Array
    label: str
    columns: Mapping[str, list[float]]


def compared_figure(
    identifier: str,
    title: str,
    caption: str,
    section: str,
    over: Abscissa,
    panels: Mapping[str, Panel],
    against: str,
    columns: int = 3,
) -> Figure:
    """The panels as `compared` draws them; `against`: the model that the differences are from."""
    with plot_style():
        svg = svg_of(compared(over.x, over.label, panels, columns))
    curves = {
        f"{key}: {heading}": values.tolist()
        for heading, panel in panels.items()
        for key, (values, _) in panel.curves.items()
    }
    return Figure(
        id=identifier,
        title=title,
        caption=f"{caption} Below each: what the others differ from {against}, in percent.",
        section=section,
        svg=svg,
        data=csv_of({**over.columns, **curves}),
    )


def compared(x: Array, label: str, panels: Mapping[str, Panel], columns: int) -> Canvas:
    """The panels by their titles over x (m), differences below each; draw in the style of plots.

    Without differences there is no row for them; x that are numbers of poses have whole ticks.
    """
    rows = -(-len(panels) // columns)
    parts = 2 if any(panel.differences for panel in panels.values()) else 1
    heights = rows * (_HIGH, _LOW)[:parts]
    drawn, places = canvas(parts * rows, columns, 0.8 + sum(heights), heights)
    for axes in places:
        axes.set_axis_off()
    for place, (heading, panel) in enumerate(panels.items()):
        row, column = divmod(place, columns)
        above, lowest = (places[(parts * row + k) * columns + column] for k in (0, parts - 1))
        _draw(above, x, label, panel.curves)
        from_zero(above)
        above.set_title(heading)
        if parts > 1:
            above.tick_params(labelbottom=False)
            _draw(lowest, x, label, panel.differences)
            percent_scale(lowest)
            if not column:
                lowest.set_ylabel("difference (%)")
        lowest.set_xlabel(_fitting(label, columns))
    legend_above(drawn, columns=4)
    return drawn


def _fitting(label: str, columns: int) -> str:
    """The end of a label that is longer than an axis."""
    room = _ROOM // columns
    return label if len(label) <= room else f"…{label[1 - room :]}"


def _draw(axes: Axes, x: Array, label: str, curves: Curves) -> None:
    axes.set_axis_on()
    axes.xaxis.set_major_locator(MaxNLocator(_TICKS, integer=label == POSE))
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: short_number(value)))
    if len(x) == 1 and label == POSE:
        axes.set_xlim(x[0] - 0.5, x[0] + 0.5)
    for rank, (name, (values, look)) in enumerate(curves.items()):
        if np.isfinite(values).any():
            axes.plot(
                x,
                values,
                label=name,
                linewidth=3.0 - 2.0 * rank / max(len(curves) - 1, 1),
                markevery=marked(len(x), rank, len(curves)),
                **look.options(),
            )
