"""Errors, orders and half-widths of one formulation over the element count, with text and JSON.

Input: values f(n) of q quantities for ascending element counts n, and their limits f∞. Output:
errors e(n) = f(n)/f∞ − 1, an observed order and half-widths for each quantity.

Rule for the order: it is fitted by least squares to log |e| over the three finest counts whose
errors exceed a hundred times the round-off. There is an order only if the errors of all counts of
five or more elements decrease without a change of sign, and if the orders of the two pairs of
neighbouring counts agree.

Rule for the half-width of count n: it follows from n and the next lower count m, without the limit,
as F |f(n) − f(m)| / ((n/m)^p − 1). p is the observed order, at most the formal one. F = 1.25 if the
order of n and m and the order of m and the count before it are both within a tenth of the formal
one, otherwise 3 (ASME V&V 20). Errors that change sign have no order; their half-width is three
times the largest error of n and all higher counts. With few elements two modes may exchange their
numbers from one count to the next, which two counts cannot reveal.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import msgspec
import numpy as np
from msgspec import UNSET, UnsetType

from lumped.arrays import Array
from lumped.model_choices import Theory
from lumped.text import aligned
from validation.comparisons.discretisations import Discretisation
from validation.drawing.text import number, percent
from validation.record_fields import finite_items
from validation.uncertainty.grid_convergence import (
    CLOSE_TO_FORMAL,
    COARSE_COUNT,
    orders_to_limits,
    pairwise_orders,
)
from validation.uncertainty.half_widths import PROVEN, UNPROVEN, MeshPolicy

# Relative errors for which the smallest sufficient element count is reported.
TARGETS = (0.01, 0.001, 0.0001)
# Relative round-off of frequencies and compliances with 80 elements: ten times the largest seen on
# five processor kernels. Without shear, only bending stiffness connects the nodes, and round-off
# grows with the fourth power of the count.
ROUND_OFF: Mapping[Theory, float] = {"timoshenko": 1e-9, "euler-bernoulli": 2e-7}
# Smallest relative error used to fit an order: round-off of 1e-10 changes it by a hundredth.
_FITTED = 1e-8
# An order requires errors this many times the half-width of the limit.
_ABOVE_LIMIT = 100.0
# Smallest order p used for a half-width, relative to the formal order. It is also used if the last
# three counts show no order.
_LEAST_ORDER = 0.25


@dataclass(frozen=True, eq=False)
class ConvergenceSeries:
    """Values of q quantities by one formulation over n element counts, or n meshes of a solid.

    `formal_order`: order of the frequencies in 1/n. `values` (n×q, units of the study) belong to
    `counts` (n, ascending). `limits` (q): values for infinitely many elements; `limit_half_widths`
    (q): half-widths of their uncertainty, relative. `orders` (q): observed orders in 1/n, NaN if
    there is none. `needed` (targets×q): smallest count from which on the error stays below each of
    `TARGETS`; 0 if the error at the highest count is above it.
    """

    discretisation: Discretisation
    formal_order: float
    counts: tuple[int, ...]
    values: Array
    limits: Array
    limit_half_widths: Array
    orders: Array
    needed: Array

    @cached_property
    def errors(self) -> Array:
        """Relative errors f(n)/f∞ − 1 (n×q).

        Shapes: n element counts, q quantities.
        """
        return relative_errors(self.values, self.limits)

    @property
    def _round_off(self) -> float:
        return ROUND_OFF[self.discretisation.theory]

    @cached_property
    def exact(self) -> Array:
        """True (q) for quantities whose values are exact for every count, apart from round-off.

        Shapes: q quantities.
        """
        return np.asarray(
            np.abs(self.errors).max(axis=0) <= self._round_off + self.limit_half_widths
        )

    @cached_property
    def largest_errors(self) -> Array:
        """Largest |error| over each count and all higher ones (n×q).

        Shapes: n element counts, q quantities.
        """
        sizes = np.abs(self.errors)
        return np.asarray(np.maximum.accumulate(sizes[::-1], axis=0)[::-1])

    @cached_property
    def half_widths(self) -> Array:
        """Relative half-widths of the discretisation uncertainty (n counts × q quantities).

        NaN for the first count. If there is an order, the half-width of a count is computed from
        this and lower counts only, so that it can be compared with the error. Otherwise it is three
        times the largest error of this and all higher counts.
        """
        columns = range(self.values.shape[1])
        return np.column_stack([self._half_widths(column) for column in columns])

    def _half_widths(self, column: int) -> Array:
        sizes, values = 1.0 / np.array(self.counts, dtype=float), self.values[:, column]
        widths = MeshPolicy.to_limit().half_widths(self.largest_errors[:, column])
        if not np.isnan(self.orders[column]) or self.exact[column]:
            steps = np.abs(np.diff(self.errors[:, column]))
            ratios = sizes[:-1] / sizes[1:]
            observed = np.concatenate([[np.nan], pairwise_orders(sizes, values)])
            close = np.abs(observed - self.formal_order) <= CLOSE_TO_FORMAL * self.formal_order
            # A single order may agree by accident, because modes with few elements change numbers.
            proven = close & np.concatenate([[False], close[:-1]])
            factors = np.where(proven, PROVEN, UNPROVEN)
            used = np.clip(
                np.where(np.isnan(observed), _LEAST_ORDER, observed / self.formal_order),
                _LEAST_ORDER,
                1.0,
            )
            used[0] = 1.0
            orders = used * self.formal_order
            for k, step in enumerate(steps):
                policy = MeshPolicy.of_order(ratios[k], orders[k], factors[k])
                widths[k + 1] = policy.half_width(step)
        widths[0] = np.nan
        return np.asarray(widths + self.limit_half_widths[column] + self._round_off)

    def pairwise_orders(self, column: int) -> Array:
        """Observed order (n) of the quantity in `column`, between each count and the one before it.

        NaN for the first count, and for an error close to zero. Shapes: n element counts.
        """
        sizes = np.abs(self.errors[:, column])
        floor = _FITTED + _ABOVE_LIMIT * self.limit_half_widths[column]
        orders = np.full(len(sizes), np.nan)
        for k in range(1, len(sizes)):
            if sizes[k] > floor:
                ratio = np.log(self.counts[k] / self.counts[k - 1])
                orders[k] = np.log(sizes[k - 1] / sizes[k]) / ratio
        return orders

    def asymptotic_order(self, column: int) -> tuple[float, float]:
        """Order of a quantity in 1/n for many elements, and its half-width.

        `column` is that of the quantity. Errors C n^−p (1 + a/n²) at counts k < m < n show the
        orders p₁ = p + b/(km) between the first two counts and p₂ = p + b/(mn) between the last
        two, with a constant b ≈ 2a, so that p = p₂ + (p₂ − p₁) k/(n − k). The half-width is the
        distance of p from the order fitted to the three counts. It is infinite if fewer than two
        pairs of counts have an order.
        """
        fitted, orders = float(self.orders[column]), self.pairwise_orders(column)
        *_, first, last = (-1, -1, *np.flatnonzero(~np.isnan(orders)))
        if first < 0:
            return fitted, float("inf")
        coarsest, finest = self.counts[first - 1], self.counts[last]
        change = float(orders[last] - orders[first]) * coarsest / (finest - coarsest)
        order = float(orders[last]) + change
        return order, abs(order - fitted)

    def behaviour(self, column: int) -> str:
        """Text with the observed order of the quantity in `column`, or why there is none."""
        if self.exact[column]:
            return "exact"
        order = self.orders[column]
        if np.isnan(order):
            return "not monotone" if self._turns(column) else "no order"
        return f"order {order:.2f}"

    def _turns(self, column: int) -> bool:
        errors = self.errors[np.array(self.counts) >= min(COARSE_COUNT, self.counts[-1]), column]
        errors = errors[np.abs(errors) > _FITTED]
        return len(errors) > 1 and bool(
            len(set(np.sign(errors))) > 1 or np.any(np.diff(np.abs(errors)) >= 0.0)
        )


def relative_errors(values: Array, limits: Array) -> Array:
    """Relative errors (n×q) of values v (n×q) against their limits f∞ (q): v/f∞ − 1.

    Zero if value and limit are both zero, as in a direction in which a tool cannot move. Infinite
    if only the limit is zero. Shapes: n element counts, q quantities.
    """
    exact = np.where(values == 0.0, 0.0, np.inf)
    return np.divide(values, limits, out=exact + 1.0, where=limits != 0.0) - 1.0


def fitted_orders(counts: Sequence[int], errors: Array, limit_half_widths: Array) -> Array:
    """Orders in 1/n (q) of relative errors (n×q) against known limits. NaN if there is none.

    An order requires errors above round-off and a hundred times above `limit_half_widths` (q,
    relative), the half-widths of the limits. Shapes: n element counts, q quantities.
    """
    floors = np.maximum(_FITTED, _ABOVE_LIMIT * limit_half_widths)
    return orders_to_limits(counts, errors, floors)


class SeriesRecord(msgspec.Struct, frozen=True, omit_defaults=True, kw_only=True):
    """JSON object of a `ConvergenceSeries`. The key of each mapping is the name of a quantity.

    A missing order or half-width is None. `needed`: smallest element count for each of several
    accepted relative errors, by this error as text. It is None if the error at the highest count
    is larger.
    """

    model: str
    layout: str
    theory: str
    formal_order: float
    elements: Sequence[int] | UnsetType = UNSET
    divisions: Sequence[int] | UnsetType = UNSET
    values: Mapping[str, Any]
    errors: Mapping[str, Any]
    half_widths: Mapping[str, Any]
    orders: Mapping[str, float | None]
    limits: Mapping[str, float | None]
    limit_half_widths: Mapping[str, float | None]
    needed: Mapping[str, Mapping[str, int | None]]


def series_rows(series: ConvergenceSeries, column: int, refined: str, unit: str) -> str:
    """Table of values, errors, half-widths and orders of a quantity by count, with its limit.

    `refined` heads the column of counts, `unit` that of values.
    """
    rows = [
        (
            str(count),
            f"{value:.8g}",
            f"{error:+.3g}",
            "" if half_width is None else f"{half_width:.2g}",
            "" if order is None else f"{order:.2f}",
        )
        for count, value, error, half_width, order in series_cells(series, column)
    ]
    limit = (
        f"{series.limits[column]:.8g}",
        "",
        f"{100.0 * series.limit_half_widths[column]:.2g}",
    )
    headings = (refined, unit, "error (%)", "half-width (%)", "order")
    return aligned(headings, [*rows, ("limit", *limit, "")])


def series_cells(
    series: ConvergenceSeries, column: int
) -> list[tuple[int, float, float, float | None, float | None]]:
    """Count, value, error (%), half-width (%) and order of a quantity, for each count.

    Half-width and order are None if they are unknown, as for the first count.
    """
    return [
        (
            count,
            float(value),
            100.0 * float(error),
            None if np.isnan(half_width) else 100.0 * float(half_width),
            None if np.isnan(order) else float(order),
        )
        for count, value, error, half_width, order in zip(
            series.counts,
            series.values[:, column],
            series.errors[:, column],
            series.half_widths[:, column],
            series.pairwise_orders(column),
            strict=True,
        )
    ]


def short_summary(series: ConvergenceSeries, column: int, stated: int | None) -> str:
    """Text: error at the `stated` count; smallest counts for errors of 1, 0.1 and 0.01 %.

    The text is about the quantity in `column`. Example: "+0.009 % (2, 6, 19)".
    """
    needed = [str(count or f"over {series.counts[-1]}") for count in series.needed[:, column]]
    return f"{_stated_error(series, column, stated)} ({', '.join(needed)})".strip()


def summary(series: ConvergenceSeries, column: int, stated: int | None) -> str:
    """Error at the `stated` count and smallest counts for errors of 1, 0.1 and 0.01 %, in words.

    The text is about the quantity in `column`. The error is omitted if `stated` is None or was not
    computed.
    """
    needed = [
        f"{100.0 * target:g} % needs {count or f'more than {series.counts[-1]}'}"
        for target, count in zip(TARGETS, series.needed[:, column], strict=True)
    ]
    error = _stated_error(series, column, stated)
    return (f"{stated} elements: {error}; " if error else "") + ", ".join(needed)


def _stated_error(series: ConvergenceSeries, column: int, stated: int | None) -> str:
    """Relative error at the `stated` count. "" if it was not computed.

    "below …" if the error is smaller than the round-off.
    """
    if stated not in series.counts:
        return ""
    error = series.errors[series.counts.index(stated), column]
    if abs(error) < ROUND_OFF["timoshenko"]:
        return f"below {number(100.0 * ROUND_OFF['timoshenko'])}\N{NO-BREAK SPACE}%"
    return percent(error)


def series_record(series: ConvergenceSeries, quantities: Sequence[str]) -> SeriesRecord:
    """JSON object of the series.

    `quantities` are the names of the q quantities of the series, in order. The JSON key of the
    counts is the refined parameter: elements of a leg, or divisions of a solid's mesh.
    """
    discretisation = series.discretisation
    counts: dict[str, Any] = {discretisation.refined: series.counts}

    def by_quantity(values: Array) -> dict[str, Any]:
        return dict(zip(quantities, finite_items(values.T), strict=True))

    # The first count has no half-width, because it has no coarser count.
    half_widths = {
        quantity: [None, *finer]
        for quantity, (_, *finer) in by_quantity(series.half_widths).items()
    }
    return SeriesRecord(
        model=discretisation.model,
        layout=discretisation.layout,
        theory=discretisation.theory,
        formal_order=series.formal_order,
        **counts,
        values=by_quantity(series.values),
        errors=by_quantity(series.errors),
        half_widths=half_widths,
        orders=by_quantity(series.orders),
        limits=by_quantity(series.limits),
        limit_half_widths=by_quantity(series.limit_half_widths),
        needed={
            f"{target:g}": {
                quantity: count or None for quantity, count in by_quantity(counts).items()
            }
            for target, counts in zip(TARGETS, series.needed, strict=True)
        },
    )
