"""Plots of families of studies: refinement with its order and uncertainty, sweeps of models."""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from textwrap import fill

import numpy as np

from lumped.arrays import Array
from validation.drawing.charts.chart import Chart, Column, Note, Panel, Series
from validation.drawing.charts.scales import largest, refined, up_to
from validation.exhibits import Figure
from validation.report.figures.declared import curves
from validation.report.figures.studies.families import Curve, Family

# How long a label (characters) the vertical axis of a sweep has room for.
_AXIS_CHARACTERS = 36
_DEVIATION = "deviation from the limit (%)"


def family_plot(family: Family) -> Figure:
    """The plot of a family with its data."""
    chart = _convergence(family) if family.kind == "convergence" else _sweep(family)
    table: dict[str, Column] = {family.first.x_label: family.first.x}
    table |= {f"{curve.label} ({curve.study.unit})": curve.values for curve in family.curves}
    return curves(replace(chart, table=table), *_reading(family), *family.notes).figure(
        family.id, family.title, "studies", family.computed_by
    )


def _reading(family: Family) -> list[str]:
    if family.kind != "convergence":
        return []
    said = ["Left the deviation from the limit, right its decay; the order stands in the legend."]
    if any(curve.uncertainty is not None for curve in family.curves):
        said.append("The bar at the finest value is its numerical uncertainty.")
    return said


def _sweep(family: Family) -> Chart:
    """All curves over one parameter; modes of one model share its look and its entry."""
    series, notes = [], []
    for curve in family.curves:
        x, values = np.asarray(curve.study.x), np.asarray(curve.values)
        series.append(Series(curve.model, x, values))
        if curve.mode is not None and curve.model == family.curves[0].model:
            notes.append(Note(f"mode {curve.mode}", x[-1], values[-1], (8.0, -3.0)))
    first = family.first
    unit = "" if first.unit in {"1", ""} or first.unit in first.y_label else f" ({first.unit})"
    positive = min(min(curve.values) for curve in family.curves) >= 0.0
    top = largest(one.y for one in series)
    scale = partial(up_to, top=top) if positive else None
    label = fill(f"{first.y_label}{unit}", _AXIS_CHARACTERS)
    return Chart([Panel(series, "", label, scale, notes=notes)], first.x_label, 1, 2.3)


def _convergence(family: Family) -> Chart:
    """Left the deviation from the limit with its uncertainty, right its decay.

    Where no limit is known, the finest value stands in for it. A limit of zero means that the
    values are relative errors themselves.
    """
    orders = sorted({c.study.formal_order for c in family.curves if c.study.formal_order})
    x = np.asarray(family.first.x)
    plain = []
    for curve in family.curves:
        order = f"order {curve.order:.2f}" if curve.order is not None else "no order"
        deviation, bars = _deviation(curve)
        plain.append(Series(f"{curve.label}: {order}", x, deviation, of=curve.label, bars=bars))
    decay = [_decaying(one) for one in plain]
    decay += _slopes(x, decay, orders)
    panels = [
        Panel(plain, "", _DEVIATION, partial(refined, x=x), levels=(0.0,), staggered=False),
        Panel(decay, "", "|deviation| (%)", partial(refined, x=x, decay=True), staggered=False),
    ]
    return Chart(panels, family.first.x_label, 2, 2.2)


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
        Series(f"slope {order:g}", x, line, of="slope")
        for order, line in zip(orders, steep, strict=True)
    ]
