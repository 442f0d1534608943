"""Drawing of charts with matplotlib: curves, bars, matrices, contours and legends.

Input: a `Chart`. Output: SVG, PNG or a matplotlib figure. A page has dozens of plots; to save time,
text is measured once, by Agg, and the axes are laid out once.
"""

import io
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure as Canvas
from matplotlib.patheffects import withStroke
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
    marker_positions,
    plot_style,
)

# Heights (inches): of axes with differences, of the margins above and below, and between rows.
_DIFFERENCE_HEIGHT, _MARGIN, _ROW_GAP = 1.1, 0.55, 0.25
# Heights (inches) in panels with horizontal bars: of a line of a name, of the gap between rows, of
# a bar.
_LINE, _ROW, _BAR = 0.13, 0.1, 0.14
# Characters that fit below all axes of a row, and in a row of the legend; characters as wide as a
# handle of the legend.
_LABEL_ROOM, _LEGEND_ROOM, _HANDLE = 87, 140, 12
_GREY, _BAND, _BLANK = "#999999", "#009E73", "#e4e4e4"
# Largest number of contour steps; smallest range of values relative to the lowest.
_STEPS, _SMALLEST_RANGE = 8, 1e-3
# Largest number of bars, and smallest part (%), with room for numbers.
_FEW_BARS, _LABELLED = 8, 6.0


def chart_svg(chart: Chart) -> str:
    """Chart as SVG markup, without date and document header."""
    with plot_style():
        buffer = io.StringIO()
        drawing: Any = FigureCanvasSVG(drawn_chart(chart))  # untyped in matplotlib
        drawing.print_svg(buffer, metadata={"Date": None, "Creator": None})
    text = buffer.getvalue()
    return text[text.index("<svg") :]


def chart_png(chart: Chart, dots: int) -> bytes:
    """Chart as PNG with a resolution of `dots` per inch."""
    content = io.BytesIO()
    with plot_style():
        drawn_chart(chart).savefig(content, dpi=dots, format="png")
    return content.getvalue()


