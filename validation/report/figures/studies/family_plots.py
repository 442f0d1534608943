"""Plots of families of studies: refinement with its order and uncertainty, sweeps of models."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import cycle
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes

from lumped.arrays import Array
from validation.drawing.chart import Chart, Note, Panel, Series, tapered
from validation.drawing.scales import largest, power_ticks, up_to
from validation.drawing.style import LOOKS, OTHERS, Frame, Look, csv_of, known_as
from validation.exhibits import Figure
from validation.report.figures.declared import curves
from validation.report.figures.studies.families import Curve, Family


def family_plot(family: Family) -> Figure:
    """The plot of a family with its data."""
    chart = _convergence(family) if family.kind == "convergence" else _sweep(family)
    columns = {f"{curve.label} ({curve.study.unit})": curve.values for curve in family.curves}
    data = csv_of({family.first.x_label: family.first.x} | columns)
    figure = curves(chart, *_reading(family), *family.notes, data=data)
    return replace(
        figure.figure(family.id, family.title, "studies"), computed_by=family.computed_by
    )


def _reading(family: Family) -> list[str]:
    if family.kind != "convergence":
        return []
    said = ["Left the deviation from the limit, right its decay; the order stands in the legend."]
    if any(curve.uncertainty is not None for curve in family.curves):
        said.append("The bar at the finest value is its numerical uncertainty.")
    return said


def _sweep(family: Family) -> Chart:
    """All curves over one parameter; wide ones below thin ones, so that equal curves all show.

    Modes of one model share its look and its entry in the legend.
    """
    looks = _looks(curve.model for curve in family.curves)
    ranks = list(looks)
    series, notes = [], []
    for curve in family.curves:
        model, rank = curve.model, ranks.index(curve.model)
        width = _PLAIN if model == "simplified" else tapered(rank, len(ranks), 4.4, 1.2)
        x, values = np.asarray(curve.study.x), np.asarray(curve.values)
        series.append(Series(model, x, values, looks[model], width))
        if curve.mode is not None and rank == 0:
            notes.append(Note(f"mode {curve.mode}", x[-1], values[-1], (8.0, -3.0)))
    first = family.first
    unit = "" if first.unit in {"1", ""} or first.unit in first.y_label else f" ({first.unit})"
    positive = min(min(curve.values) for curve in family.curves) >= 0.0
    top = largest(one.y for one in series)
    scale = partial(up_to, top=top) if positive else None
    label = fill(f"{first.y_label}{unit}", _AXIS_CHARACTERS)
    frame = Frame(left=0.95, between=0.0, entries=-(-len(ranks) // 3), right=0.7)
    return Chart(
        [Panel(series, "", label, scale, notes=notes)], first.x_label, 1, 2.3, 3, frame=frame
    )


_PLAIN = 1.6  # pt
# How long a label (characters) the vertical axis of a sweep has room for.
_AXIS_CHARACTERS = 36


def _looks(names: Iterable[str]) -> Mapping[str, Look]:
    """A look for every curve: its model's by name, else one that no other has."""
    others = cycle(OTHERS)
    return {name: LOOKS.get(known_as(name)) or next(others) for name in dict.fromkeys(names)}


def _convergence(family: Family) -> Chart:
    """Left the deviation from the limit with its uncertainty, right its decay.

    Where no limit is known, the finest value stands in for it. A limit of zero means that the
    values are relative errors themselves.
    """
    orders = sorted({c.study.formal_order for c in family.curves if c.study.formal_order})
    x = np.asarray(family.first.x)
    looks = _looks(curve.label for curve in family.curves)
    plain, decay = [], []
    for curve in family.curves:
        order = f"order {curve.order:.2f}" if curve.order is not None else "no order"
        deviation, bars = _deviation(curve)
        one = Series(f"{curve.label}: {order}", x, deviation, looks[curve.label], bars=bars)
        plain.append(one)
        decay.append(_decaying(one))
    decay += _slopes(x, decay, orders)
    entries = len(family.curves) + len(orders)
    frame = Frame(left=0.85, between=0.85, entries=-(-entries // 2))
    panels = [
        Panel(plain, "", _DEVIATION, partial(_refined, x=x), levels=(0.0,), staggered=False),
        Panel(decay, "", "|deviation| (%)", partial(_refined, x=x, decay=True), staggered=False),
    ]
    return Chart(panels, family.first.x_label, 2, 2.2, 2, frame=frame)


_DEVIATION = "deviation from the limit (%)"


def _refined(axes: Axes, *, x: Array, decay: bool = False) -> None:
    """A logarithmic x axis with its own ticks; so y where deviations decay."""
    axes.set_xscale("log")
    if decay:
        axes.set_yscale("log")
        power_ticks(axes.yaxis)
    axes.set_xticks(x, _tick_labels(x))
    axes.minorticks_off()


def _tick_labels(x: Array) -> list[str]:
    """A label for every abscissa, none where it would run into the one before."""
    labels: list[str] = []
    last = -np.inf
    for place, value in zip(np.abs(np.log(x / x[0])) / (np.ptp(np.log(x)) or 1.0), x, strict=True):
        free = place - last > _LEAST_GAP or not labels
        labels.append(f"{value:.3g}" if free else "")
        last = place if free else last
    return labels


# Least distance of two labels as a share of the axis.
_LEAST_GAP = 0.07


def _deviation(curve: Curve) -> tuple[Array, Array | None]:
    """From the limit in percent, with the bar of the finest value where there is one."""
    values = np.asarray(curve.values)
    limit = values[-1] if curve.limit is None else curve.limit
    scale = abs(limit) or 1.0
    if curve.uncertainty is None:
        return 100.0 * (values - limit) / scale, None
    bars = np.full(len(values), np.nan)
    bars[-1] = 100.0 * curve.uncertainty / scale
    return 100.0 * (values - limit) / scale, bars


def _decaying(one: Series) -> Series:
    """The size of a deviation where there is one, for a logarithmic axis."""
    apart = one.y != 0.0
    sizes = np.abs(one.y[apart])
    bars = None
    if one.bars is not None and one.bars[-1] > 0.0:
        # An uncertainty beyond the deviation itself would reach below any logarithmic axis.
        up = one.bars[apart]
        bars = np.array([np.minimum(up, 0.9 * sizes), up])
    return replace(one, x=one.x[apart], y=sizes, bars=bars)


def _slopes(x: Array, drawn: Sequence[Series], orders: Sequence[float]) -> list[Series]:
    """Grey lines of the formal orders below the curves."""
    starts = [one.y[0] for one in drawn if len(one.y) > 1]
    if not starts:
        return []
    # Refinement goes with rising x for element counts, with falling x for mesh sizes.
    sign = -1.0 if x[-1] > x[0] else 1.0
    steep = [0.5 * min(starts) * (x / x[0]) ** (sign * order) for order in orders]
    return [
        Series(f"slope {order:g}", x, line, _GREY, 1.0)
        for order, line in zip(orders, steep, strict=True)
    ]


_GREY = Look("#999999", "")
