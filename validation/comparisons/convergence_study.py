"""Records of convergence with element count: values, errors, orders, half-widths, verdicts.

The error of count n is e(n) = f(n)/f∞ − 1. An order is fitted by least squares to log |e| over the
three finest counts whose errors exceed a hundred times the round-off, and only if the errors of all
counts from five on decrease without a change of sign and the two pairwise orders have settled.

The half-width of count n follows from n and the count m before it, without the limit: F |f(n) −
f(m)| / ((n/m)^p − 1), p the observed order but at most the formal one, F = 1.25 if the orders
observed over the last four counts are both within a tenth of that, else 3 (ASME V&V 20). Errors
that change sign give no order; their half-width is three times the largest error of n and of every
finer count. An estimate from two counts cannot see modes that change places between them, as those
of few elements do.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from html import escape
from json import dumps
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from lumped.acceptance.agreement import DEFAULT_LIMITS, AgreementLimits
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import Theory
from lumped.models.segments import Layout
from lumped.text import aligned
from validation.agreement.convergence import (
    CLOSE_TO_FORMAL,
    PROVEN,
    SETTLED,
    UNPROVEN,
    pairwise_orders,
)
from validation.comparisons.convergence_chart import ErrorCurve, ErrorPanel, convergence_chart
from validation.comparisons.readings import Reading, RefinedModel
from validation.drawing.chart import Chart
from validation.drawing.style import csv_of, plot_style
from validation.drawing.text import number, percent

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Relative errors whose smallest element counts are reported.
TARGETS = (0.01, 0.001, 0.0001)
REFINED = {"elements": "element count", "divisions": "mesh"}
X_LABELS = {"elements": "elements per leg", "divisions": "divisions across the section"}
# Relative round-off of frequencies and compliances with 80 elements: ten times the largest that was
# seen on five processor kernels. Without shear, bending stiffness alone joins the nodes, and
# rounding grows with the fourth power of the count.
ROUND_OFF: Mapping[Theory, float] = {"timoshenko": 1e-9, "euler-bernoulli": 2e-7}
# Relative errors from which on an order is fitted: round-off of 1e-10 changes them by a hundredth.
_FITTED = 1e-8
# An order needs errors this many times the half-width of their limit.
_ABOVE_LIMIT = 100.0
# Share of the formal order that a half-width takes at least, and if three counts show none.
_LEAST_ORDER = 0.25
# Ratio of errors that can be told apart in a figure over eight decades.
_VISIBLE = 1.5
# Relative errors that make no difference in it.
_NEARLY_EXACT = 1e-7
# Below so many elements no series is expected to be asymptotic.
_COARSE = 5


@dataclass(frozen=True, eq=False)
class ConvergenceSeries:
    """Values of one formulation over the element count, or over the divisions of a solid's mesh.

    `formal_order` is that of the frequencies in 1/n. `values` (n×q, units of the study) belong to
    `counts` (n, ascending). `limits` (q) are
    the values for infinitely many elements, `limit_half_widths` (q) their relative uncertainty,
    `orders` (q) the observed ones in 1/n, NaN if there is none.
    `needed` (targets×q) are the smallest counts from which on the error stays below each of
    `TARGETS`; 0 if the finest count of the series misses it.
    """

    reading: Reading
    formal_order: float
    counts: tuple[int, ...]
    values: Array
    limits: Array
    limit_half_widths: Array
    orders: Array
    needed: Array

    @cached_property
    def errors(self) -> Array:
        """Relative errors f(n)/f∞ − 1 (n×q)."""
        return np.asarray(self.values / self.limits - 1.0)

    @property
    def _round_off(self) -> float:
        return ROUND_OFF[self.reading.theory]

    @cached_property
    def exact(self) -> Array:
        """Quantities (q, bool) whose values are exact, apart from round-off, for every count."""
        return np.asarray(
            np.abs(self.errors).max(axis=0) <= self._round_off + self.limit_half_widths
        )

    @cached_property
    def largest_errors(self) -> Array:
        """Largest |error| of this and every finer count (n×q)."""
        sizes = np.abs(self.errors)
        return np.asarray(np.maximum.accumulate(sizes[::-1], axis=0)[::-1])

    @cached_property
    def half_widths(self) -> Array:
        """Relative half-widths of the discretisation uncertainty (n×q), NaN for the first count.

        With an order from this and the coarser counts alone, so that they can be held against the
        limit; without one, three times the largest error of this and every finer count.
        """
        columns = range(self.values.shape[1])
        return np.column_stack([self._half_widths(column) for column in columns])

    def _half_widths(self, column: int) -> Array:
        sizes, values = 1.0 / np.array(self.counts, dtype=float), self.values[:, column]
        widths = UNPROVEN * self.largest_errors[:, column]
        if not np.isnan(self.orders[column]) or self.exact[column]:
            steps = np.abs(np.diff(values)) / np.abs(self.limits[column])
            ratios = sizes[:-1] / sizes[1:]
            observed = np.concatenate([[np.nan], pairwise_orders(sizes, values)])
            close = np.abs(observed - self.formal_order) <= CLOSE_TO_FORMAL * self.formal_order
            # One order alone may be near by accident, where modes of coarse legs change places.
            proven = close & np.concatenate([[False], close[:-1]])
            factors = np.where(proven, PROVEN, UNPROVEN)
            used = np.clip(
                np.where(np.isnan(observed), _LEAST_ORDER, observed / self.formal_order),
                _LEAST_ORDER,
                1.0,
            )
            used[0] = 1.0
            widths[1:] = factors * steps / (ratios ** (used * self.formal_order) - 1.0)
        widths[0] = np.nan
        return np.asarray(widths + self.limit_half_widths[column] + self._round_off)

    def pairwise_orders(self, column: int) -> Array:
        """Order between each count and the one before (n); NaN for the first and near the limit."""
        sizes = np.abs(self.errors[:, column])
        floor = _FITTED + _ABOVE_LIMIT * self.limit_half_widths[column]
        orders = np.full(len(sizes), np.nan)
        for k in range(1, len(sizes)):
            if sizes[k] > floor:
                ratio = np.log(self.counts[k] / self.counts[k - 1])
                orders[k] = np.log(sizes[k - 1] / sizes[k]) / ratio
        return orders

    def behaviour(self, column: int) -> str:
        """Observed order, or the reason why there is none."""
        if self.exact[column]:
            return "exact"
        order = self.orders[column]
        if np.isnan(order):
            return "not monotone" if self._turns(column) else "no order"
        return f"order {order:.2f}"

    def _turns(self, column: int) -> bool:
        errors = self.errors[np.array(self.counts) >= min(_COARSE, self.counts[-1]), column]
        errors = errors[np.abs(errors) > _FITTED]
        return len(errors) > 1 and bool(
            len(set(np.sign(errors))) > 1 or np.any(np.diff(np.abs(errors)) >= 0.0)
        )


@dataclass(frozen=True, eq=False)
class ConvergenceStudy:
    """Convergence of a leg or of a robot with element count, or with the mesh of solids.

    `subject`: the body's name, empty for the whole robot, which stands in `pose` (m, rad).
    `quantities` (q) are f1, f2, … (Hz) and x, y, z: the deflection of the tip or tool under a unit
    force along that axis (m/N). `reference` names the source of the limits. `agreement`: the
    element count whose error is stated, and the limit on it.
    """

    robot: str
    subject: str
    pose: tuple[float, ...]
    quantities: tuple[str, ...]
    units: tuple[str, ...]
    reference: str
    series: tuple[ConvergenceSeries, ...]
    refined: Literal["elements", "divisions"] = "elements"
    agreement: AgreementLimits = DEFAULT_LIMITS

    @property
    def title(self) -> str:
        """The subject and its boundary conditions."""
        if self.subject:
            return f"{self.subject}, clamped–free"
        pose = ", ".join(f"{coordinate:.4g}" for coordinate in self.pose)
        return f"whole robot at ({pose})" if pose else "whole robot"

    def of(
        self, model: RefinedModel, layout: Layout = "half", theory: Theory = "timoshenko"
    ) -> ConvergenceSeries:
        """The series of a formulation; raises InputError if it was not computed."""
        for series in self.series:
            reading = series.reading
            if (reading.model, reading.layout, reading.theory) == (model, layout, theory):
                return series
        labels = "; ".join(series.reading.label for series in self.series)
        raise InputError(f"{model}, {layout}, {theory}: was not computed; there are: {labels}")

    def column(self, quantity: str) -> int:
        """Column of a quantity; raises InputError for one that the study does not have."""
        if quantity not in self.quantities:
            known = ", ".join(self.quantities)
            raise InputError(f'quantity "{quantity}": must be one of {known}')
        return self.quantities.index(quantity)

    def assert_converged(
        self,
        quantity: str,
        elements: int | None = None,
        within: float | None = None,
        *,
        model: RefinedModel = "segments",
        layout: Layout = "half",
        theory: Theory = "timoshenko",
    ) -> None:
        """Raise AssertionError if the error at `elements` and at any finer count exceeds `within`.

        None: those of `agreement`, 20 elements and 1 % if the robot file does not change them; for
        solids the finest mesh. The error counts with the half-width of its limit. Raises InputError
        for a quantity, a formulation or an element count that was not computed.
        """
        series = self.of(model, layout, theory)
        count = self.stated_count(series) if elements is None else elements
        allowed = self.agreement.convergence if within is None else within
        self._require_converged(series, quantity, count, allowed)

    def stated_count(self, series: ConvergenceSeries) -> int:
        """The element count whose error is stated, or the divisions of the finest mesh."""
        return series.counts[-1] if self.refined == "divisions" else self.agreement.elements

    def _require_converged(
        self, series: ConvergenceSeries, quantity: str, count: int, within: float
    ) -> None:
        column = self.column(quantity)
        if count not in series.counts:
            known = ", ".join(map(str, series.counts))
            raise InputError(f"{self.refined} = {count}: was not computed; must be one of {known}")
        place = series.counts.index(count)
        bound = series.largest_errors[place, column] + series.limit_half_widths[column]
        if not bound <= within:
            raise AssertionError(
                f"{series.reading.label}, {self.title}, {quantity}: the error with {count} "
                f"{self.refined} or more reaches {_size(bound)}, allowed {_size(within)}; "
                f"{series.behaviour(column)}; {self.summary(series, column)}".replace(
                    "\N{NO-BREAK SPACE}", " "
                )
            )

    def table(self, quantity: str = "f1") -> str:
        """Values, errors and orders of one quantity over the element count, as plain text.

        Below them a line on every other quantity by formulation.
        """
        column = self.column(quantity)
        lines = [
            f"{self.robot}, {self.title}: convergence with {REFINED[self.refined]}",
            f"errors relative to the {self.reference}",
        ]
        for series in self.series:
            lines += ["", f"{series.reading.label}: {quantity}", self._rows(series, column)]
            others = [k for k in range(len(self.quantities)) if k != column]
            lines += [
                f"  {self.quantities[k]}: {series.behaviour(k)}; {self.summary(series, k)}"
                for k in (column, *others)
            ]
        return "\n".join(lines).replace("\N{NO-BREAK SPACE}", " ")

    def _rows(self, series: ConvergenceSeries, column: int) -> str:
        orders = series.pairwise_orders(column)
        rows = [
            (
                str(count),
                f"{series.values[k, column]:.8g}",
                f"{100.0 * series.errors[k, column]:+.3g}",
                _shown(100.0 * series.half_widths[k, column], ".2g"),
                _shown(orders[k], ".2f"),
            )
            for k, count in enumerate(series.counts)
        ]
        limit = (
            f"{series.limits[column]:.8g}",
            "",
            f"{100.0 * series.limit_half_widths[column]:.2g}",
        )
        headings = (self.refined, self.units[column], "error (%)", "half-width (%)", "order")
        return aligned(headings, [*rows, ("limit", *limit, "")])

    def record(self) -> dict[str, Any]:
        """The study as plain data; JSON has null for an order that there is none of."""
        return {
            "schema": 1,
            "kind": "convergence",
            "robot": self.robot,
            "body": self.subject or None,
            "pose": list(self.pose),
            "reference": self.reference,
            "quantities": list(self.quantities),
            "units": dict(zip(self.quantities, self.units, strict=True)),
            "series": [self._series_record(series) for series in self.series],
        }

    def study_records(self) -> tuple[dict[str, Any], ...]:
        """An entry of `studies` in results.json for each quantity; null at counts not computed."""
        counts = sorted({count for series in self.series for count in series.counts})
        return tuple(
            {
                "id": f"convergence.{self.subject or 'robot'}.{quantity}",
                "kind": "convergence",
                "title": f"{self.title}: {quantity}, convergence with {REFINED[self.refined]}",
                "x_label": X_LABELS[self.refined],
                "y_label": quantity,
                "unit": self.units[k],
                "x": counts,
                "series": {
                    one.reading.label: [
                        float(one.values[one.counts.index(count), k])
                        if count in one.counts
                        else None
                        for count in counts
                    ]
                    for one in self.series
                },
                "formal_order": {one.reading.label: one.formal_order for one in self.series},
                "order": {
                    one.reading.label: float(one.orders[k])
                    for one in self.series
                    if not np.isnan(one.orders[k])
                },
                "uncertainty": {
                    one.reading.label: float(one.half_widths[-1, k] * abs(one.values[-1, k]))
                    for one in self.series
                },
                "limit": {one.reading.label: float(one.limits[k]) for one in self.series},
                "theory": {one.reading.label: one.reading.theory for one in self.series},
                "needed": {
                    one.reading.label: {
                        f"{target:g}": int(row[k]) or None
                        for target, row in zip(TARGETS, one.needed, strict=True)
                    }
                    for one in self.series
                },
                "stated": self.agreement.elements,
                "notes": [self.reference],
            }
            for k, quantity in enumerate(self.quantities)
        )

    def json(self) -> str:
        """The record as JSON text."""
        return dumps(self.record(), allow_nan=False)

    def missed(self, quantity: str, within: float | None = None) -> list[str]:
        """A line for each formulation whose error at the stated count exceeds `within`.

        The stated count is that of `agreement`, or the finest mesh of solids. The literal layout of
        the paper is shown and not judged. Raises InputError if the count was not computed.

        `within` None: the limit of `agreement`, which is about elements; nothing if its count was
        not computed.
        """
        lines: list[str] = []
        if within is None and self.refined == "divisions":
            return lines
        allowed = self.agreement.convergence if within is None else within
        for series in self.series:
            reading = series.reading
            if reading.layout == "literal":
                continue
            count = self.stated_count(series)
            if within is None and count not in series.counts:
                continue
            try:
                self._require_converged(series, quantity, count, allowed)
            except AssertionError as error:
                lines.append(str(error))
        return lines

    def csv(self) -> str:
        """One row per formulation and element count: values, then relative errors."""
        rows = [
            (series, place, count)
            for series in self.series
            for place, count in enumerate(series.counts)
        ]
        columns: dict[str, list[float | str | None]] = {
            "model": [series.reading.model for series, _, _ in rows],
            "layout": [series.reading.layout for series, _, _ in rows],
            "theory": [series.reading.theory for series, _, _ in rows],
            "body": [self.subject or "robot" for _ in rows],
            self.refined: [count for _, _, count in rows],
        }
        for column, (quantity, unit) in enumerate(zip(self.quantities, self.units, strict=True)):
            columns[f"{quantity} ({unit})"] = [float(s.values[k, column]) for s, k, _ in rows]
        for column, quantity in enumerate(self.quantities):
            columns[f"{quantity} relative error"] = [float(s.errors[k, column]) for s, k, _ in rows]
        return csv_of(columns)

    def plot(self, quantities: Sequence[str] = ("f1", "f2", "f3", "f4")) -> "Figure":
        """Errors over the element count on logarithmic axes, a panel for each quantity.

        Raises InputError for a quantity that the study does not have.
        """
        # Only a picture needs the library that draws it.
        from validation.drawing.plot import drawn_chart  # noqa: PLC0415

        with plot_style():
            return drawn_chart(self.chart(quantities))

    def picture(self, kind: str, dots: int) -> bytes:
        """The errors of f1 to f4 as ".svg", or as ".png" with `dots` per inch."""
        # Only a picture needs the library that draws it.
        from validation.drawing.plot import chart_png, chart_svg  # noqa: PLC0415

        chart = self.chart(("f1", "f2", "f3", "f4"))
        return chart_svg(chart).encode() if kind == ".svg" else chart_png(chart, dots)

    def chart(self, quantities: Sequence[str]) -> Chart:
        """The figure declared; raises InputError for a quantity that the study does not have."""
        panels = [self.panel(one) for one in quantities]
        return convergence_chart(panels, X_LABELS[self.refined], self.agreement)

    def panel(self, quantity: str) -> ErrorPanel:
        """The errors of one quantity as they are drawn.

        Beside Timoshenko's theory the other one is drawn only if its errors are visibly different.
        """
        column = self.column(quantity)
        limit = self.series[0].limits[column]
        shown = (
            f"{limit:.4g} Hz"
            if self.units[column] == "Hz"
            else f"{number(1e9 * limit, 3)} µm at 1 kN"
        )
        return ErrorPanel(
            f"{self.subject or 'robot'}: {quantity}",
            f"{self.subject or 'robot'}: {quantity} = {shown}",
            tuple(
                ErrorCurve(
                    series.reading.label,
                    f"{series.reading.legend} (formal order {series.formal_order:g})",
                    np.array(series.counts, dtype=float),
                    series.errors[:, column],
                    series.behaviour(column),
                    series.reading.look,
                    self._visible(series, column),
                    series.reading.theory == "timoshenko",
                )
                for series in self.series
            ),
        )

    def _visible(self, series: ConvergenceSeries, column: int) -> bool:
        """True unless the same formulation by Timoshenko's theory has nearly equal errors."""
        twin = replace(series.reading, theory="timoshenko")
        for other in self.series:
            if other is not series and other.reading == twin and other.counts == series.counts:
                pairs = np.abs([series.errors[:, column], other.errors[:, column]]) + _NEARLY_EXACT
                fine = np.array(series.counts) >= min(_COARSE, series.counts[-1])
                ratios = np.log(pairs[0] / pairs[1])[fine]
                return bool(np.max(np.abs(ratios)) > np.log(_VISIBLE))
        return True

    def _series_record(self, series: ConvergenceSeries) -> dict[str, Any]:
        by_quantity = dict(enumerate(self.quantities))
        return {
            "model": series.reading.model,
            "layout": series.reading.layout,
            "theory": series.reading.theory,
            "formal_order": series.formal_order,
            self.refined: list(series.counts),
            "values": {q: series.values[:, k].tolist() for k, q in by_quantity.items()},
            "errors": {q: series.errors[:, k].tolist() for k, q in by_quantity.items()},
            # Nothing can be stated of the first count.
            "half_widths": {
                q: [None, *series.half_widths[1:, k].tolist()] for k, q in by_quantity.items()
            },
            "orders": {
                q: None if np.isnan(series.orders[k]) else float(series.orders[k])
                for k, q in by_quantity.items()
            },
            "limits": {q: float(series.limits[k]) for k, q in by_quantity.items()},
            "limit_half_widths": {
                q: float(series.limit_half_widths[k]) for k, q in by_quantity.items()
            },
            "needed": {
                f"{target:g}": {q: int(row[k]) or None for k, q in by_quantity.items()}
                for target, row in zip(TARGETS, series.needed, strict=True)
            },
        }

    def short_summary(self, series: ConvergenceSeries, column: int) -> str:
        """Error with the stated count and the smallest counts: "+0.009 % (2, 6, 19)"."""
        needed = [str(count or f"over {series.counts[-1]}") for count in series.needed[:, column]]
        return f"{self._stated_error(series, column)} ({', '.join(needed)})".strip()

    def summary(self, series: ConvergenceSeries, column: int) -> str:
        """Error with the stated count, and the smallest counts for 1 %, 0.1 % and 0.01 %."""
        needed = [
            f"{100.0 * target:g} % needs {count or f'more than {series.counts[-1]}'}"
            for target, count in zip(TARGETS, series.needed[:, column], strict=True)
        ]
        error = self._stated_error(series, column)
        stated = f"{self.agreement.elements} elements: {error}; " if error else ""
        return stated + ", ".join(needed)

    def _stated_error(self, series: ConvergenceSeries, column: int) -> str:
        """Error with the stated count of elements; "" if it was not computed."""
        count = self.agreement.elements
        if self.refined != "elements" or count not in series.counts:
            return ""
        return _percent(series.errors[series.counts.index(count), column])

    def _repr_html_(self) -> str:
        return f"<pre>{escape(self.table())}</pre>"


