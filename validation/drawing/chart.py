"""A figure of curves, declared: panels of series over one axis, below each what they differ in.

`chart_svg` draws it, `chart_table` is its data; what a figure is about stands in neither.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from lumped.arrays import Array
from validation.drawing import scales
from validation.drawing.scales import Scale
from validation.drawing.style import (
    Frame,
    Look,
    canvas,
    csv_of,
    framed_canvas,
    framed_legend,
    marked,
    plot_style,
    svg_of,
)

# in, of a row of panels, of the differences below it, and of what is around them all.
_HIGH, _LOW, _AROUND = 2.0, 1.5, 0.8
# Letters that fit below all axes of a row.
_ROOM = 87
_GREY = "#999999"


@dataclass(frozen=True, eq=False)
class Series:
    """One curve: `y` over `x` (n; NaN leaves a gap), its entry in the legend and how it looks.

    `width` in pt, `fill` the colour inside its markers, `bars` (n, or 2×n down and up) the
    uncertainty of its points, `more` what else matplotlib is told. In the table it has a column
    "label: quantity (unit)", none without a `quantity`.
    """

    label: str
    x: Array
    y: Array
    look: Look
    width: float = 1.6
    quantity: str = ""
    fill: str = "white"
    bars: Array | None = None
    more: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Note:
    """A small text `away` (pt) from a point of the axes."""

    text: str
    x: float
    y: float
    away: tuple[float, float] = (5.0, -3.0)


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes: curves, `below` them curves of what these differ by in percent.

    Curves of one label (of several modes, say) share their look and their entry in the legend.
    Their markers are `staggered` unless each point says something. `levels` are grey lines, `band`
    a shaded stripe; `place` heads the columns of the table; `x_label` if it is not the chart's.
    """

    series: Sequence[Series]
    title: str = ""
    y_label: str = ""
    scale: Scale | None = None
    below: Sequence[Series] = ()
    notes: Sequence[Note] = ()
    levels: Sequence[float] = ()
    band: tuple[float, float] | None = None
    place: str = ""
    staggered: bool = True
    x_label: str | None = None


@dataclass(frozen=True, eq=False)
class Chart:
    """Panels row by row in `columns`, `high` inches each, all over one axis, one legend above.

    `abscissa` are the first columns of the table. A `frame` fixes the room around the axes, which
    are then not fitted to their texts: half of the time of a plot.
    """

    panels: Sequence[Panel]
    x_label: str
    columns: int = 3
    high: float = _HIGH
    legend_columns: int = 0
    abscissa: Mapping[str, Sequence[float]] = field(default_factory=dict)
    x_scale: Scale | None = None
    frame: Frame | None = None


def compared(panel: Panel, against: str) -> Panel:
    """The panel with what its other curves differ from those of label `against`, in percent."""
    references = {one.quantity: one.y for one in panel.series if one.label == against}
    below = [
        replace(one, y=_percent_of(one.y, references[one.quantity]))
        for one in panel.series
        if one.label != against and one.quantity in references
    ]
    return replace(panel, below=below)


def _percent_of(values: Array, reference: Array) -> Array:
    known = np.where(np.isfinite(reference) & (reference != 0.0), reference, np.nan)
    return np.asarray(100.0 * (values / known - 1.0))


def lettered(panels: Sequence[Panel]) -> list[Panel]:
    """The panels with (a), (b), … before their titles."""
    return [
        replace(panel, title=f"({letter}) {panel.title}")
        for letter, panel in zip("abcdefghi", panels, strict=False)
    ]


def tapered(rank: int, ranks: int, widest: float = 3.0, thinnest: float = 1.0) -> float:
    """Width (pt) of a curve in a stack, from wide below to thin above, so that equal ones show."""
    return widest - (widest - thinnest) * rank / max(ranks - 1, 1)


