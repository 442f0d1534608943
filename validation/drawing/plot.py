"""Charts drawn: the one place that makes matplotlib's curves, bars, matrices and legends.

Text is measured once, by Agg, and the axes are laid out once: a page has dozens of plots.
"""

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure as Canvas
from matplotlib.ticker import MaxNLocator

from lumped.arrays import Array
from validation.drawing.chart import Chart, Contours, Panel, Series, percent, short_number
from validation.drawing.style import (
    COLOUR_MAP,
    VERMILLION,
    WIDTH,
    Look,
    fills_of,
    looks_of,
    marked,
    plot_style,
)

# in, of a row of differences below its panels, of labels around all, and between rows of panels.
_LOW, _AROUND, _BETWEEN = 1.1, 0.55, 0.25
# in, of a line of a row's name, of what a row has besides, and of its bar.
_LINE, _ROW, _BAR = 0.13, 0.1, 0.14
# Letters that fit below all axes of a row, and into all entries of a row of the legend; a handle
# takes as much as so many of them.
_ROOM, _LEGEND_ROOM, _HANDLE = 87, 140, 12
_GREY, _BAND, _BLANK = "#999999", "#009E73", "#e4e4e4"
# Steps of contours at most; and of a value, how much less counts as the same.
_STEPS, _SAME = 8, 1e-3
# Bars, and shares from this one on, have room for numbers.
_FEW, _LABELLED = 8, 6.0


