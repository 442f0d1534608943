"""Chart of the relative error over the elements per leg, on logarithmic axes.

Input: convergence series of formulations, by quantity and subject. Output: a `Chart` with one panel
for each quantity of a subject, and its data as a table.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from lumped.acceptance.requirement import AgreementLimits
from lumped.arrays import Array
from validation.comparisons.convergence_series import ConvergenceSeries
from validation.drawing.chart import Chart, Column, Note, Panel, Series, refined
from validation.drawing.text import number
from validation.uncertainty.grid_convergence import COARSE_COUNT

# Errors (%) below this are round-off and are not drawn.
_LOWEST = 1e-7
# Remarks at the ends of curves are stacked, _LINE (pt) apart, if the last errors of the curves
# differ by less than the factor _NEAR.
_NEAR, _LINE = 3.0, 9.0
_LABELLED = (1, 2, 5, 20, 80)
# Smallest ratio of errors that is visible in a figure over eight decades.
_VISIBLE = 1.5
# Relative errors too small to be visible in the figure.
_NEARLY_EXACT = 1e-7


@dataclass(frozen=True, eq=False)
class ErrorPanel:
    """Errors of the quantity in `column` of several formulations, for one leg or robot.

    `name` is the heading of the panel's columns in the data. Of formulations with Timoshenko's
    theory, the error at the element count of table [agree] is written beside the curve.
    """

    name: str
    title: str
    formulations: Sequence[ConvergenceSeries]
    column: int

    @property
    def drawn(self) -> list[ConvergenceSeries]:
        """Formulations except those whose errors nearly equal those with Timoshenko's theory."""
        timoshenko = {
            (series.discretisation, series.counts): series
            for series in self.formulations
            if series.discretisation.theory == "timoshenko"
        }
        drawn = []
        for series in self.formulations:
            key = replace(series.discretisation, theory="timoshenko"), series.counts
            with_shear = timoshenko.get(key, series)
            sizes, sizes_with_shear = (
                np.abs(formulation.errors[:, self.column]) + _NEARLY_EXACT
                for formulation in (series, with_shear)
            )
            fine = np.array(series.counts) >= min(COARSE_COUNT, series.counts[-1])
            ratios = np.abs(np.log(sizes / sizes_with_shear)[fine])
            if with_shear is series or np.max(ratios) > np.log(_VISIBLE):
                drawn.append(series)
        return drawn


def convergence_chart(
    panels: Sequence[ErrorPanel], x_label: str, agreement: AgreementLimits, columns: int = 2
) -> Chart:
    """Chart with one panel for each quantity of a subject; errors in per cent.

    Lines mark the error limit and the element count of `agreement`. `x_label`: label of the axis of
    element counts. `columns`: panels in a row.
    """
    all_counts = {n for panel in panels for series in panel.formulations for n in series.counts}
    counts = np.array(sorted(all_counts), dtype=float)
    columns = min(columns, len(panels))
    drawn = [
        _panel(panel, counts, agreement, leftmost=k % columns == 0)
        for k, panel in enumerate(panels)
    ]
    table: dict[str, Column] = {x_label: counts.tolist()}
    for panel in panels:
        for series in panel.formulations:
            errors = dict(zip(series.counts, 100.0 * series.errors[:, panel.column], strict=True))
            cells = [float(errors[n]) if n in errors else None for n in counts]
            table[f"{panel.name}: {series.discretisation.label}, error (%)"] = cells
    return Chart(drawn, x_label, columns, 2.2, table)


def _panel(
    panel: ErrorPanel, counts: Array, agreement: AgreementLimits, *, leftmost: bool
) -> Panel:
    curves = []
    ends_of_curves: list[tuple[float, float, str]] = []
    stated: list[tuple[float, float, str]] = []
    error, count = 100.0 * agreement.convergence, float(agreement.elements)
    lowest = error
    for series in panel.drawn:
        discretisation, series_counts = series.discretisation, np.array(series.counts, dtype=float)
        sizes = 100.0 * np.abs(series.errors[:, panel.column])
        sizes[sizes < _LOWEST] = np.nan
        label = f"{discretisation.label} (formal order {series.formal_order:g})"
        curves.append(Series(label, series_counts, sizes, of=discretisation.look))
        if not (visible := np.flatnonzero(np.isfinite(sizes)).tolist()):
            continue
        last, remark = visible[-1], series.behaviour(panel.column)
        lowest = min(lowest, float(np.nanmin(sizes)))
        if discretisation.theory == "timoshenko":
            for size in sizes[(series_counts == count) & np.isfinite(sizes)].tolist():
                text = f"{number(size, 2)}\N{NO-BREAK SPACE}%"
                if series_counts[last] == count:
                    remark = f"{text}, {remark}"
                else:
                    stated.append((size, count, text))
        ends_of_curves.append((float(sizes[last]), float(series_counts[last]), remark))
    ends = np.array([counts[0], counts[-1]])
    highest = np.nanmax([np.nanmax(curve.y, initial=error) for curve in curves])
    lines = [Series(f"{error:g} %", ends, np.full(2, error), of="stated error")]
    if counts[0] <= count <= counts[-1]:
        upright = np.full(2, count), np.array([lowest, highest])
        lines.append(Series(f"{count:g} elements", *upright, of="stated count"))
    return Panel(
        [*curves, *lines],
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
