"""Plots of the convergence studies behind the comparisons, in families with common axes.

Input: outcomes with studies. Output: families, and a figure of each.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from lumped.arrays import Array
from validation.drawing.chart import Chart, Column, Panel, Series, refined
from validation.drawing.figures import drawn_figure
from validation.report.figures.meshes import mesh_curves
from validation.run.outcome import Outcome
from validation.studies_and_figures import Figure, Study

_DEVIATION = "deviation from the limit (%)"


@dataclass(frozen=True)
class Curve:
    """One series of a study, with its label in the family.

    `limit`: exact or extrapolated value. `order`: observed order of convergence. `uncertainty`:
    half-width of the finest value, in its unit. Each is None if unknown.
    """

    label: str
    study: Study
    values: tuple[float, ...]
    limit: float | None
    order: float | None
    uncertainty: float | None


@dataclass(frozen=True)
class Family:
    """Studies with the same abscissa, drawn together.

    `computed_by`: names of the functions that compute the studies.
    """

    id: str
    title: str
    curves: tuple[Curve, ...]
    computed_by: tuple[str, ...] = ()

    @property
    def studies(self) -> tuple[Study, ...]:
        """Studies of the curves, each once."""
        return tuple({curve.study.id: curve.study for curve in self.curves}.values())

    @property
    def panels(self) -> bool:
        """True if each study names a panel for its curves.

        Each panel has an abscissa of its own.
        """
        return all(curve.study.panel for curve in self.curves)

    @property
    def notes(self) -> tuple[str, ...]:
        """Notes of the studies, each once.

        A note that does not apply to all curves contains the labels of those to which it applies.
        """
        remarks: dict[str, list[str]] = {}
        for curve in self.curves:
            for note in curve.study.notes:
                remarks.setdefault(note.rstrip("."), []).append(curve.label)
        return tuple(
            f"{note}."
            if len(labels) == len(self.curves)
            else f"{note} ({', '.join(dict.fromkeys(labels))})."
            for note, labels in remarks.items()
        )


def families(outcomes: Sequence[Outcome]) -> tuple[Family, ...]:
    """Families of the studies of all outcomes, in the order of their first member."""
    studies_by_key: dict[str, dict[str, Study]] = {}
    makers: dict[str, list[str]] = {}
    for outcome in outcomes:
        for study in outcome.measurement.studies if outcome.measurement else ():
            key = study.family or study.id
            studies_by_key.setdefault(key, {})[study.id] = study
            makers.setdefault(key, []).append(outcome.computed_by)
    return tuple(
        replace(family_of(members.values()), computed_by=tuple(dict.fromkeys(makers[key])))
        for key, members in studies_by_key.items()
    )


def family_of(studies: Iterable[Study]) -> Family:
    """Family of studies.

    The label of a series is the variant of its study, or the name of the series if the study has no
    variant.
    """
    members = tuple(studies)
    curves = tuple(
        Curve(
            study.variant or name,
            study,
            values,
            study.limits.get(name),
            study.orders.get(name),
            study.uncertainties.get(name),
        )
        for study in members
        for name, values in study.series.items()
    )
    title = members[0].family_title or members[0].title
    return Family(members[0].family or members[0].id, title[0].upper() + title[1:], curves)


def study_figure(family: Family) -> Figure:
    """Figure of a family of studies.

    `mesh_curves` draws it if the studies name panels, otherwise `study_curves`.
    """
    chart = mesh_curves(family.studies) if family.panels else study_curves(family)
    return drawn_figure(chart, family.id, family.title, "studies", family.computed_by)


def study_curves(family: Family) -> Chart:
    """Chart of deviations from the limit with half-widths (left) and of their magnitudes (right).

    If no limit is known, the finest value replaces it. A limit of zero means that the values are
    relative errors.
    """
    x = np.asarray(family.curves[0].study.x)
    deviations = []
    for curve in family.curves:
        order = f"order {curve.order:.2f}" if curve.order is not None else "no order"
        deviation, bars = _deviation(curve)
        deviations.append(
            Series(f"{curve.label}: {order}", x, deviation, of=curve.label, bars=bars)
        )
    decay = [_decaying(series) for series in deviations]
    decay += _slopes(x, decay, sorted({c.study.formal_order or 0.0 for c in family.curves} - {0.0}))
    panels = [
        Panel(deviations, "", _DEVIATION, partial(refined, x=x), levels=(0.0,), staggered=False),
        Panel(decay, "", "|deviation| (%)", partial(refined, x=x, decay=True), staggered=False),
    ]
    label = family.curves[0].study.x_label
    table: dict[str, Column] = {label: x.tolist()}
    table |= {f"{curve.label} ({curve.study.unit})": curve.values for curve in family.curves}
    sentences = [
        (
            "Convergence with mesh refinement. Left: deviation of each quantity from its "
            "limit, exact or extrapolated, in percent. Right: size of the deviation on "
            "logarithmic scales, with the slope of the formal order in grey. A curve "
            "parallel to the grey line converges as theory predicts. Observed orders are in "
            "the legend."
        )
    ]
    if any(curve.uncertainty is not None for curve in family.curves):
        sentences.append(
            "Bar at the finest mesh: numerical uncertainty; it should reach zero deviation."
        )
    return Chart(panels, label, 2, 2.2, table).captioned(*sentences, *family.notes)


def _deviation(curve: Curve) -> tuple[Array, Array | None]:
    """Deviations (n, per cent) from the limit, and half-lengths (n, per cent) of their error bars.

    Only the finest value has an error bar; the other half-lengths are NaN. None instead of
    half-lengths if the uncertainty is unknown.
    """
    values = np.asarray(curve.values)
    limit = values[-1] if curve.limit is None else curve.limit
    scale = abs(limit) or 1.0
    if curve.uncertainty is None:
        return 100.0 * (values - limit) / scale, None
    bars = np.full(len(values), np.nan)
    bars[-1] = 100.0 * curve.uncertainty / scale
    return 100.0 * (values - limit) / scale, bars


def _decaying(series: Series) -> Series:
    """Magnitudes of the nonzero deviations of a series, for a logarithmic axis."""
    nonzero = series.y != 0.0
    sizes = np.abs(series.y[nonzero])
    bars = None
    if series.bars is not None and series.bars[-1] > 0.0:
        # An uncertainty larger than the deviation would reach below any logarithmic axis.
        up = series.bars[nonzero]
        bars = np.array([np.minimum(up, 0.9 * sizes), up])
    return replace(series, x=series.x[nonzero], y=sizes, bars=bars)


def _slopes(x: Array, curves: Sequence[Series], orders: Sequence[float]) -> list[Series]:
    """Grey lines with the slopes of the formal orders, below the curves."""
    starts = [series.y[0] for series in curves if len(series.y) > 1]
    if not starts:
        return []
    # Refinement means increasing x for element counts, decreasing x for element sizes.
    sign = -1.0 if x[-1] > x[0] else 1.0
    return [
        Series(f"slope {order:g}", x, 0.5 * min(starts) * (x / x[0]) ** (sign * order), of="slope")
        for order in orders
    ]
