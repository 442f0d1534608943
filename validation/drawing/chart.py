"""A figure of curves, declared: a table, and panels of curves, bars or a matrix over one axis.

`validation.drawing.plot` draws it; what a figure is about stands in neither. Scales of axes: from
zero, logarithmic with plain numbers, percent around zero; those of y are set once the curves are
drawn.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np

from lumped.arrays import Array
from validation.drawing.style import csv_of
from validation.drawing.text import power_of_ten

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis

Scale: TypeAlias = Callable[["Axes"], None]
Column: TypeAlias = Sequence[float | str | None]
_FEW_DECADES = 1.5
# Least distance of two labels as a share of the axis.
_LEAST_GAP = 0.07


@dataclass(frozen=True, eq=False)
class Series:
    """One curve: `y` over `x` (n; NaN leaves a gap), its entry in the legend.

    It looks as the model `of` does, or the one that its label names. `bars` (n, or 2×n down and up)
    are the uncertainty of its points, a star marks the `best` of them. In the table it has a column
    "label: quantity (unit)", none without a `quantity`. `left_open` (2×n, lowest and highest) is
    shaded.
    """

    label: str
    x: Array
    y: Array
    quantity: str = ""
    of: str = ""
    bars: Array | None = None
    best: int | None = None
    left_open: Array | None = None

    @property
    def look(self) -> str:
        """The name whose look it has."""
        return self.of or self.label


@dataclass(frozen=True, eq=False)
class Bars:
    """A part of every bar of a panel, `y` (n) long; parts stack away from zero in their order."""

    label: str
    y: Array
    hatch: str = ""


@dataclass(frozen=True, eq=False)
class Contours:
    """Values (n×m, NaN: blank) over x (n) and y (m), shaded in steps; a `star` marks (x, y).

    Panels of one quantity have one `span`, from the lowest value to the highest.
    """

    x: Array
    y: Array
    values: Array
    span: tuple[float, float]
    star: tuple[float, float] | None = None


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
    Their markers are `staggered` unless each point says something. `bars` stand on 1, 2, … or lie
    in rows from above (`lying`), each with its name; curves in lying panels have a value for each
    row. A `matrix` of values from 0 to 1 is shaded, or `contours`. `levels` are grey lines, `band`
    a shaded stripe, in the legend if it is named; `place` heads the columns of the table; `x_label`
    if it is not the chart's.
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
    place: str = ""
    staggered: bool = True
    x_label: str | None = None
    bars: Sequence[Bars] = ()
    names: Sequence[str] = ()
    lying: bool = False
    matrix: Array | None = None
    contours: Contours | None = None


@dataclass(frozen=True, eq=False)
class Chart:
    """Panels row by row in `columns`, `high` inches each, all over one axis, one legend above.

    `table` are the first columns of its data; every curve of a quantity adds its own. `title` if it
    says more than that of the planned figure. `studies`: its entries in results.json.
    """

    panels: Sequence[Panel]
    x_label: str
    columns: int = 3
    high: float = 2.0
    table: Mapping[str, Column] = field(default_factory=dict)
    x_scale: Scale | None = None
    caption: str = ""
    title: str = ""
    studies: Sequence[Mapping[str, Any]] = ()

    def captioned(self, *sentences: str, title: str = "") -> "Chart":
        """The chart with a title and a caption of the sentences that are not empty."""
        return replace(self, caption=" ".join(filter(None, sentences)), title=title)


def compared_with(against: str) -> str:
    """Sentence of a caption on panels of differences."""
    return f"Lower panels: difference from {against} in percent."


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


def chart_table(chart: Chart) -> str:
    """The table and the curves as CSV, each with its name and unit."""
    columns = {
        f"{panel.place and f'{panel.place}: '}{one.label}: {one.quantity}": one.y.tolist()
        for panel in chart.panels
        for one in panel.series
        if one.quantity and np.isfinite(one.y).any()
    }
    return csv_of({**chart.table, **columns})


def _ticker() -> Any:
    # Slow to import, and makes folders: not for those who only list what could be drawn.
    from matplotlib import ticker  # noqa: PLC0415

    return ticker


def from_zero(axes: "Axes", *, top: float | None = None) -> None:
    """Let the y axis start at zero and leave room above the curves, or above `top`."""
    axes.set_ylim(0.0, 1.08 * axes.get_ylim()[1] if top is None else 1.15 * top)


def largest(curves: Iterable[Array]) -> float:
    """The largest value of any curve; one where none is finite."""
    values = np.concatenate([np.ravel(curve) for curve in curves])
    return float(np.max(values[np.isfinite(values)], initial=0.0)) or 1.0


def plain_log(axes: "Axes", *, low: float, high: float) -> None:
    """Logarithmic y axis from `low` to `high` with ticks 1, 2, 5 and plain numbers."""
    axes.set(yscale="log", ylim=(low, high))
    axes.yaxis.set_major_locator(_ticker().LogLocator(10.0, subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(_ticker().FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_locator(_ticker().NullLocator())


def powers(axes: "Axes") -> None:
    """A logarithmic y axis with ticks at powers of ten, or at 1, 2 and 5 of these."""
    axes.set_yscale("log")
    power_ticks(axes.yaxis)


def octaves(axes: "Axes") -> None:
    """A logarithmic x axis likewise."""
    axes.set_xscale("log")
    power_ticks(axes.xaxis)


def degrees(axes: "Axes") -> None:
    """A y axis of phases from 0 to −180°."""
    axes.set_ylim(-190.0, 10.0)
    axes.set_yticks([0.0, -45.0, -90.0, -135.0, -180.0])


def round_angles(axes: "Axes") -> None:
    """A y axis of any phases: of motions elsewhere than where the force is."""
    axes.set_ylim(-280.0, 100.0)
    axes.set_yticks([-270.0, -180.0, -90.0, 0.0, 90.0])


def percent(axes: "Axes", *, limit: float = 1.0, steps: Sequence[float] = (1.0,)) -> None:
    """Linear within ± `limit`, logarithmic beyond: curves that agree and such that do not.

    Ticks at zero, at the limit, and at `steps` of every power of ten beyond it.
    """
    axes.axhline(0.0, color="#999999", linewidth=0.8)
    drawn = np.concatenate([[0.0], *(np.asarray(line.get_ydata()) for line in axes.get_lines())])
    # Nothing of note on one side of zero needs no room there.
    low, high = 1.6 * min(np.nanmin(drawn), -limit), 1.6 * max(np.nanmax(drawn), limit)
    axes.set_yscale("symlog", linthresh=limit, linscale=0.6)
    beyond = (step * 10.0**power for power in range(-6, 7) for step in steps)
    sizes = [limit, *(size for size in beyond if size >= 1.9 * limit)]
    axes.set_yticks([0.0, *(s for size in sizes for s in (-size, size) if low <= s <= high)])
    axes.yaxis.set_major_formatter(
        _ticker().FuncFormatter(lambda value, _: f"{value:+g}" if value else "0")
    )
    axes.yaxis.set_minor_locator(_ticker().NullLocator())
    axes.set_ylim(low, high)


def few_ticks(axes: "Axes", *, count: int = 4, whole: bool = False) -> None:
    """At most `count` intervals of the x axis, of `whole` numbers if these count something."""
    fewest = 1 if whole else 2
    axes.xaxis.set_major_locator(_ticker().MaxNLocator(count, integer=whole, min_n_ticks=fewest))
    axes.xaxis.set_major_formatter(_ticker().FuncFormatter(lambda value, _: short_number(value)))


def side_by_side(axes: "Axes") -> None:
    """An x axis on which things stand beside each other, without numbers."""
    axes.set_xticks([])


def refined(axes: "Axes", *, x: Array, decay: bool = False) -> None:
    """A logarithmic x axis with ticks at `x`, as far as labels do not meet; so y in a `decay`."""
    axes.set_xscale("log")
    if decay:
        axes.set_yscale("log")
        power_ticks(axes.yaxis)
    labels: list[str] = []
    last = -np.inf
    for place, value in zip(np.abs(np.log(x / x[0])) / (np.ptp(np.log(x)) or 1.0), x, strict=True):
        free = place - last > _LEAST_GAP or not labels
        labels.append(f"{value:.3g}" if free else "")
        last = place if free else last
    axes.set_xticks(x, labels)
    axes.minorticks_off()


def around_zero(axes: "Axes", *, least: float) -> None:
    """An x axis from `least` below zero to as much above it, farther where something is drawn."""
    drawn = [np.abs(np.asarray(line.get_xdata(), dtype=float)) for line in axes.get_lines()]
    limit = max(least, 1.1 * largest(drawn))
    axes.set_xlim(-limit, limit)


def power_ticks(axis: "Axis") -> None:
    """Ticks of a logarithmic axis: powers of ten, or 1, 2 and 5 where there are few of these.

    Labels are plain text: parsing formulas takes longer than all the rest of a plot.
    """
    low, high = axis.get_view_interval()
    decades = np.log10(high / low) if 0.0 < low < high else 0.0
    parts = (1.0, 2.0, 5.0) if decades < _FEW_DECADES else (1.0,)
    axis.set_major_locator(_ticker().LogLocator(10.0, subs=parts, numticks=8))
    axis.set_major_formatter(_ticker().FuncFormatter(lambda value, _: short_number(value)))
    axis.set_minor_locator(_ticker().NullLocator())


def short_number(value: float) -> str:
    """A tick as in print: "0.02", "500", "10⁻⁶", "2 × 10⁻⁶"."""
    if 1e-3 <= abs(value) < 1e4 or value == 0.0:
        return f"{value:.4g}"
    mantissa, _, exponent = f"{value:.2e}".partition("e")
    power, digits = power_of_ten(int(exponent)), f"{float(mantissa):g}"
    return power if digits == "1" else f"{digits} × {power}"
