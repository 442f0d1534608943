"""Orders, extrapolation and uncertainty of sequences whose limit is known."""

from collections.abc import Mapping

import numpy as np

from lumped.arrays import Array
from validation.agreement.convergence import (
    analyse,
    fit_order,
    order_of_errors,
    pairwise_orders,
    richardson,
    safety_factor,
    step_factor,
    three_grid_order,
    uncertainty_of,
)
from validation.cases.program.judgement.claims import claims, same
from validation.context import Context
from validation.parts.refinement import refinement_uncertainty
from validation.solids.legs import Refinement

_SOURCE = "P. J. Roache, J. Fluids Eng. 116 (1994) 405; ASME V&V 20-2009 §2"
_SIZES = np.array([1.0, 0.5, 0.25, 0.125])


@claims("orders", "Orders and uncertainties are those found by hand", _SOURCE)
def _by_hand(_context: Context) -> Mapping[str, bool]:
    # f = 3 + 2 h²: 5, 3.5, 3.125, 3.03125.
    values = 3.0 + 2.0 * _SIZES**2
    study = analyse(_SIZES, values, 2.0)
    fast = analyse(_SIZES, 3.0 + 2.0 * _SIZES**4, 2.0)
    slow = analyse(_SIZES, 3.0 + 2.0 * _SIZES, 2.0)
    restless = analyse(_SIZES, np.array([1.0, 2.0, 1.5, 1.8]), 2.0)
    apart = np.array([1.0, 2.0, 4.0, 8.0])
    two = Refinement((1, 2), np.array([3.5, 3.125]), 2.0)
    fit = fit_order(_SIZES, values)
    return {
        "order of 5, 3.5, 3.125 is 2": same(three_grid_order(5.0, 3.5, 3.125, 2.0, 2.0), 2.0),
        "order on grids of ratio 2 and 4": same(
            three_grid_order(5.0, 3.5, 3.03125, 2.0, 4.0), 2.0, 1e-9
        ),
        "both orders are 2": bool(np.allclose(pairwise_orders(_SIZES, values), 2.0)),
        "the limit of 3.125, 3.03125 is 3": same(richardson(3.125, 3.03125, 2.0, 2.0), 3.0),
        "factor 1.25 at the formal order": same(safety_factor(1.9, 2.0), 1.25),
        "factor 3 off it": same(safety_factor(1.5, 2.0), 3.0) and same(safety_factor(3, 2.0), 3.0),
        "3/(2² − 1) = 1": same(step_factor(2.0, 2.0), 1.0),
        "3/(2⁴ − 1) = 0.2": same(step_factor(2.0, 4.0), 0.2),
        "two meshes: the step of 0.375": same(two.uncertainty(), 0.375),
        "fit: limit 3, order 2, coefficient 2": same(fit.limit, 3.0, 1e-8)
        and same(fit.order, 2.0, 1e-6)
        and same(fit.coefficient, 2.0, 1e-5),
        "uncertainty 1.25 · 0.03125": same(uncertainty_of(study), 1.25 * 0.03125, 1e-6),
        "an order of 4 where 2 is formal: 3 · step/3": same(
            uncertainty_of(fast), 2.0 * (0.25**4 - 0.125**4), 1e-6
        ),
        "an order of 1 where 2 is formal: 3 · step": same(uncertainty_of(slow), 0.75, 1e-6),
        "oscillation: three times the spread, no order": same(uncertainty_of(restless), 1.5)
        and restless.uncertainty is None
        and restless.behaviour == "oscillating",
        "growing steps diverge": analyse(_SIZES, apart, 2.0).behaviour == "diverging",
        "errors h³ fall with order 3": same(order_of_errors(_SIZES, 7.0 * _SIZES**3), 3.0, 1e-9),
    }


@claims(
    "orders-parts",
    "Uncertainties of parts hold the error of sequences whose limit is known",
    _SOURCE,
)
def _of_parts(_context: Context) -> Mapping[str, bool]:
    """Three meshes, each finer by √2 than the one before: f = 5 + 0.1 hᵖ, h = 2, √2, 1."""

    def found(*errors: float | tuple[float, ...]) -> Array:
        return refinement_uncertainty(*(5.0 + np.atleast_1d(e) for e in errors))

    def power(p: float) -> tuple[float, float, float]:
        return 0.1 * 2.0**p, 0.1 * 2.0 ** (p / 2.0), 0.1

    by_order = {p: float(found(*power(p))[0]) for p in (0.5, 1, 2, 6)}
    slow = 0.1 * (2.0**0.25 - 1.0)
    # Both numbers' changes fall by 2√2 − 1 together: (2 + 2 − √2) over (1 + √2 − 1).
    fall = 2.0**1.5 - 1.0
    quick, other = found(*zip(power(2), power(1), strict=True))
    return {
        "orders 1 and 2: 1.5 of the error": same(by_order[1], 0.15, 1e-6)
        and same(by_order[2], 0.15, 1e-6),
        "order 6 is taken as 2, from the larger change": same(by_order[6], 4.2, 1e-6),
        "order 1/2 is taken as 1": same(by_order[0.5], 1.5 * slow / (2.0**0.5 - 1.0), 1e-6),
        "changes that grow are of order 1": same(
            float(found(0.1, 0.15, 0.05)[0]), 0.15 / (2.0**0.5 - 1.0), 1e-6
        ),
        "numbers of one answer have one order": same(
            float(quick), 1.5 * 0.2 / fall / (fall - 1.0), 1e-6
        )
        and same(float(other), 0.075, 1e-6),
        "what stands still is rounded": same(float(found(0.0, 0.0, 0.0)[0]), 5e-9, 1e-6),
    }