def _shown(value: float, digits: str) -> str:
    return "" if np.isnan(value) else f"{value:{digits}}"


def _size(error: float) -> str:
    return percent(error, signed=False)


def _percent(error: float) -> str:
    """A relative error in percent; below the round-off it is only bounded."""
    if abs(error) < ROUND_OFF["timoshenko"]:
        return f"below {number(100.0 * ROUND_OFF['timoshenko'])}\N{NO-BREAK SPACE}%"
    return percent(error)


def fitted_orders(counts: Sequence[int], errors: Array, limit_half_widths: Array) -> Array:
    """Orders in 1/n (q) of the relative `errors` (n×q) from known limits; NaN if there is none.

    An order needs errors above round-off and a hundred times above the half-width of their limit.
    """
    floors = np.maximum(_FITTED, _ABOVE_LIMIT * limit_half_widths)
    return np.array(
        [_order(counts, own, floor) for own, floor in zip(errors.T, floors, strict=True)]
    )


def _order(counts: Sequence[int], errors: Array, floor: float) -> float:
    """Order fitted over the three finest counts with |error| above `floor`, or NaN."""
    usable = [place for place, error in enumerate(errors) if abs(error) > floor]
    asymptotic = [place for place in usable if counts[place] >= _COARSE]
    usable = asymptotic if len(asymptotic) >= 3 else usable
    # Errors must decrease over all of these counts, not only over the three that are fitted.
    sizes, signs = np.abs(errors[usable]), np.sign(errors[usable])
    if len(usable) < 3 or len(set(signs)) > 1 or np.any(np.diff(sizes) >= 0.0):
        return float("nan")
    logarithms = -np.log(np.array(counts, dtype=float)[usable[-3:]]), np.log(sizes[-3:])
    pairwise = np.diff(logarithms[1]) / np.diff(logarithms[0])
    if abs(pairwise[1] - pairwise[0]) > SETTLED * pairwise[1]:
        return float("nan")
    return float(np.polyfit(*logarithms, 1)[0])