@plot_style()
def drawn_chart(chart: Chart) -> Canvas:
    """Matplotlib figure of a chart."""
    rows = -(-len(chart.panels) // chart.columns)
    parts = 2 if any(panel.below for panel in chart.panels) else 1
    height = max([chart.high, *(_height(panel) for panel in chart.panels if panel.lying)])
    heights = rows * (height, _DIFFERENCE_HEIGHT)[:parts]
    size = WIDTH, _MARGIN + sum(heights) + _ROW_GAP * (rows - 1)
    picture = Canvas(figsize=size)
    all_axes = picture.subplots(
        parts * rows, chart.columns, squeeze=False, height_ratios=heights
    ).ravel()
    curves = [curve for panel in chart.panels for curve in (*panel.series, *panel.below)]
    looks = looks_of(curve.look for curve in curves)
    fills = fills_of([bars.label for panel in chart.panels for bars in panel.bars])
    for axes in all_axes:
        axes.set_axis_off()
    for number, panel in enumerate(chart.panels):
        row, column = divmod(number, chart.columns)
        upper, lowest = (
            all_axes[(parts * row + part) * chart.columns + column] for part in (0, parts - 1)
        )
        contents = [panel]
        if parts > 1:
            label = "" if column else "difference (%)"
            contents.append(Panel(panel.below, y_label=label, scale=percent))
            upper.tick_params(labelbottom=False)
        for axes, content in zip((upper, lowest), contents, strict=False):
            if chart.x_scale:
                chart.x_scale(axes)
            _draw_panel(axes, content, looks, fills)
            if column and (panel.lying or panel.contours is not None):
                axes.tick_params(labelleft=False)
        if number + chart.columns >= len(chart.panels):
            label = chart.x_label if panel.x_label is None else panel.x_label
            lowest.set_xlabel(_shortened(label, chart.columns))
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
    positions = _rows(panel) if panel.lying else np.arange(1.0, len(panel.names) + 1.0)
    _draw_bars(axes, panel, positions, fills)
    labels = list(dict.fromkeys(curve.label for curve in panel.series))
    for curve in panel.series:
        if np.isfinite(curve.y).any():
            rank = labels.index(curve.label), len(labels)
            _draw_series(axes, panel, curve, looks[curve.look], rank, positions)
    for level in panel.levels:
        line(level, color=_GREY, linewidth=0.8)
    if panel.lying:
        # Margin for markers at the longest bars, which would otherwise touch the edge.
        axes.use_sticky_edges = False
        axes.margins(x=0.06)
    if panel.scale:
        panel.scale(axes)
    for note in panel.notes:
        axes.annotate(
            note.text,
            (note.x, note.y),
            xytext=note.offset,
            textcoords="offset points",
            annotation_clip=False,
            fontsize=8.5,
            path_effects=[withStroke(linewidth=2.5, foreground="white")],  # over lines and grid
        )
    # Larger distance for contours, so that a star in the corner does not touch the title.
    axes.set_title(panel.title, pad=12.0 if panel.contours is not None else None)
    axes.set_ylabel(panel.y_label)
    if panel.lying:
        axes.set_yticks(positions, panel.names, fontsize=8.5, linespacing=0.95)
        axes.set_ylim(_height(panel), 0.0)
        axes.grid(visible=False, axis="y")


def _draw_series(
    axes: Axes, panel: Panel, curve: Series, look: Look, rank: tuple[int, int], rows: Array
) -> None:
    """Draw the curve of a panel that has the `rank` (index, number of curves).

    The first curve is the widest, so that equal curves are visible. `rows`: vertical positions in a
    panel with horizontal bars.
    """
    points = (curve.y, rows) if panel.lying else (curve.x, curve.y)
    style: dict[str, Any] = {"color": look.colour, "marker": look.marker}
    staggered = panel.staggered and look.line != "none"
    axes.plot(
        *points,
        **style,
        label=curve.label,
        linestyle=look.line,
        linewidth=3.0 - 2.0 * rank[0] / max(rank[1] - 1, 1),
        markevery=marker_positions(len(curve.x), *rank) if staggered else None,
        zorder=5 if panel.lying else None,
    )
    if curve.interval is not None:
        axes.fill_between(curve.x, *curve.interval, color=look.colour, alpha=0.2, linewidth=0.0)
    if curve.bars is not None:
        bars: dict[str, Any] = {"xerr" if panel.lying else "yerr": curve.bars}
        axes.errorbar(*points, **bars, fmt="none", ecolor=look.colour, capsize=3, alpha=0.6)
    if curve.best is not None:
        star: dict[str, Any] = {"marker": "*", "markersize": 13.0, "markeredgecolor": "black"}
        best = curve.x[curve.best], curve.y[curve.best]
        axes.plot(*best, **star, color=look.colour, mfc=look.colour)


def _draw_bars(axes: Axes, panel: Panel, positions: Array, fills: Mapping[str, str]) -> None:
    """Draw the stacked bars of a panel, centred at `positions`.

    Vertical bars have names and numbers if there are few of them. `fills`: colour of each part of
    the bars, by its label.
    """
    if not panel.bars:
        return
    count = len(positions)
    ends = {positive: np.zeros(count) for positive in (False, True)}
    few = count <= _FEW_BARS
    for bars in panel.bars:
        start = np.where(bars.y >= 0.0, ends[True], ends[False])
        look: dict[str, Any] = {"color": fills[bars.label], "label": bars.label}
        if panel.lying:
            axes.barh(positions, bars.y, _BAR, start, hatch=bars.hatch, edgecolor="w", **look)
        else:
            container = axes.bar(positions, bars.y, 0.86, start, **look)
            numbers = [f"{value:.0f}" if few and value >= _LABELLED else "" for value in bars.y]
            if any(numbers):
                dark = sum(int(fills[bars.label][k : k + 2], 16) for k in (1, 3, 5)) < 400
                ink = "white" if dark else "black"
                axes.bar_label(container, numbers, label_type="center", fontsize=8.5, color=ink)
        for positive, end in ends.items():
            ends[positive] = end + np.where((bars.y >= 0.0) == positive, bars.y, 0.0)
    if not panel.lying:
        axes.set(xlim=(0.3, count + 0.7), ylim=(0.0, max(ends[True])))
        axes.set_xticks(*((positions, panel.names) if few else ([1, *range(5, count + 1, 5)],)))
        axes.grid(visible=False, axis="x")


def _draw_matrix(axes: Axes, matrix: Array) -> None:
    """Draw a matrix of values from 0 (white) to 1 (dark).

    Rows run from the top; rows and columns are numbered from one.
    """
    sides = [np.arange(count + 1) + 0.5 for count in matrix.shape]
    axes.pcolormesh(sides[1], sides[0], matrix, cmap="Greys", vmin=0.0, vmax=1.0)
    axes.set(aspect="equal")
    axes.grid(visible=False)
    axes.invert_yaxis()


def _draw_contours(axes: Axes, contours: Contours) -> None:
    """Draw shaded contours with a colour bar.

    Grid points with a value are marked by dots. Areas without values are grey.
    """
    low, high = contours.span
    # A constant needs one contour step, so a range of zero is widened.
    smallest = _SMALLEST_RANGE * abs(low) or _SMALLEST_RANGE
    levels = MaxNLocator(_STEPS).tick_values(low, max(high, low + smallest))
    finite = np.isfinite(contours.values)
    masked = np.ma.masked_where(~finite, contours.values)
    shaded = axes.contourf(contours.x, contours.y, masked.T, levels, cmap=COLOUR_MAP)
    axes.figure.colorbar(shaded, ax=axes, pad=0.03).outline.set_visible(False)
    x, y = np.meshgrid(contours.x, contours.y, indexing="ij")
    axes.plot(x[finite], y[finite], ".", color="white", markersize=2.0)
    if contours.star:
        style: dict[str, Any] = {"markersize": 13.0, "markeredgecolor": "black", "clip_on": False}
        style |= {"color": VERMILLION, "mfc": VERMILLION, "label": contours.star_label}
        axes.plot(*contours.star, "*", **style)
    axes.set(
        xlim=(contours.x.min(), contours.x.max()),
        ylim=(contours.y.min(), contours.y.max()),
        facecolor=_BLANK,
    )
    axes.yaxis.set_major_formatter(lambda value, _: short_number(value))
    axes.grid(visible=False)


def _rows(panel: Panel) -> Array:
    """Centres of horizontal bars (inches from the top). Rows have the height of their names."""
    ends = np.cumsum([_LINE * (name.count("\n") + 1) + _ROW for name in panel.names])
    return np.asarray(0.5 * (ends + np.concatenate([[0.0], ends[:-1]])))


def _height(panel: Panel) -> float:
    return sum(_LINE * (name.count("\n") + 1) + _ROW for name in panel.names)


def _lay_out(picture: Canvas) -> None:
    """Lay out the axes with room for their texts, and place one legend above all of them."""
    FigureCanvasAgg(picture)
    # The figure is enlarged by the legend's height after the layout, because laying out part of a
    # figure would measure all texts twice.
    before = _ticks(picture)
    picture.tight_layout(pad=0.4)
    if _ticks(picture) != before:
        # A changed height can change the ticks, whose labels may then be longer.
        picture.tight_layout(pad=0.4)
    handles: dict[str, Any] = {}
    for axes in picture.axes:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            handles.setdefault(label, handle)
    if not handles:
        return
    for columns in range(_columns(list(handles)), 0, -1):
        legend = picture.legend(
            handles.values(), handles, loc="upper left", ncols=columns, handlelength=3.2
        )
        extent = legend.get_window_extent()
        if extent.width <= picture.bbox.width or columns == 1:
            break
        legend.remove()
    axes_height = picture.get_figheight()
    picture.set_figheight(axes_height + extent.height / picture.dpi)
    share, margins = axes_height / picture.get_figheight(), picture.subplotpars
    picture.subplots_adjust(bottom=share * margins.bottom, top=share * margins.top)


def _ticks(picture: Canvas) -> list[tuple[float, ...]]:
    return [tuple(axes.get_yticks()) for axes in picture.axes]


def _columns(labels: Sequence[str]) -> int:
    """Largest number of columns of a legend that fits, from the lengths of its `labels`."""
    lengths = [max(map(len, label.split("\n"))) + _HANDLE for label in labels]
    counts = (
        count
        for count in range(len(labels), 0, -1)
        if sum(max(column) for column in np.array_split(lengths, count)) <= _LEGEND_ROOM
    )
    return next(counts, 1)


def _shortened(label: str, columns: int) -> str:
    """Label whose lines are not longer than the x axis of a panel in a chart of `columns` panels.

    A longer line is shortened to "…" and its end.
    """
    room = _LABEL_ROOM // columns
    lines = label.split("\n")
    return "\n".join(line if len(line) <= room else f"…{line[1 - room :]}" for line in lines)