def chart_table(chart: Chart) -> str:
    """The curves as CSV, each with its name and unit."""
    columns = {
        f"{panel.place and f'{panel.place}: '}{one.label}: {one.quantity}": one.y.tolist()
        for panel in chart.panels
        for one in panel.series
        if one.quantity and np.isfinite(one.y).any()
    }
    return csv_of({**chart.abscissa, **columns})


def chart_svg(chart: Chart) -> str:
    """The figure as SVG."""
    with plot_style():
        return svg_of(drawn_chart(chart))


def drawn_chart(chart: Chart) -> Canvas:
    """The figure; call it, and save it, in the style of plots."""
    rows = -(-len(chart.panels) // chart.columns)
    parts = 2 if any(panel.below for panel in chart.panels) else 1
    heights = rows * (chart.high, _LOW)[:parts]
    if chart.frame:
        picture, places = framed_canvas(chart.frame, chart.columns, chart.high)
    else:
        picture, places = canvas(parts * rows, chart.columns, _AROUND + sum(heights), heights)
    for axes in places:
        axes.set_axis_off()
    for number, panel in enumerate(chart.panels):
        row, column = divmod(number, chart.columns)
        above, lowest = (places[(parts * row + k) * chart.columns + column] for k in (0, parts - 1))
        shown = [panel]
        if parts > 1:
            label = "" if column else "difference (%)"
            shown.append(Panel(panel.below, y_label=label, scale=scales.percent))
            above.tick_params(labelbottom=False)
        for axes, one in zip((above, lowest), shown, strict=False):
            if chart.x_scale:
                chart.x_scale(axes)
            draw_panel(axes, one)
        if number + chart.columns >= len(chart.panels):
            label = chart.x_label if panel.x_label is None else panel.x_label
            lowest.set_xlabel(_fitting(label, chart.columns))
    if chart.frame:
        framed_legend(picture, chart.frame, *_entries(picture), chart.legend_columns)
    else:
        legend_above(picture, chart.legend_columns)
    return picture


def draw_panel(axes: Axes, panel: Panel) -> None:
    """Draw what a panel declares."""
    axes.set_axis_on()
    ranks = list(dict.fromkeys(one.label for one in panel.series))
    if panel.band:
        axes.axhspan(*panel.band, color="#009E73", alpha=0.12, linewidth=0.0)
    for one in panel.series:
        if not np.isfinite(one.y).any():
            continue
        style: dict[str, Any] = {**one.look.options(), **one.more}
        if panel.staggered:
            places = marked(len(one.x), ranks.index(one.label), len(ranks))
            style.setdefault("markevery", places)
        style |= {"label": one.label, "linewidth": one.width, "markerfacecolor": one.fill}
        axes.plot(one.x, one.y, **style)
        if one.bars is not None:
            colour = one.look.colour
            axes.errorbar(one.x, one.y, one.bars, fmt="none", ecolor=colour, capsize=3, alpha=0.6)
    for level in panel.levels:
        axes.axhline(level, color=_GREY, linewidth=0.8)
    if panel.scale:
        panel.scale(axes)
    for note in panel.notes:
        axes.annotate(
            note.text,
            (note.x, note.y),
            xytext=note.away,
            textcoords="offset points",
            annotation_clip=False,
            fontsize=8.5,
        )
    axes.set(title=panel.title, ylabel=panel.y_label)


def legend_above(picture: Canvas, columns: int = 0) -> None:
    """One legend for all axes above them, where it covers nothing; `columns` 0: all in a row."""
    handles, labels = _entries(picture)
    shape: dict[str, Any] = {"handlelength": 3.2, "columnspacing": 1.6}
    shape |= {"loc": "outside upper left", "ncols": columns or len(labels)}
    picture.legend(handles, labels, **shape)


def _entries(picture: Canvas) -> tuple[list[Any], list[str]]:
    found: dict[str, Any] = {}
    for axes in picture.axes:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    return list(found.values()), list(found)


def _fitting(label: str, columns: int) -> str:
    """The end of a label that is longer than an axis."""
    room = _ROOM // columns
    return label if len(label) <= room else f"…{label[1 - room :]}"
