"""Chart of the relative error over the elements per leg, on logarithmic axes.

Input: error curves of formulations, by quantity and subject. Output: a `Chart` with one panel for
each quantity of a subject, and its data as a table.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from lumped.acceptance.requirement import DEFAULT_LIMITS, AgreementLimits
from lumped.arrays import Array
from validation.drawing.chart import Chart, Column, Note, Panel, Series, refined
from validation.drawing.text import number

# Errors (%) below this are round-off and are not drawn.
_LOWEST = 1e-7
# Remarks at the ends of curves are stacked, _LINE (pt) apart, if the last errors of the curves
# differ by less than the factor _NEAR.
_NEAR, _LINE = 3.0, 9.0
_LABELLED = (1, 2, 5, 20, 80)


@dataclass(frozen=True, eq=False)
class ErrorCurve:
    """Relative `errors` (n) of one formulation over element counts (n).

    `name`: the formulation. `label`: its entry in the legend. `remark`: text at the end of the
    curve. `look`: key of `validation.drawing.style.LOOKS`. A curve with `drawn` false is in the
    table of data only. If `stated`, the error at the element count of table [agree] is written
    beside the curve.
    """

    name: str
    label: str
    counts: Array
    errors: Array
    remark: str
    look: str
    drawn: bool = True
    stated: bool = True


@dataclass(frozen=True, eq=False)
class ErrorPanel:
    """Curves of one quantity of one subject. `name` is the heading of its columns in the data."""

    name: str
    title: str
    curves: Sequence[ErrorCurve]


def convergence_chart(
    panels: Sequence[ErrorPanel],
    x_label: str,
    agreement: AgreementLimits = DEFAULT_LIMITS,
    columns: int = 2,
) -> Chart:
    """Chart with one panel for each quantity of a subject; errors in per cent.

    Lines mark the error limit and the element count of `agreement`. `x_label`: label of the axis of
    element counts. `columns`: panels in a row.
    """
    counts = np.unique(np.concatenate([curve.counts for panel in panels for curve in panel.curves]))
    columns = min(columns, len(panels))
    drawn = [
        _panel(panel, counts, agreement, leftmost=k % columns == 0)
        for k, panel in enumerate(panels)
    ]
    table: dict[str, Column] = {x_label: counts.tolist()}
    for panel in panels:
        for curve in panel.curves:
            table[f"{panel.name}: {curve.name}, error (%)"] = _column(curve, counts)
    return Chart(drawn, x_label, columns, 2.2, table)


def _column(curve: ErrorCurve, counts: Array) -> Column:
    """Errors in per cent at all `counts`. None at a count for which the curve has no value."""
    errors = dict(zip(curve.counts.tolist(), (100.0 * curve.errors).tolist(), strict=True))
    return [errors.get(count) for count in counts.tolist()]


def _panel(
    panel: ErrorPanel, counts: Array, agreement: AgreementLimits, *, leftmost: bool
) -> Panel:
    series = []
    ends_of_curves: list[tuple[float, float, str]] = []
    stated: list[tuple[float, float, str]] = []
    error, count = 100.0 * agreement.convergence, float(agreement.elements)
    lowest = error
    for curve in (curve for curve in panel.curves if curve.drawn):
        sizes = 100.0 * np.abs(curve.errors)
        sizes[sizes < _LOWEST] = np.nan
        series.append(Series(curve.label, curve.counts, sizes, of=curve.look))
        if visible := np.flatnonzero(np.isfinite(sizes)).tolist():
            last = visible[-1]
            ends_of_curves.append((float(sizes[last]), float(curve.counts[last]), curve.remark))
            lowest = min(lowest, float(np.nanmin(sizes)))
        at_stated = (curve.counts == count) & np.isfinite(sizes)
        for size in sizes[at_stated & curve.stated].tolist():
            text = f"{number(size, 2)}\N{NO-BREAK SPACE}%"
            stated.append((size, count, text))
    ends = np.array([counts[0], counts[-1]])
    highest = np.nanmax([np.nanmax(line.y, initial=error) for line in series])
    lines = [Series(f"{error:g} %", ends, np.full(2, error), of="stated error")]
    if counts[0] <= count <= counts[-1]:
        upright = np.full(2, count), np.array([lowest, highest])
        lines.append(Series(f"{count:g} elements", *upright, of="stated count"))
    return Panel(
        [*series, *lines],
        panel.title,
        "|error| (%)" if leftmost else "",
        partial(refined, x=_ticks(counts), decay=True),
        notes=[*_notes(ends_of_curves, 5.0, -3.0), *_notes(stated, 3.0, 4.0)],
        staggered=False,
    )


def _notes(texts: Sequence[tuple[float, float, str]], away: float, below: float) -> list[Note]:
    """Notes for the drawing from (error, element count, text). Notes of close points are stacked.

    `away` and `below`: offsets of a note from its point, to the right and downwards (typographic
    points).
    """
    notes: list[Note] = []
    height, last = below, 0.0
    for size, count, text in sorted(texts):
        height = height + _LINE if size < _NEAR * last else below
        notes.append(Note(text, count, size, (away, height)))
        last = size
    return notes


def _ticks(counts: Array) -> Array:
    """Element counts at which the axis has labels: those of `_LABELLED` that were computed.

    If fewer than two of `_LABELLED` were computed, the labels are at all computed counts.
    """
    labelled = counts[np.isin(counts, _LABELLED)]
    return labelled if len(labelled) > 1 else counts