@claims(
    "orders-published",
    "Orders and uncertainties are those of published and of other made-up sequences",
    "NASA Glenn, NPARC Alliance, Examining spatial (grid) convergence; Celik et al., J. "
    "Fluids Eng. 130 (2008) 078001",
)
def _published(_context: Context) -> Mapping[str, bool]:
    # Pressure recovery on three grids of ratio 2, printed to five digits.
    coarse, middle, fine = 0.96178, 0.96854, 0.97050
    order = three_grid_order(coarse, middle, fine, 2.0, 2.0)
    sizes = np.array([0.6, 0.3, 0.2, 0.1])
    cubic = 5.0 - 0.4 * sizes**3
    fit = fit_order(sizes, cubic)
    columns = Refinement((1, 2, 4, 8), np.column_stack([_SIZES**2, 3.0 + 0.5 * _SIZES**2]), 2.0)
    swinging = analyse(sizes, np.array([2.0, 1.0, 1.6, 1.3]), 2.0)
    return {
        "order 1.786": same(order, 1.78618, 2e-5),
        "limit 0.97130": same(richardson(middle, fine, 2.0, order), 0.9713, 1e-6),
        "order 3 on grids of ratio 2 and 1.5": same(
            three_grid_order(cubic[0], cubic[1], cubic[2], 2.0, 1.5), 3.0, 1e-9
        ),
        "order 3 on all": bool(np.allclose(pairwise_orders(sizes, cubic), 3.0)),
        "a fit's limit 5, order 3": same(fit.limit, 5.0, 1e-8) and same(fit.order, 3.0, 1e-5),
        "3 · step / (2² − 1) where 2 is formal": same(
            analyse(sizes, cubic, 2.0).uncertainty, 0.4 * (0.2**3 - 0.1**3), 1e-6
        ),
        "1.25 of the rest where 3 is": same(
            analyse(sizes, cubic, 3.0).uncertainty, 1.25 * 0.4 * 0.1**3, 1e-5
        ),
        "swinging values have three times their spread": swinging.behaviour == "oscillating"
        and same(uncertainty_of(swinging), 1.8),
        "each number its own uncertainty": same(columns.uncertainty(0), 1.25 * 0.125**2, 1e-5)
        and same(columns.uncertainty(1), 0.625 * 0.125**2, 1e-5),
    }


@claims(
    "orders-random",
    "Of powers at random the limit is found, and held by the uncertainty",
    _SOURCE,
)
def _at_random(_context: Context) -> Mapping[str, bool]:
    rng = np.random.default_rng(14)
    found = {}
    for number in range(40):
        limit, coefficient = float(rng.uniform(1.0, 3.0)), float(rng.choice([-0.2, 0.2]))
        order = float(rng.uniform(1.0, 4.0))
        ladder = (1, 2, 3, 4) if number % 2 else (2, 4, 8, 16)
        sizes = 1.0 / np.array(ladder, dtype=float)
        values = limit + coefficient * sizes**order
        error = abs(values[-1] - limit)
        series = Refinement(ladder, values[:, None], 4.0)
        pair = Refinement(ladder[-2:], values[-2:, None], 2.0)
        stated, by_two = series.uncertainty(0), pair.uncertainty(0)
        study = series.at(0)
        # Ratio r, order p: two grids state F (rᵖ − 1)/(r² − 1) times the error.
        ratio = ladder[-1] / ladder[-2]
        both = Refinement(ladder, np.column_stack([values, 2.0 * values + sizes]), 4.0)
        found[f"sequence {number} beside another"] = same(
            both.uncertainty(0), stated, 1e-9
        ) and not same(both.uncertainty(1), stated, 1e-3)
        found[f"sequence {number} is held"] = error <= stated <= 4.0 * error
        found[f"sequence {number}: two grids"] = same(
            by_two, 3.0 * (ratio**order - 1.0) / (ratio**2 - 1.0) * error, 1e-9
        )
        found[f"sequence {number}: order and limit"] = same(
            study.observed_order, order, 1e-5
        ) and same(study.extrapolated, limit, 1e-6)
        found[f"sequence {number}: its errors' order"] = same(
            order_of_errors(sizes, values - limit), order, 1e-6
        )
    return found
