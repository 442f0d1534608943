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
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lumped.arrays import Array
from lumped.legs import Theory
from validation.comparisons.discretisations import Discretisation
from validation.uncertainty.grid_convergence import (
    CLOSE_TO_FORMAL,
    COARSE_COUNT,
    orders_to_limits,
    pairwise_orders,
)
from validation.uncertainty.mesh_half_widths import PROVEN, UNPROVEN, MeshPolicy, mesh_half_widths

# Relative errors whose smallest element counts are reported.
TARGETS = (0.01, 0.001, 0.0001)
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
        """Relative errors f(n)/f∞ − 1 (n×q)."""
        return relative_errors(self.values, self.limits)

    @property
    def _round_off(self) -> float:
        return ROUND_OFF[self.discretisation.theory]

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
        widths = mesh_half_widths([self.largest_errors[:, column]], MeshPolicy.to_limit())
        if not np.isnan(self.orders[column]) or self.exact[column]:
            steps = np.abs(np.diff(self.errors[:, column]))
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
            orders = used * self.formal_order
            for k, step in enumerate(steps):
                policy = MeshPolicy.of_order(ratios[k], orders[k], factors[k])
                widths[k + 1] = mesh_half_widths([step], policy)
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
        errors = self.errors[np.array(self.counts) >= min(COARSE_COUNT, self.counts[-1]), column]
        errors = errors[np.abs(errors) > _FITTED]
        return len(errors) > 1 and bool(
            len(set(np.sign(errors))) > 1 or np.any(np.diff(np.abs(errors)) >= 0.0)
        )


def relative_errors(values: Array, limits: Array) -> Array:
    """Relative errors (n×q) of `values` (n×q) from their `limits` (q): v/f∞ − 1.

    Zero if value and limit are both zero, as of a direction in which a tool cannot move; infinite
    if only the limit is.
    """
    exact = np.where(values == 0.0, 0.0, np.inf)
    return np.divide(values, limits, out=exact + 1.0, where=limits != 0.0) - 1.0


def fitted_orders(counts: Sequence[int], errors: Array, limit_half_widths: Array) -> Array:
    """Orders in 1/n (q) of the relative `errors` (n×q) from known limits; NaN if there is none.

    An order needs errors above round-off and a hundred times above the half-width of their limit.
    """
    floors = np.maximum(_FITTED, _ABOVE_LIMIT * limit_half_widths)
    return orders_to_limits(counts, errors, floors)
