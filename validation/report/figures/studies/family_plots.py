"""Plots of families of studies: refinement with its order and uncertainty, sweeps of models."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import cycle
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from lumped.arrays import Array
from validation.drawing.style import (
    OTHERS,
    PURPLE,
    Frame,
    Look,
    csv_of,
    framed_canvas,
    framed_legend,
    look_of,
    marked,
    plot_style,
    power_ticks,
    svg_of,
)
from validation.exhibits import Figure, Study
from validation.report.figures.studies.families import Curve, Family, alone


def family_plot(family: Family) -> Figure:
    """The plot of a family with its data."""
    with plot_style():
        picture = _convergence(family) if family.kind == "convergence" else _sweep(family)
        svg = svg_of(picture)
    columns = {f"{curve.label} ({curve.study.unit})": curve.values for curve in family.curves}
    return Figure(
        id=family.id,
        title=family.title,
        caption=" ".join([*_reading(family), *family.notes]),
        section="studies",
        svg=svg,
        data=csv_of({family.first.x_label: family.first.x} | columns),
        computed_by=family.computed_by,
    )


def study_plot(study: Study) -> Figure:
    """The plot of a study alone, with its data."""
    return family_plot(alone(study))


def _reading(family: Family) -> list[str]:
    if family.kind != "convergence":
        return []
    said = ["Left the deviation from the limit, right its decay; the order stands in the legend."]
    if any(curve.uncertainty is not None for curve in family.curves):
        said.append("The bar at the finest value is its numerical uncertainty.")
    return said


def _sweep(family: Family) -> Canvas:
    """All curves over one parameter; wide ones below thin ones, so that equal curves all show.

    Modes of one model share its look and its entry in the legend.
    """
    models = [curve.model for curve in family.curves]
    looks = _sweep_looks(list(dict.fromkeys(models)))
    ranks = list(looks)
    frame = Frame(left=0.95, between=0.0, entries=-(-len(ranks) // 3), right=0.7)
    picture, (axes,) = framed_canvas(frame, columns=1, height=2.3)
    for model, curve in zip(models, family.curves, strict=True):
        rank = ranks.index(model)
        axes.plot(
            curve.study.x,
            curve.values,
            label=model,
            linewidth=_width(model, rank, len(ranks)),
            markevery=marked(len(curve.study.x), rank, len(ranks)),
            **looks[model].options(),
        )
        if curve.mode is not None and rank == 0:
            axes.annotate(
                f"mode {curve.mode}",
                (curve.study.x[-1], curve.values[-1]),
                xytext=(8.0, -3.0),
                textcoords="offset points",
                fontsize=8.5,
            )
    first = family.first
    unit = "" if first.unit in {"1", ""} or first.unit in first.y_label else f" ({first.unit})"
    axes.set(xlabel=first.x_label, ylabel=fill(f"{first.y_label}{unit}", _AXIS_CHARACTERS))
    if min(min(curve.values) for curve in family.curves) >= 0.0:
        axes.set_ylim(0.0, 1.05 * axes.get_ylim()[1])
    handles, labels = axes.get_legend_handles_labels()
    shown = dict(zip(labels, handles, strict=True))
    framed_legend(picture, frame, list(shown.values()), list(shown), columns=3)
    return picture


_WIDEST, _THINNEST, _PLAIN = 4.4, 1.2, 1.6  # pt
# How long a label (characters) the vertical axis of a sweep has room for.
_AXIS_CHARACTERS = 36


def _width(model: str, rank: int, ranks: int) -> float:
    """Width (pt) of a curve: the lumped models below, wide, the others above, thin."""
    if model == "simplified":
        return _PLAIN
    return _WIDEST - (_WIDEST - _THINNEST) * rank / max(ranks - 1, 1)


def _sweep_looks(names: Sequence[str]) -> Mapping[str, Look]:
    """A look for every curve: its model's, for a variant of the model another marker and line."""
    others = cycle(OTHERS)
    variants = cycle((("P", ":"), ("v", "-."), ("X", "--")))
    looks: dict[str, Look] = {}
    for name in names:
        look = look_of(name, others)
        if "Euler" in name:
            look = replace(look, line=":")
        elif look in looks.values():
            marker, line = next(variants)
            look = replace(look, marker=marker, line=line, colour=_VARIANT_COLOUR)
        looks[name] = look
    return looks


_VARIANT_COLOUR = PURPLE


def _convergence(family: Family) -> Canvas:
    """Left the deviation from the limit with its uncertainty, right its decay.

    Where no limit is known, the finest value stands in for it. A limit of zero means that the
    values are relative errors themselves.
    """
    orders = sorted({c.study.formal_order for c in family.curves if c.study.formal_order})
    entries = len(family.curves) + len(orders)
    frame = Frame(left=0.85, between=0.85, entries=-(-entries // 2))
    picture, (plain, decay) = framed_canvas(frame, columns=2, height=2.2)
    others = cycle(OTHERS)
    x = np.asarray(family.first.x)
    lone = len(family.curves) == 1
    for curve in family.curves:
        look = look_of(curve.label, others) if lone else next(others)
        _draw_curve(plain, decay, x, curve, look)
    for order in orders:
        _slope(decay, x, order)
    plain.axhline(0.0, color="#999999", linewidth=0.8)
    plain.set(xscale="log", xlabel=family.first.x_label, ylabel="deviation from the limit (%)")
    decay.set(xlabel=family.first.x_label, ylabel="|deviation| (%)")
    power_ticks(decay.yaxis)
    for axes in (plain, decay):
        axes.set_xticks(x, _tick_labels(x))
        axes.minorticks_off()
    framed_legend(picture, frame, *decay.get_legend_handles_labels(), columns=2)
    return picture


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


def _draw_curve(plain: Axes, decay: Axes, x: Array, curve: Curve, look: Look) -> None:
    values = np.asarray(curve.values)
    limit = values[-1] if curve.limit is None else curve.limit
    scale = abs(limit) or 1.0
    deviation = 100.0 * (values - limit) / scale
    plain.plot(x, deviation, **look.options())
    order = f"order {curve.order:.2f}" if curve.order is not None else "no order"
    apart = deviation != 0.0
    decay.loglog(
        x[apart], np.abs(deviation[apart]), label=f"{curve.label}: {order}", **look.options()
    )
    if curve.uncertainty is None:
        return
    bar = 100.0 * curve.uncertainty / scale
    plain.errorbar(x[-1], deviation[-1], bar, color=look.colour, capsize=4)
    if bar > 0.0 and deviation[-1] != 0.0:
        size = abs(deviation[-1])
        # An uncertainty beyond the deviation itself would reach below any logarithmic axis.
        down = min(bar, 0.9 * size)
        decay.errorbar(x[-1], size, [[down], [bar]], color=look.colour, capsize=4)


def _slope(axes: Axes, x: Array, order: float) -> None:
    """A grey line of the formal order below the curves."""
    curves = [np.asarray(line.get_ydata(), dtype=float) for line in axes.get_lines()]
    drawn = [curve for curve in curves if curve.size > 1]
    if not drawn:
        return
    # Refinement goes with rising x for element counts, with falling x for mesh sizes.
    exponent = -order if x[-1] > x[0] else order
    start = 0.5 * min(curve[0] for curve in drawn)
    axes.loglog(
        x, start * (x / x[0]) ** exponent, color="#999999", linewidth=1.0, label=f"slope {order:g}"
    )
