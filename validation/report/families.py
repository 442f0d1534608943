"""Studies that belong together, in the same axes: refinement with its order, sweeps of models."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle
from os.path import commonprefix

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from lumped.arrays import Array
from validation.case import Outcome
from validation.exhibits import Figure, Study
from validation.report.style import (
    OTHERS,
    Look,
    canvas,
    csv_of,
    look_of,
    plot_style,
    svg_of,
)

# Parts of a sweep's id that name a model or a variant of it, not what is swept.
_NAMING = {
    *("simplified", "vjm", "segments", "beam", "solid"),
    *("euler-bernoulli", "timoshenko"),
}


@dataclass(frozen=True)
class Curve:
    """One series of a study under the name it has beside its fellows."""

    label: str
    name: str
    study: Study

    @property
    def values(self) -> tuple[float, ...]:
        """The values of the curve, in the unit of its study."""
        return self.study.series[self.name]

    @property
    def limit(self) -> float | None:
        """What the values tend to, where it is known."""
        return self.study.limits.get(self.name)

    @property
    def order(self) -> float | None:
        """Observed order, where there is one."""
        return self.study.orders.get(self.name)

    @property
    def uncertainty(self) -> float | None:
        """Numerical uncertainty of the finest value."""
        return self.study.uncertainties.get(self.name)


@dataclass(frozen=True)
class Family:
    """Studies with the same abscissa, drawn together."""

    id: str
    title: str
    curves: tuple[Curve, ...]

    @property
    def first(self) -> Study:
        """The study that names the axes."""
        return self.curves[0].study

    @property
    def kind(self) -> str:
        """Convergence or sweep."""
        return self.first.kind

    @property
    def studies(self) -> tuple[Study, ...]:
        """The studies of the family."""
        return tuple({curve.study.id: curve.study for curve in self.curves}.values())

    @property
    def notes(self) -> tuple[str, ...]:
        """What the studies remark, each remark once, with the studies it belongs to."""
        remarks: dict[str, list[str]] = {}
        for curve in self.curves:
            for note in curve.study.notes:
                remarks.setdefault(note, []).append(curve.label)
        return tuple(f"{', '.join(labels)}: {note}." for note, labels in remarks.items())


def families(outcomes: Sequence[Outcome]) -> tuple[Family, ...]:
    """The studies that came with the outcomes by family, in the order of their first member.

    Refinements belong together if their ids differ in the last part alone, sweeps if they differ
    in the names of models; all must have the same kind and abscissa.
    """
    gathered: dict[tuple[str, ...], dict[str, Study]] = {}
    titles: dict[str, list[str]] = {}
    for outcome in outcomes:
        for study in outcome.measurement.studies if outcome.measurement else ():
            stem = _stem(study)
            key = (stem, study.kind, study.x_label, repr(study.x))
            gathered.setdefault(key, {})[study.id] = study
            titles.setdefault(stem, []).append(outcome.case.title)
    stems = [key[0] for key in gathered]
    return tuple(
        _family(
            stem if len(members) > 1 and stems.count(stem) == 1 else next(iter(members)),
            tuple(members.values()),
            titles[stem],
        )
        for (stem, *_), members in gathered.items()
    )


def alone(study: Study) -> Family:
    """A family of one study."""
    return Family(study.id, study.title, tuple(Curve(n, n, study) for n in study.series))


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
    )


def _stem(study: Study) -> str:
    parts = study.id.split(".")
    if study.kind == "convergence":
        return ".".join(parts[:-1]) if len(parts) > 2 else study.id
    kept = [part for part in parts if part not in _NAMING]
    return ".".join(kept) or study.id


def _family(identifier: str, members: Sequence[Study], case_titles: Sequence[str]) -> Family:
    if len(members) == 1:
        return alone(members[0])
    curves: dict[str, Curve] = {}
    for study in members:
        for name in study.series:
            curve = Curve(_label(name, study, members), name, study)
            # Equal curves (the reference of several comparisons) are drawn once.
            curves.setdefault(f"{curve.label} {curve.values!r}", curve)
    title = _common([study.title for study in members]) or _common(case_titles) or identifier
    return Family(identifier, title[0].upper() + title[1:], tuple(curves.values()))


def _common(titles: Sequence[str]) -> str:
    """What the titles begin with, cut at a word."""
    shared = commonprefix(list(titles))  # noqa: RUF071  titles, no paths
    return (shared if shared.endswith((" ", ":")) else shared.rpartition(" ")[0]).rstrip(" :,")


def _label(name: str, study: Study, members: Sequence[Study]) -> str:
    if sum(name in other.series for other in members) == 1:
        return name
    if study.kind == "convergence":
        return study.title.rpartition(": ")[2] or name
    variants = {part for other in members for part in other.id.split(".") if part in _THEORIES}
    own = next((part for part in study.id.split(".") if part in variants), "")
    return f"{name} ({own})" if len(variants) > 1 and own else name


_THEORIES = {"euler-bernoulli", "timoshenko"}


def _reading(family: Family) -> list[str]:
    if family.kind != "convergence":
        return []
    said = ["Left the deviation from the limit, right its decay; the order stands in the legend."]
    if any(curve.uncertainty is not None for curve in family.curves):
        said.append("The bar at the finest value is its numerical uncertainty.")
    return said


def _sweep(family: Family) -> Canvas:
    picture, (axes,) = canvas(height=2.9)
    others = cycle(OTHERS)
    for curve in family.curves:
        look = look_of(curve.label, others)
        dashed = Look(look.colour, look.marker, ":") if "euler" in curve.label else look
        axes.plot(curve.study.x, curve.values, label=curve.label, **dashed.options())
    first = family.first
    unit = "" if first.unit in first.y_label else f" ({first.unit})"
    axes.set(xlabel=first.x_label, ylabel=f"{first.y_label}{unit}")
    axes.set_ylim(0.0, None) if axes.get_ylim()[0] > 0.0 else None
    axes.legend(ncols=2 if len(family.curves) > 4 else 1)
    return picture


def _convergence(family: Family) -> Canvas:
    """Left the deviation from the limit with its uncertainty, right its decay.

    Where no limit is known, the finest value stands in for it. A limit of zero means that the
    values are relative errors themselves.
    """
    picture, (plain, decay) = canvas(columns=2, height=3.4)
    others = cycle(OTHERS)
    x = np.asarray(family.first.x)
    lone = len(family.curves) == 1
    for curve in family.curves:
        look = look_of(curve.label, others) if lone else next(others)
        _draw_curve(plain, decay, x, curve, look)
    orders = {curve.study.formal_order for curve in family.curves}
    for order in sorted(order for order in orders if order is not None):
        _slope(decay, x, order)
    plain.axhline(0.0, color="#999999", linewidth=0.8)
    plain.set(xscale="log", xlabel=family.first.x_label, ylabel="deviation from the limit (%)")
    decay.set(xlabel=family.first.x_label, ylabel="|deviation| (%)")
    for axes in (plain, decay):
        axes.set_xticks(x, [f"{value:g}" for value in x])
        axes.minorticks_off()
    picture.legend(
        *decay.get_legend_handles_labels(), loc="outside upper left", ncols=2, fontsize=8.0
    )
    return picture


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
