"""Observed order, extrapolated limit and numerical uncertainty of a refinement series.

Input: values f on meshes of size h, from coarse to fine. Output: `Convergence`, with order, limit
and uncertainty, or the reason why there are none. Rule: f = f∞ + C hᵖ in the asymptotic range. An
observed order above the formal one is an accident of coarse meshes and is limited to it; an
observed order below it is used. If there are too few meshes to observe an order, the formal one is
used with a safety factor of three.

Sources: Roache, J. Fluids Eng. 116 (1994) 405 (grid convergence index, GCI); Celik et al., J.
Fluids Eng. 130 (2008) 078001 (order on grids of unequal ratio); ASME V&V 20-2009 §2 (safety
factors). Differences are d_k = f_{k+1} − f_k, ratios r_k = h_k / h_{k+1} > 1.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite, log
from typing import Literal, TypeAlias, TypeVar

import numpy as np
import scipy

from lumped.arrays import Array
from validation.uncertainty.half_widths import PROVEN, UNPROVEN, MeshPolicy

F = TypeVar("F", float, Array)
Behaviour: TypeAlias = Literal["monotone", "oscillating", "diverging", "round-off plateau"]

# Upper limit of fitted orders: except for p-elements, no method in use has a higher order.
LARGEST_ORDER = 12.0
# Orders of successive triples that differ by less than this fraction count as settled. GCI is then
# right within its own safety factor (Roache 1994 requires "constant p" without a number).
SETTLED = 0.25
# The smaller safety factor of ASME V&V 20 applies if the observed order is this close to the formal
# one.
CLOSE_TO_FORMAL = 0.10
# Element count from which on a series is expected to be asymptotic.
COARSE_COUNT = 5


@dataclass(frozen=True)
class Convergence:
    """Result of a refinement study of `values`, from coarse to fine.

    `orders`: observed order of every three neighbouring meshes, NaN if the differences do not
    decrease monotonically. `observed_order`: order fitted to the asymptotic tail. `extrapolated`:
    Richardson's limit. `uncertainty`: GCI times |f|, in the unit of f. The last three are None
    outside the asymptotic range, and `refusal` is the reason. On a round-off plateau the
    uncertainty is the round-off level.
    """

    values: Array
    orders: Array
    observed_order: float | None = None
    extrapolated: float | None = None
    uncertainty: float | None = None
    refusal: str = ""


def three_grid_order(
    coarse: float, middle: float, fine: float, ratio_coarse: float, ratio_fine: float
) -> float:
    """Observed order p from three meshes, with `ratio_coarse` = h1/h2 and `ratio_fine` = h2/h3.

    `coarse`, `middle` and `fine` are the values f1, f2 and f3. Solves (f2 − f1)/(f3 − f2) = r2ᵖ
    (r1ᵖ − 1)/(r2ᵖ − 1) (Celik et al. 2008). NaN if the differences change sign, vanish, or no order
    between 0 and 12 fits.
    """
    first, second = middle - coarse, fine - middle
    if first * second <= 0.0 or not isfinite(first * second):
        return float("nan")
    quotient = first / second

    def misfit(p: float) -> float:
        return log(quotient) - log(ratio_fine**p * (ratio_coarse**p - 1.0) / (ratio_fine**p - 1.0))

    if misfit(1e-6) * misfit(LARGEST_ORDER) > 0.0:
        return float("nan")
    return float(scipy.optimize.brentq(misfit, 1e-6, LARGEST_ORDER))


def richardson(middle: F, fine: F, ratio: float, order: float) -> F:
    """Value at h → 0 extrapolated from the two finest meshes, with `ratio` = h_middle/h_fine.

    `middle` and `fine` are the values on the two meshes, `order` is the order of convergence.
    """
    return fine + (fine - middle) / float(ratio**order - 1.0)


def pairwise_orders(sizes: Array, values: Array) -> Array:
    """Observed orders (n − 2), one for every three neighbouring meshes. NaN if there is none.

    `sizes` and `values` (n each) are mesh sizes, from coarse to fine, and values on the meshes.
    """
    ratios = sizes[:-1] / sizes[1:]
    return np.array(
        [
            three_grid_order(values[k], values[k + 1], values[k + 2], ratios[k], ratios[k + 1])
            for k in range(len(values) - 2)
        ]
    )


def fit_order(sizes: Array, values: Array) -> float:
    """Order p in (0, 12] of f = f∞ + C hᵖ, fitted to values on at least three meshes.

    `sizes` and `values` (n each) are mesh sizes and values. The order minimises the residual of the
    least-squares fit with the weights of `_fitted`.
    """

    def residual(order: float) -> float:
        deviations = _fitted(sizes, values, (order,))[1]
        return float(np.linalg.norm(deviations / np.sqrt(sizes / sizes[-1])))

    candidates = np.linspace(0.05, LARGEST_ORDER, 240)
    best = int(np.argmin(_residuals(sizes, values, candidates)))
    bounds = (candidates[max(best - 1, 0)], candidates[min(best + 1, len(candidates) - 1)])
    minimum = scipy.optimize.minimize_scalar(
        residual, bounds=bounds, method="bounded", options={"xatol": 1e-10}
    )
    return float(minimum.x)


def _residuals(sizes: Array, values: Array, orders: Array) -> Array:
    """Norms (m) of the residual that `fit_order` minimises, for each of m `orders`.

    `sizes` and `values` are those of `fit_order`.
    """
    shape, root = sizes / sizes[-1], np.sqrt(sizes[-1] / sizes)
    weighted = root * values
    basis = np.stack(
        [np.broadcast_to(root, (len(orders), len(root))), root * shape ** orders[:, None]], axis=-1
    )
    directions = np.linalg.qr(basis)[0]
    fitted = directions @ (np.swapaxes(directions, 1, 2) @ weighted)[..., None]
    return np.asarray(np.linalg.norm(weighted - fitted[..., 0], axis=1))


def orders_to_limits(counts: Sequence[int], errors: Array, floors: Array) -> Array:
    """Orders in 1/n (q) of the relative errors (n×q) of q quantities against known limits.

    `counts` (n) are ascending element counts. The orders are fitted by least squares to log |e|
    over the three finest counts with errors above the `floors` (q). NaN if errors from five
    elements on change sign or grow, if the two orders of neighbouring counts differ too much, or
    for fewer than three counts.
    """
    return np.array(
        [
            _order_to_limit(counts, series, floor)
            for series, floor in zip(errors.T, floors, strict=True)
        ]
    )


def _order_to_limit(counts: Sequence[int], errors: Array, floor: float) -> float:
    usable = [index for index, error in enumerate(errors) if abs(error) > floor]
    asymptotic = [index for index in usable if counts[index] >= COARSE_COUNT]
    usable = asymptotic if len(asymptotic) >= 3 else usable
    # Errors must decrease over all these counts, not only over the three that are fitted.
    sizes, signs = np.abs(errors[usable]), np.sign(errors[usable])
    if len(usable) < 3 or len(set(signs)) > 1 or np.any(np.diff(sizes) >= 0.0):
        return float("nan")
    logarithms = -np.log(np.array(counts, dtype=float)[usable[-3:]]), np.log(sizes[-3:])
    pairwise = np.diff(logarithms[1]) / np.diff(logarithms[0])
    if abs(pairwise[1] - pairwise[0]) > SETTLED * pairwise[1]:
        return float("nan")
    return float(np.polyfit(*logarithms, 1)[0])


def _fitted(sizes: Array, values: Array, orders: tuple[float, ...]) -> tuple[Array, Array]:
    """f∞ and Cᵢ of f = f∞ + Σ Cᵢ h^pᵢ, and residuals of the fit, for the orders pᵢ.

    `sizes` and `values` (n each) are mesh sizes h and values f; in the fit, h is relative to that
    of the finest mesh. The first result contains f∞ and the k coefficients Cᵢ, the second the n
    residuals. Least squares with weights 1/h (Eça and Hoekstra, J. Comput. Phys. 262 (2014) 104),
    so that fine meshes have more weight.
    """
    shape = sizes / sizes[-1]
    root = 1.0 / np.sqrt(shape)
    basis = np.column_stack([np.ones_like(shape), *(shape**order for order in orders)])
    solution = np.linalg.lstsq(basis * root[:, None], values * root, rcond=None)[0]
    return solution, basis @ solution - values


def classify(sizes: Array, values: Array, round_off: float) -> Behaviour:
    """Behaviour of the four finest values: monotone, oscillating, diverging or on a plateau.

    `round_off` is the relative round-off error of the values. A series is diverging if the last
    difference, over the change of log h, is not smaller than the one before.
    """
    differences = np.diff(values[-4:])
    if abs(differences[-1]) <= round_off * abs(values[-1]):
        return "round-off plateau"
    if np.any(differences[:-1] * differences[1:] < 0.0):
        shrinking = abs(differences[-1]) < abs(differences[0])
        return "oscillating" if shrinking else "diverging"
    per_octave = np.abs(differences) / np.log(sizes[-4:-1] / sizes[-3:])
    # Differences that are equal within round-off show growth with log h, which is order zero.
    return "monotone" if per_octave[-1] < (1.0 - 1e-9) * per_octave[-2] else "diverging"


def analyse(
    sizes: Array, values: Array, formal_order: float, round_off: float = 1e-12
) -> Convergence:
    """Order, limit and uncertainty of a series of at least four values on decreasing mesh sizes.

    Raises ValueError for fewer values, sizes that do not decrease, or values that are not finite.
    """
    sizes, values = np.asarray(sizes, dtype=float), np.asarray(values, dtype=float)
    if len(sizes) != len(values) or len(sizes) < 4:
        raise ValueError(f"a convergence study needs four grids or more, not {len(values)}")
    if not (np.all(np.diff(sizes) < 0.0) and sizes[-1] > 0.0 and np.all(np.isfinite(values))):
        raise ValueError("mesh sizes must decrease and be positive, and all values must be finite")
    behaviour = classify(sizes, values, round_off)
    if behaviour == "round-off plateau":
        return _plateau(sizes, values, round_off)
    orders = pairwise_orders(sizes, values)
    if refusal := _refusal(behaviour, orders):
        return Convergence(values, orders, refusal=refusal)
    tail = _asymptotic_tail(orders)
    order = fit_order(sizes[tail:], values[tail:])
    ratio = float(sizes[-2] / sizes[-1])
    extrapolated = richardson(values[-2], values[-1], ratio, min(order, formal_order))
    # 1.25 if the observed order is within 10 % of the formal one, otherwise 3.
    proven = abs(order - formal_order) <= CLOSE_TO_FORMAL * formal_order
    policy = MeshPolicy.to_limit(PROVEN if proven else UNPROVEN)
    uncertainty = policy.half_width(extrapolated - values[-1])
    return Convergence(values, orders, order, extrapolated, uncertainty)


def richardson_limits(
    sizes: Array, values: Array, formal_order: float, round_off: float = 1e-12
) -> tuple[Array, Array]:
    """Richardson's limits (n) of n quantities, and uncertainties (n) of their finest values.

    `values` is m×n, for m mesh sizes. The uncertainties are half-widths; an interval of this
    half-width about the limit contains the finest value, too. NaN if no order is observed. Other
    arguments and exceptions as for `analyse`.
    """
    studies = [analyse(sizes, column, formal_order, round_off) for column in values.T]
    limits, uncertainties = (
        np.array([getattr(study, name) for study in studies], dtype=float)
        for name in ("extrapolated", "uncertainty")
    )
    return limits, uncertainties


def uncertainty_of(convergence: Convergence) -> float:
    """Numerical uncertainty of the finest value, in its unit.

    GCI if the series is asymptotic. Otherwise the range of the last three values times three, the
    safety factor for unproven convergence.
    """
    if convergence.uncertainty is not None:
        return convergence.uncertainty
    return MeshPolicy.to_limit().half_width(float(np.ptp(convergence.values[-3:])))


def uncertainty_of_known_orders(sizes: Array, values: Array, orders: tuple[float, ...]) -> float:
    """Numerical uncertainty of the finest value from known orders of convergence, in its unit.

    `sizes` and `values` (n each) are mesh sizes h, from coarse to fine, and values f. f = f∞ + Σ Cᵢ
    h^pᵢ is fitted by least squares with weights 1/h, on at least one mesh more than the fit has
    coefficients. The result is 1.25 (ASME's factor for proven convergence) times the error of the
    finest value, plus the largest deviation from the fit. Raises ValueError for fewer meshes.
    """
    if len(values) < len(orders) + 2:
        raise ValueError(f"{len(orders)} orders need {len(orders) + 2} grids, not {len(values)}")
    fitted, deviations = _fitted(sizes, values, orders)
    proven = MeshPolicy.to_limit(PROVEN).half_width(float(fitted[0] - values[-1]))
    return proven + float(np.max(np.abs(deviations)))


def _plateau(sizes: Array, values: Array, round_off: float) -> Convergence:
    level = round_off * abs(values[-1])
    scatter = float(np.ptp(values[-2:]))
    above = int(np.sum(np.abs(np.diff(values)) > level)) + 1
    orders = pairwise_orders(sizes[:above], values[:above])
    order = None
    if above >= 4 and not _refusal("monotone", orders):
        tail = _asymptotic_tail(orders)
        order = fit_order(sizes[tail:above], values[tail:above])
    return Convergence(values, orders, order, float(values[-1]), max(level, scatter))


def _refusal(behaviour: Behaviour, orders: Array) -> str:
    if behaviour != "monotone":
        return f"no uncertainty can be stated: the values are {behaviour}"
    last, before = orders[-1], orders[-2]
    if not (isfinite(last) and isfinite(before)):
        return "no uncertainty can be stated: no order fits the finest four grids"
    if abs(last - before) > SETTLED * last:
        return (
            "no uncertainty can be stated: outside the asymptotic range, the observed order "
            f"still changes from {before:.2f} to {last:.2f}"
        )
    return ""


def _asymptotic_tail(orders: Array) -> int:
    """Index of the coarsest mesh from which on orders of neighbouring meshes are nearly equal."""
    tail = len(orders) - 2
    while tail > 0 and abs(orders[tail - 1] - orders[-1]) <= SETTLED * orders[-1]:
        tail -= 1
    return tail