def chart_svg(chart: Chart) -> str:
    """The figure as SVG markup, without date and document header."""
    with plot_style():
        buffer = io.StringIO()
        drawing: Any = FigureCanvasSVG(drawn_chart(chart))  # untyped in matplotlib
        drawing.print_svg(buffer, metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    return text[text.index("<svg") :]


def chart_png(chart: Chart, dots: int) -> bytes:
    """The figure as PNG with so many dots per inch."""
    with plot_style():
        content = io.BytesIO()
        drawn_chart(chart).savefig(content, dpi=dots, format="png")
    return content.getvalue()


def drawn_chart(chart: Chart) -> Canvas:
    """The figure; call it, and save it, in the style of plots."""
    rows = -(-len(chart.panels) // chart.columns)
    parts = 2 if any(panel.below for panel in chart.panels) else 1
    high = max([chart.high, *(_height(panel) for panel in chart.panels if panel.lying)])
    heights = rows * (high, _LOW)[:parts]
    size = WIDTH, _AROUND + sum(heights) + _BETWEEN * (rows - 1)
    picture = Canvas(figsize=size)
    places = picture.subplots(
        parts * rows, chart.columns, squeeze=False, height_ratios=heights
    ).ravel()
    shown = [one for panel in chart.panels for one in (*panel.series, *panel.below)]
    looks = looks_of(one.look for one in shown)
    fills = fills_of([one.label for panel in chart.panels for one in panel.bars])
    for axes in places:
        axes.set_axis_off()
    for number, panel in enumerate(chart.panels):
        row, column = divmod(number, chart.columns)
        above, lowest = (places[(parts * row + k) * chart.columns + column] for k in (0, parts - 1))
        both = [panel]
        if parts > 1:
            label = "" if column else "difference (%)"
            both.append(Panel(panel.below, y_label=label, scale=percent))
            above.tick_params(labelbottom=False)
        for axes, one in zip((above, lowest), both, strict=False):
            if chart.x_scale:
                chart.x_scale(axes)
            _draw_panel(axes, one, looks, fills)
            if column and (panel.lying or panel.contours is not None):
                axes.tick_params(labelleft=False)
        if number + chart.columns >= len(chart.panels):
            label = chart.x_label if panel.x_label is None else panel.x_label
            lowest.set_xlabel(_fitting(label, chart.columns))
    _lay_out(picture)
    return picture


def _draw_panel(
    axes: Axes, panel: Panel, looks: Mapping[str, Look], fills: Mapping[str, str]
) -> None:
    axes.set_axis_on()
    span, line = (axes.axvspan, axes.axvline) if panel.lying else (axes.axhspan, axes.axhline)
    if panel.band:
        span(*panel.band, color=_BAND, alpha=0.12, linewidth=0.0, label=panel.band_label or None)
    if panel.matrix is not None:
        _draw_matrix(axes, panel.matrix)
    if panel.contours is not None:
        _draw_contours(axes, panel.contours)
    at = _rows(panel) if panel.lying else np.arange(1.0, len(panel.names) + 1.0)
    _draw_bars(axes, panel, at, fills)
    labels = list(dict.fromkeys(one.label for one in panel.series))
    for one in panel.series:
        if np.isfinite(one.y).any():
            rank = labels.index(one.label), len(labels)
            _draw_series(axes, panel, one, looks[one.look], rank, at)
    for level in panel.levels:
        line(level, color=_GREY, linewidth=0.8)
    if panel.lying:
        # Markers at the longest bars keep clear of the edge.
        axes.use_sticky_edges = False
        axes.margins(x=0.06)
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
    # A star in the corner of a map keeps clear of the title.
    axes.set_title(panel.title, pad=12.0 if panel.contours is not None else None)
    axes.set_ylabel(panel.y_label)
    if panel.lying:
        axes.set_yticks(at, panel.names, fontsize=8.5, linespacing=0.95)
        axes.set_ylim(_height(panel), 0.0)
        axes.grid(visible=False, axis="y")


def _draw_series(
    axes: Axes, panel: Panel, one: Series, look: Look, rank: tuple[int, int], rows: Array
) -> None:
    """A curve; of a stack of them the lowest is the widest, so that equal ones all show."""
    points = (one.y, rows) if panel.lying else (one.x, one.y)
    style: dict[str, Any] = {"color": look.colour, "marker": look.marker}
    places = marked(len(one.x), *rank) if panel.staggered and look.line != "none" else None
    axes.plot(
        *points,
        **style,
        label=one.label,
        linestyle=look.line,
        linewidth=3.0 - 2.0 * rank[0] / max(rank[1] - 1, 1),
        markevery=places,
        zorder=5 if panel.lying else None,
    )
    if one.left_open is not None:
        axes.fill_between(one.x, *one.left_open, color=look.colour, alpha=0.2, linewidth=0.0)
    if one.bars is not None:
        bars: dict[str, Any] = {"xerr" if panel.lying else "yerr": one.bars}
        axes.errorbar(*points, **bars, fmt="none", ecolor=look.colour, capsize=3, alpha=0.6)
    if one.best is not None:
        star: dict[str, Any] = {"marker": "*", "markersize": 13.0, "markeredgecolor": "black"}
        axes.plot(one.x[one.best], one.y[one.best], **star, color=look.colour, mfc=look.colour)


def _draw_bars(axes: Axes, panel: Panel, at: Array, fills: Mapping[str, str]) -> None:
    """Stacked bars; few standing ones have room for their names, and for numbers on them."""
    if not panel.bars:
        return
    ends = {sign: np.zeros(len(at)) for sign in (False, True)}
    few = len(at) <= _FEW
    for one in panel.bars:
        start = np.where(one.y >= 0.0, ends[True], ends[False])
        look: dict[str, Any] = {"color": fills[one.label], "label": one.label}
        if panel.lying:
            axes.barh(at, one.y, _BAR, start, hatch=one.hatch, edgecolor="w", **look)
        else:
            drawn = axes.bar(at, one.y, 0.86, start, **look)
            said = [f"{value:.0f}" if few and value >= _LABELLED else "" for value in one.y]
            dark = sum(int(fills[one.label][k : k + 2], 16) for k in (1, 3, 5)) < 400
            ink = "white" if dark else "black"
            axes.bar_label(drawn, said, label_type="center", fontsize=8.5, color=ink)
        for sign, reached in ends.items():
            ends[sign] = reached + np.where((one.y >= 0.0) == sign, one.y, 0.0)
    if not panel.lying:
        axes.set(xlim=(0.3, len(at) + 0.7), ylim=(0.0, max(ends[True])))
        axes.set_xticks(*((at, panel.names) if few else ([1, *range(5, len(at) + 1, 5)],)))
        axes.grid(visible=False, axis="x")


def _draw_matrix(axes: Axes, matrix: Array) -> None:
    """Dark where the values are one; rows from above, rows and columns counted from one."""
    sides = [np.arange(count + 1) + 0.5 for count in matrix.shape]
    axes.pcolormesh(sides[1], sides[0], matrix, cmap="Greys", vmin=0.0, vmax=1.0)
    axes.set(aspect="equal")
    axes.grid(visible=False)
    axes.invert_yaxis()


def _draw_contours(axes: Axes, one: Contours) -> None:
    """Shaded steps with their bar; points that have a value are dots, blanks grey."""
    low, high = one.span
    # A value that is the same everywhere has a step, too.
    levels = MaxNLocator(_STEPS).tick_values(low, max(high, low + (_SAME * abs(low) or _SAME)))
    known = np.isfinite(one.values)
    shaded = axes.contourf(
        one.x, one.y, np.ma.masked_where(~known, one.values).T, levels, cmap=COLOUR_MAP
    )
    axes.figure.colorbar(shaded, ax=axes, pad=0.03).outline.set_visible(False)
    x, y = np.meshgrid(one.x, one.y, indexing="ij")
    axes.plot(x[known], y[known], ".", color="white", markersize=2.0)
    if one.star:
        star: dict[str, Any] = {"markersize": 13.0, "markeredgecolor": "black", "clip_on": False}
        axes.plot(*one.star, "*", **star, color=VERMILLION, mfc=VERMILLION, label="worst posture")
    extent = {"xlim": (one.x.min(), one.x.max()), "ylim": (one.y.min(), one.y.max())}
    axes.set(**extent, facecolor=_BLANK)
    axes.yaxis.set_major_formatter(lambda value, _: short_number(value))
    axes.grid(visible=False)


def _rows(panel: Panel) -> Array:
    """Where rows lie (in, from above): each is as high as its name."""
    ends = np.cumsum([_LINE * (name.count("\n") + 1) + _ROW for name in panel.names])
    return np.asarray(0.5 * (ends + np.concatenate([[0.0], ends[:-1]])))


def _height(panel: Panel) -> float:
    return sum(_LINE * (name.count("\n") + 1) + _ROW for name in panel.names)


def _lay_out(picture: Canvas) -> None:
    """One legend above all axes, where it covers nothing, and room for texts around them."""
    FigureCanvasAgg(picture)
    # The legend's height comes on top of what is laid out: in a part of the picture all would be
    # measured twice.
    picture.tight_layout(pad=0.4)
    found: dict[str, Any] = {}
    for axes in picture.axes:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    if not found:
        return
    for columns in range(_columns(list(found)), 0, -1):
        legend = picture.legend(
            found.values(), found, loc="upper left", ncols=columns, handlelength=3.2
        )
        extent = legend.get_window_extent()
        if extent.width <= picture.bbox.width or columns == 1:
            break
        legend.remove()
    below = picture.get_figheight()
    picture.set_figheight(below + extent.height / picture.dpi)
    share, parts = below / picture.get_figheight(), picture.subplotpars
    picture.subplots_adjust(bottom=share * parts.bottom, top=share * parts.top)


def _columns(labels: Sequence[str]) -> int:
    """How many columns a legend of these entries may have room for, by their letters."""
    lengths = [max(map(len, label.split("\n"))) + _HANDLE for label in labels]
    fitting = (
        count
        for count in range(len(labels), 0, -1)
        if sum(max(own) for own in np.array_split(lengths, count)) <= _LEGEND_ROOM
    )
    return next(fitting, 1)


def _fitting(label: str, columns: int) -> str:
    """The end of a label that is longer than an axis."""
    room = _ROOM // columns
    lines = label.split("\n")
    return "\n".join(one if len(one) <= room else f"…{one[1 - room :]}" for one in lines)
