"""A figure of curves, declared: a table, and panels of curves, bars or a matrix over one axis.

`validation.drawing.charts.plot` draws it; what a figure is about stands in neither.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from validation.drawing.charts.scales import Scale
from validation.drawing.style import csv_of

Column: TypeAlias = Sequence[float | str | None]


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
    row. A `matrix` of values from 0 to 1 is shaded. `levels` are grey lines, `band` a shaded
    stripe, in the legend if it is named; `place` heads the columns of the table; `x_label` if it
    is not the chart's.
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


@dataclass(frozen=True, eq=False)
class Chart:
    """Panels row by row in `columns`, `high` inches each, all over one axis, one legend above.

    `table` are the first columns of its data; every curve of a quantity adds its own.
    """

    panels: Sequence[Panel]
    x_label: str
    columns: int = 3
    high: float = 2.0
    table: Mapping[str, Column] = field(default_factory=dict)
    x_scale: Scale | None = None


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
