"""Data records of charts: panels of curves, bars or a matrix over one axis, a table, and scales.

Input: arrays and labels. Output: a `Chart`, which `validation.drawing.plot` draws, and its table as
CSV. A scale is a function that changes drawn axes, for example to start at zero, to logarithmic
with plain numbers, or to per cent around zero.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from lumped.arrays import Array
from validation.drawing.style import csv_of
from validation.drawing.text import power_of_ten
from validation.studies_and_figures import FigureStudy

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

Scale: TypeAlias = Callable[["Axes"], None]
Column: TypeAlias = Sequence[float | str | None]
# Number of decades of a logarithmic axis below which ticks at 2 and 5 are added.
_FEW_DECADES = 1.5
# Smallest distance of two labels, as a fraction of the axis.
_SMALLEST_GAP = 0.07


@dataclass(frozen=True, eq=False)
class Series:
    """One curve: `y` over `x` (n each, NaN is a gap), with its `label` in the legend.

    `of`: name of the model whose colour and marker the curve has; "" if `label` is this name.
    `quantity`: quantity with unit; with it, the table has the column "label: quantity". `bars` (n,
    or 2×n for down and up): error bars. `best`: index of the point with a star. `interval` (2×n,
    lowest and highest): shaded band.
    """

    label: str
    x: Array
    y: Array
    quantity: str = ""
    of: str = ""
    bars: Array | None = None
    best: int | None = None
    interval: Array | None = None

    @property
    def look(self) -> str:
        """Name of the model whose colour and marker the curve has."""
        return self.of or self.label


@dataclass(frozen=True, eq=False)
class Bars:
    """One part of each of n stacked bars of a panel, with lengths `y` (n).

    The parts of a bar are stacked from zero, in the order of the `Bars` of the panel.
    """

    label: str
    y: Array
    hatch: str = ""


@dataclass(frozen=True, eq=False)
class Contours:
    """Map with shaded contours of `values` (n×k, NaN is blank) over `x` (n) and `y` (k).

    A `star` marks the point (x, y). `span`: lowest and highest value over all panels of the
    quantity. `star_label`: label of the star in the legend.
    """

    x: Array
    y: Array
    values: Array
    span: tuple[float, float]
    star: tuple[float, float] | None = None
    star_label: str = "worst posture"


@dataclass(frozen=True)
class Note:
    """Small text at an `offset` (pt) from the point (`x`, `y`) of the axes."""

    text: str
    x: float
    y: float
    offset: tuple[float, float] = (5.0, -3.0)


@dataclass(frozen=True, eq=False)
class Panel:
    """One pair of axes with curves, bars, a matrix or contours.

    `below`: curves of differences in per cent, in lower axes. Curves with equal labels, for example
    of several modes, share their look and one entry in the legend. If `staggered`, markers of
    different curves are shifted along x. `bars` are stacked bars, one for each of the `names`. They
    are vertical at x = 1, 2, …, or, if `lying`, horizontal in rows from the top. A curve in a lying
    panel has one value for each row. `matrix`: values from 0 to 1, shaded. `levels`: values of
    horizontal grey lines. `band`: shaded stripe between two values, with `band_label` in the
    legend. `column_prefix`: beginning of the column headings in the table. `x_label` replaces that
    of the chart.
    """

    series: Sequence[Series] = ()
    title: str = ""
    y_label: str = ""
    scale: Scale | None = None
    below: Sequence[Series] = ()
    notes: Sequence[Note] = ()
    levels: Sequence[float] = ()
    band: tuple[float, float] | None = None
    band_label: str = ""
    column_prefix: str = ""
    staggered: bool = True
    x_label: str | None = None
    bars: Sequence[Bars] = ()
    names: Sequence[str] = ()
    lying: bool = False
    matrix: Array | None = None
    contours: Contours | None = None


@dataclass(frozen=True, eq=False)
class Chart:
    """Panels over one axis, row by row in `columns`, each `high` inches high, with one legend.

    `table`: first columns of the data; each curve with a quantity adds a column. `title` replaces
    that of the planned figure if it is not "". `studies`: records of the figure in results.json.
    """

    panels: Sequence[Panel]
    x_label: str
    columns: int = 3
    high: float = 2.0
    table: Mapping[str, Column] = field(default_factory=dict)
    x_scale: Scale | None = None
    caption: str = ""
    title: str = ""
    studies: Sequence[FigureStudy] = ()

    def captioned(self, *sentences: str, title: str = "") -> "Chart":
        """Copy with a title, and a caption of all `sentences` that are not empty."""
        return replace(self, caption=" ".join(filter(None, sentences)), title=title)


def compared_with(against: str) -> str:
    """Caption sentence on panels with the differences of curves from the curve `against`."""
    return (
        f"Lower panels: difference of each curve from the reference, “{against}”, in percent; "
        "zero is exact agreement."
    )


def compared(panel: Panel, against: str) -> Panel:
    """Copy of a panel with lower axes: differences (%) of its curves from the curve `against`.

    Each curve is compared with the curve labelled `against` of the same quantity.
    """
    references = {curve.quantity: curve.y for curve in panel.series if curve.label == against}
    below = [
        replace(curve, y=_difference_in_percent(curve.y, references[curve.quantity]))
        for curve in panel.series
        if curve.label != against and curve.quantity in references
    ]
    return replace(panel, below=below)


def _difference_in_percent(values: Array, reference: Array) -> Array:
    divisor = np.where(np.isfinite(reference) & (reference != 0.0), reference, np.nan)
    return np.asarray(100.0 * (values / divisor - 1.0))


def lettered(panels: Sequence[Panel]) -> list[Panel]:
    """Panels with (a), (b), … before their titles."""
    return [
        replace(panel, title=f"({letter}) {panel.title}")
        for letter, panel in zip("abcdefghi", panels, strict=False)
    ]


def chart_table(chart: Chart) -> str:
    """Table and curves of a chart as CSV, with names and units as headings."""
    columns = {}
    for panel in chart.panels:
        prefix = f"{panel.column_prefix}: " if panel.column_prefix else ""
        for curve in panel.series:
            if curve.quantity and np.isfinite(curve.y).any():
                columns[f"{prefix}{curve.label}: {curve.quantity}"] = curve.y.tolist()
    return csv_of({**chart.table, **columns})


def _ticker() -> Any:
    # matplotlib is slow to import and makes folders. Listing figures does not need it.
    from matplotlib import ticker  # noqa: PLC0415

    return ticker


def from_zero(axes: "Axes", *, top: float | None = None) -> None:
    """Let the y axis start at zero, and end above the curves, or above `top` if it is not None."""
    axes.set_ylim(0.0, 1.08 * axes.get_ylim()[1] if top is None else 1.15 * top)


def with_zero(axes: "Axes") -> None:
    """Let the y axis contain zero, for values of both signs."""
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, 0.0), max(high, 0.0))


def largest(curves: Iterable[Array]) -> float:
    """Largest value of all curves. 1 if none is finite, or if it is 0."""
    values = np.concatenate([np.ravel(curve) for curve in curves])
    return float(np.max(values[np.isfinite(values)], initial=0.0)) or 1.0


def plain_log(axes: "Axes", *, low: float, high: float) -> None:
    """Make the y axis logarithmic from `low` to `high`, with plain numbers at 1, 2 and 5 · 10ᵏ."""
    axes.set(yscale="log", ylim=(low, high))
    axes.yaxis.set_major_locator(_ticker().LogLocator(10.0, subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(_ticker().FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_locator(_ticker().NullLocator())


def powers(axes: "Axes") -> None:
    """Make the y axis logarithmic, with the ticks of `power_ticks`."""
    axes.set_yscale("log")
    power_ticks(axes.yaxis)


def octaves(axes: "Axes") -> None:
    """Make the x axis logarithmic, with the ticks of `power_ticks`."""
    axes.set_xscale("log")
    power_ticks(axes.xaxis)


def degrees(axes: "Axes") -> None:
    """Let the y axis show phases from 0 to −180°, for a response at the point of the force."""
    axes.set_ylim(-190.0, 10.0)
    axes.set_yticks([0.0, -45.0, -90.0, -135.0, -180.0])


def round_angles(axes: "Axes") -> None:
    """Let the y axis show phases from −270° to 90°, for responses away from the force."""
    axes.set_ylim(-280.0, 100.0)
    axes.set_yticks([-270.0, -180.0, -90.0, 0.0, 90.0])


def percent(axes: "Axes", *, limit: float = 1.0, steps: Sequence[float] = (1.0,)) -> None:
    """Make the y axis linear within ± `limit` and logarithmic beyond, for differences of any size.

    Ticks at zero, at the limit, and at `steps` times each power of ten beyond it.
    """
    axes.axhline(0.0, color="#999999", linewidth=0.8)
    values = np.concatenate([[0.0], *(np.asarray(line.get_ydata()) for line in axes.get_lines())])
    # If one side of zero has no large values, it gets the room of the linear range only.
    low, high = 1.6 * min(np.nanmin(values), -limit), 1.6 * max(np.nanmax(values), limit)
    axes.set_yscale("symlog", linthresh=limit, linscale=0.6)
    candidates = (step * 10.0**power for power in range(-6, 7) for step in steps)
    sizes = [limit, *(size for size in candidates if size >= 1.9 * limit)]
    axes.set_yticks([0.0, *(s for size in sizes for s in (-size, size) if low <= s <= high)])
    axes.yaxis.set_major_formatter(
        _ticker().FuncFormatter(lambda value, _: f"{value:+g}" if value else "0")
    )
    axes.yaxis.set_minor_locator(_ticker().NullLocator())
    axes.set_ylim(low, high)


def few_ticks(axes: "Axes", *, count: int = 4, whole: bool = False) -> None:
    """Divide the x axis into at most `count` intervals. Ticks are integers if `whole`."""
    fewest = 1 if whole else 2
    axes.xaxis.set_major_locator(_ticker().MaxNLocator(count, integer=whole, min_n_ticks=fewest))
    axes.xaxis.set_major_formatter(_ticker().FuncFormatter(lambda value, _: short_number(value)))


def side_by_side(axes: "Axes") -> None:
    """Remove the ticks of the x axis, on which items stand side by side."""
    axes.set_xticks([])


def refined(axes: "Axes", *, x: Array, decay: bool = False) -> None:
    """Make the x axis logarithmic with ticks at `x`, labelled if there is room.

    The y axis is logarithmic too if `decay`.
    """
    axes.set_xscale("log")
    if decay:
        axes.set_yscale("log")
        power_ticks(axes.yaxis)
    labels: list[str] = []
    last = -np.inf
    positions = np.abs(np.log(x / x[0])) / (np.ptp(np.log(x)) or 1.0)
    for position, value in zip(positions, x, strict=True):
        has_room = position - last > _SMALLEST_GAP or not labels
        labels.append(f"{value:.3g}" if has_room else "")
        last = position if has_room else last
    axes.set_xticks(x, labels)
    axes.minorticks_off()


def around_zero(axes: "Axes", *, least: float) -> None:
    """Make the x axis symmetric about zero, so that it contains all curves and ± `least`."""
    values = [np.abs(np.asarray(line.get_xdata(), dtype=float)) for line in axes.get_lines()]
    limit = max(least, 1.1 * largest(values))
    axes.set_xlim(-limit, limit)


def power_ticks(axis: "Axis") -> None:
    """Set ticks of a logarithmic axis: powers of ten, and 2 and 5 times these if there are few.

    Labels are plain text, because parsing formulas takes longer than the rest of a plot.
    """
    low, high = axis.get_view_interval()
    decades = np.log10(high / low) if 0.0 < low < high else 0.0
    multiples = (1.0, 2.0, 5.0) if decades < _FEW_DECADES else (1.0,)
    axis.set_major_locator(_ticker().LogLocator(10.0, subs=multiples, numticks=8))
    axis.set_major_formatter(_ticker().FuncFormatter(lambda value, _: short_number(value)))
    axis.set_minor_locator(_ticker().NullLocator())


def short_number(value: float) -> str:
    """Label of a tick: "0.02", "500", "10⁻⁶", "2 × 10⁻⁶"."""
    if 1e-3 <= abs(value) < 1e4 or value == 0.0:
        return f"{value:.4g}"
    mantissa, _, exponent = f"{value:.2e}".partition("e")
    power, digits = power_of_ten(int(exponent)), f"{float(mantissa):g}"
    return power if digits == "1" else f"{digits} × {power}"
