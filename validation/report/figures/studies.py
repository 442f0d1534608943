"""Plots of the convergence studies behind the comparisons, in families with common axes.

Input: outcomes with studies. Output: families, and a figure of each: the chart "Convergence with
mesh" with errors and CPU time over unknowns, or deviations from the limit over the refinement.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from lumped.arrays import Array
from validation.drawing.chart import Chart, Column, Note, Panel, Series, octaves, powers, refined
from validation.drawing.figures import drawn_figure
from validation.drawing.text import number
from validation.run.outcome import Outcome
from validation.studies_and_figures import Figure, Study

if TYPE_CHECKING:
    from matplotlib.axes import Axes

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


# Errors (%) below this are round-off and are not drawn.
_LOWEST = 1e-7
# Smallest number of meshes that shows an order of convergence.
GRIDS = 4
# Notes at the ends of curves are stacked at a distance of _LINE (pt) if the last values of the
# curves differ by less than the factor _NEAR.
_NEAR, _LINE = 2.0, 9.0


def mesh_curves(studies: Sequence[Study]) -> Chart:
    """Chart with a panel for each quantity of the studies: relative errors over unknowns.

    Errors are relative to the extrapolated limits. A quantity without a formal order, such as CPU
    time, is drawn as its values.
    """
    formal = {study.variant: study.formal_order for study in studies if study.formal_order}
    titles = list(dict.fromkeys(study.panel for study in studies))
    panels = [
        _panel([study for study in studies if study.panel == title], formal) for title in titles
    ]
    rows = [(study, index) for study in studies for index in range(len(study.x))]
    table: dict[str, Column] = {
        "quantity": [study.panel for study, _ in rows],
        "mesh": [study.variant for study, _ in rows],
        "unknowns": [study.x[index] for study, index in rows],
        "value": [_values(study)[index] for study, index in rows],
        "unit": [study.unit for study, _ in rows],
        "error (%)": [_error(study, index) for study, index in rows],
    }
    chart = Chart(panels, studies[0].x_label, min(2, len(panels)), 2.0, table)
    limits = "; ".join(_limit(study) for study in studies if study.limits)
    return chart.captioned(
        "Error panels: size of the relative error of one quantity, |value − "
        "limit|/limit, over the number of unknowns of the mesh; the limit is "
        "extrapolated from the hexahedral meshes. Bar: half-width of the uncertainty of "
        "the finest value; it covers the limit if it is at least as large as the error. "
        "Cost panel: CPU time for mesh, factorisation and modes. Held ends: end faces "
        "kept plane and rigid. Free ends: end faces free to warp and contract. "
        "Deflections and torsion are computed with thinner slices along the leg, hence "
        "with more unknowns. On logarithmic scales a straight line with the slope of "
        "the formal order shows asymptotic convergence. Limits, half-widths and observed "
        f"orders: {limits}.",
        *_without_order(studies),
    )


def _without_order(studies: Sequence[Study]) -> list[str]:
    """Sentence on quantities with too few meshes for an order of convergence, with a remedy.

    [] if there are no such quantities.
    """
    meshes: dict[str, int] = {}
    for study in studies:
        if study.formal_order:
            meshes[study.panel] = max(meshes.get(study.panel, 0), len(study.x))
    panels_without_order = [panel for panel, count in meshes.items() if count < GRIDS]
    if not panels_without_order:
        return []
    return [
        (
            f"{', '.join(panels_without_order)}: this preset has fewer than {GRIDS} meshes, "
            "too few to observe an order. To observe the orders of f1 to f4: flexproof "
            "converge ROBOT --body LEG --model solid."
        )
    ]


def _panel(studies: Sequence[Study], formal: Mapping[str, float]) -> Panel:
    curves, ends = [], []
    for study in studies:
        x, sizes = np.array(study.x), _sizes(study)
        order = f" (formal order {formal[study.variant]:.3g})" if study.variant in formal else ""
        bars = None
        if study.formal_order and np.isfinite(sizes[-1]):
            bars = _bar(study, sizes)
        curves.append(Series(f"{study.variant}{order}", x, sizes, of=study.variant, bars=bars))
        visible = np.flatnonzero(np.isfinite(sizes))
        if study.formal_order and len(visible) and len(study.x) >= GRIDS:
            last = int(visible[-1])
            ends.append((float(sizes[last]), float(x[last]), _order(study)))
    unit = "|error| (%)" if studies[0].formal_order else studies[0].y_label
    return Panel(curves, studies[0].panel, unit, _logarithmic, notes=_notes(ends), staggered=False)


def _logarithmic(axes: "Axes") -> None:
    octaves(axes)
    powers(axes)


def _values(study: Study) -> tuple[float, ...]:
    return study.series[study.variant]


def _error(study: Study, index: int) -> float | None:
    """Relative error in per cent of value number `index` of a study against the study's limit.

    None if the study has no limit.
    """
    limit = study.limits.get(study.variant)
    return None if limit is None else 100.0 * (_values(study)[index] / limit - 1.0)


def _sizes(study: Study) -> Array:
    """Magnitudes (n, per cent) of the errors on n meshes. NaN for an error below round-off.

    If the study has no formal order, its values are returned instead, in their unit.
    """
    if not study.formal_order:
        return np.array(_values(study))
    errors = [_error(study, index) for index in range(len(study.x))]
    sizes = np.array([np.nan if error is None else abs(error) for error in errors])
    sizes[sizes < _LOWEST] = np.nan
    return sizes


def _bar(study: Study, sizes: Array) -> Array | None:
    """Lengths (2×n, down and up, per cent) of the error bars at n errors `sizes`.

    The bar at the last error, which belongs to the finest mesh, is the half-width of its
    uncertainty. Downwards it is limited to 90 % of the error. The other lengths are NaN. None if
    the half-width is unknown.
    """
    width = study.uncertainties.get(study.variant)
    if width is None:
        return None
    bars = np.full((2, len(sizes)), np.nan)
    up = 100.0 * width / abs(study.limits[study.variant])
    # A half-width larger than the error would reach below any logarithmic axis.
    bars[:, -1] = min(up, 0.9 * sizes[-1]), up
    return bars


def _order(study: Study) -> str:
    order = study.orders.get(study.variant)
    if order is not None:
        return f"order {order:.2f}"
    return f"{len(study.x)} meshes" if len(study.x) < GRIDS else "no order"


def _limit(study: Study) -> str:
    """Text with limit, half-width and observed order of convergence of one study."""
    width = study.uncertainties.get(study.variant)
    spread = "" if width is None else f" ± {number(width, 2)}"
    value = number(study.limits[study.variant], 6)
    return f"{study.panel}, {study.variant}: {value}{spread} {study.unit}, {_order(study)}"


def _notes(ends: Sequence[tuple[float, float, str]]) -> list[Note]:
    """Notes with orders of convergence at the `ends` of curves, stacked if close to each other.

    An element of `ends` consists of the last error (per cent), its number of unknowns, and the text
    of the note.
    """
    notes: list[Note] = []
    height, last = -3.0, 0.0
    for size, count, text in sorted(ends):
        height = height + _LINE if size < _NEAR * last else -3.0
        notes.append(Note(text, count, size, (5.0, height)))
        last = size
    return notes
