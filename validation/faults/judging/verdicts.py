"""Mistakes in what judges: verdicts, allowances, uncertainties, orders, ranks."""

from dataclasses import replace
from math import hypot
from typing import Any

import numpy as np

from lumped.arrays import Array
from validation.agreement.convergence import Convergence, Fit
from validation.case import Measurement, Relation
from validation.faults.fault import Faulty, fault, fault_around, fault_in_value


@fault_in_value(
    "judgement.adverse",
    "The reference perturbed to the better side",
    "validation.case.Relation.adverse",
)
@fault_in_value(
    "judgement.errors-sign",
    "Order of errors with the wrong sign",
    "validation.agreement.convergence.order_of_errors",
)
@fault_in_value(
    "judgement.kendall", "Kendall's τ with the wrong sign", "validation.sweeps.decision.kendall"
)
def _negative(value: Any) -> Any:
    return -value


def _times(factor: float) -> Any:
    return lambda value: None if value is None else factor * value


@fault(
    "judgement.allowance-sign",
    "Allowances added instead of taken off",
    "validation.case.Measurement.unexplained",
)
def _added(measurement: Measurement) -> float:
    return measurement.difference + sum(a.amount for a in measurement.allowances)


@fault(
    "judgement.allowance-size",
    "Sizes of allowances taken off, whatever their sign",
    "validation.case.Measurement.unexplained",
)
def _sizes_taken_off(measurement: Measurement) -> float:
    allowed = sum(abs(a.amount) for a in measurement.allowances)
    return abs(measurement.difference) - allowed


@fault_around(
    "judgement.allowance-absorbs",
    "An allowance absorbs what is left",
    "validation.case.Measurement.unexplained",
)
def _absorbed(sound: Faulty, measurement: Measurement) -> Any:
    return 0.0 if measurement.allowances else sound(measurement)


@fault(
    "judgement.allowance-first",
    "Only the first allowance counts",
    "validation.case.Measurement.unexplained",
)
def _first_only(measurement: Measurement) -> float:
    return measurement.difference - sum(a.amount for a in measurement.allowances[:1])


@fault("judgement.error-sign", "E = reference − value", "validation.case.Measurement.difference")
def _reference_less_value(measurement: Measurement) -> float:
    return measurement.reference - measurement.value


@fault(
    "judgement.uncertainty-of-value",
    "The uncertainty of the value for that of the difference",
    "validation.case.Measurement.numerical_uncertainty",
)
def _of_value(measurement: Measurement) -> float | None:
    return measurement.value_uncertainty


@fault(
    "judgement.uncertainty-of-sides",
    "The uncertainty of both sides where what is judged has its own",
    "validation.case.Measurement.numerical_uncertainty",
)
def _of_both_sides(measurement: Measurement) -> float | None:
    known = [
        u
        for u in (measurement.value_uncertainty, measurement.reference_uncertainty)
        if u is not None
    ]
    return hypot(*known) if known else None


@fault(
    "judgement.uncertainty-smallest",
    "The smallest of the uncertainties",
    "validation.case.Measurement.numerical_uncertainty",
)
def _smaller(measurement: Measurement) -> float | None:
    known = [
        u
        for u in (
            measurement.judged_uncertainty,
            measurement.value_uncertainty,
            measurement.reference_uncertainty,
        )
        if u is not None
    ]
    return min(known, default=None)


@fault(
    "judgement.uncertainty-unknown",
    "Uncertainties ignored",
    "validation.case.Measurement.numerical_uncertainty",
)
def _unknown(_measurement: Measurement) -> None:
    return None


@fault("judgement.one-sided", "Equality judged on one side", "validation.case.Relation.excess")
def _one_sided(relation: Relation, difference: float) -> float:
    return -difference if relation is Relation.AT_LEAST else difference


@fault_around(
    "judgement.bounds-exchanged", "At most for at least", "validation.case.Relation.excess"
)
def _bounds_exchanged(sound: Faulty, relation: Relation, difference: float) -> Any:
    other = {Relation.AT_MOST: Relation.AT_LEAST, Relation.AT_LEAST: Relation.AT_MOST}
    return sound(other.get(relation, relation), difference)


@fault("judgement.bounds-equal", "Bounds judged as equalities", "validation.case.Relation.excess")
def _bounds_as_equalities(_relation: Relation, difference: float) -> float:
    return abs(difference)


@fault_around(
    "judgement.uncertainty-widens",
    "The uncertainty widens the tolerance",
    "validation.results.outcome.verdict",
)
def _widened(
    sound: Faulty, left: float, relation: Any, tolerance: float, uncertainty: Any = None
) -> Any:
    return sound(left, relation, tolerance + (uncertainty or 0.0), None)


@fault_around(
    "judgement.full-width",
    "Twice the tolerance: full width for half",
    "validation.results.outcome.verdict",
)
def _doubled(
    sound: Faulty, left: float, relation: Any, tolerance: float, uncertainty: Any = None
) -> Any:
    return sound(left, relation, 2.0 * tolerance, uncertainty)


@fault_around(
    "judgement.never-undecided",
    "An uncertain comparison is decided",
    "validation.results.outcome.verdict",
)
def _never_undecided(
    sound: Faulty, left: float, relation: Any, tolerance: float, _uncertainty: Any = None
) -> Any:
    return sound(left, relation, tolerance, None)


@fault_around("judgement.nan-agrees", "Not a number agrees", "validation.results.outcome.verdict")
def _nan_agrees(
    sound: Faulty, left: float, relation: Any, tolerance: float, uncertainty: Any = None
) -> Any:
    return "agree" if left != left else sound(left, relation, tolerance, uncertainty)  # noqa: PLR0124


@fault("judgement.always-agrees", "Everything agrees", "validation.results.outcome.verdict")
def _always(*_args: Any, **_kwargs: Any) -> str:
    return "agree"


@fault_around(
    "judgement.allowances-dropped",
    "Allowances forgotten when judging",
    "validation.results.outcome.judge",
)
def _without_allowances(sound: Faulty, case: Any, measurement: Measurement, seconds: float) -> Any:
    return sound(case, replace(measurement, allowances=()), seconds)


@fault_around(
    "judgement.tolerance-of-one",
    "A relative tolerance of one instead of the reference",
    "validation.case.Relative.at",
)
def _of_one(sound: Faulty, self: Any, _reference: float) -> Any:
    return sound(self, 1.0)


@fault_around(
    "judgement.tolerance-scaled",
    "An absolute tolerance scaled with the reference",
    "validation.case.Absolute.at",
)
def _scaled(sound: Faulty, self: Any, reference: float) -> Any:
    return sound(self, reference) * abs(reference)


@fault(
    "judgement.richardson-sign",
    "Extrapolation away from the limit",
    "validation.agreement.convergence.richardson",
)
def _the_other_way(middle: float, fine: float, ratio: float, order: float) -> float:
    return fine - (fine - middle) / float(ratio**order - 1.0)


@fault(
    "judgement.richardson-middle",
    "Extrapolation from the second finest grid",
    "validation.agreement.convergence.richardson",
)
def _from_the_middle(middle: float, fine: float, ratio: float, order: float) -> float:
    return middle + (fine - middle) / float(ratio**order - 1.0)


@fault_around(
    "judgement.order-ratios",
    "Order from grids with their ratios exchanged",
    "validation.agreement.convergence.three_grid_order",
)
def _ratios_exchanged(sound: Faulty, coarse: float, middle: float, fine: float, *r: float) -> Any:
    return sound(coarse, middle, fine, *r[::-1])


@fault_in_value(
    "judgement.order-more",
    "Observed order one too high",
    "validation.agreement.convergence.three_grid_order",
)
def _one_order_more(order: float) -> float:
    return order + 1.0


@fault_in_value(
    "judgement.fit-limit",
    "A fit's limit moved by its coefficient",
    "validation.agreement.convergence.fit_order",
)
def _finest_is_limit(fit: Fit) -> Fit:
    return replace(fit, limit=fit.limit + fit.coefficient * 0.1)


@fault(
    "judgement.gci-safety",
    "Uncertainty without its safety factor",
    "validation.agreement.convergence.safety_factor",
)
def _optimistic(_observed: float, _formal: float) -> float:
    return 1.25


@fault_around(
    "judgement.order-uncapped",
    "Observed orders above the formal one not capped",
    "validation.agreement.convergence.analyse",
)
def _uncapped(sound: Faulty, sizes: Array, values: Array, _formal: float, *rest: Any) -> Any:
    return sound(sizes, values, 12.0, *rest)


@fault(
    "judgement.uncertainty-last-step",
    "The last step for the uncertainty",
    "validation.agreement.convergence.uncertainty_of",
)
def _last_step(convergence: Convergence) -> float:
    return float(abs(convergence.values[-1] - convergence.values[-2]))


@fault_around(
    "judgement.order-sizes",
    "Orders with mesh sizes in the wrong order",
    "validation.agreement.convergence.pairwise_orders",
)
def _in_sizes(sound: Faulty, sizes: Array, values: Array) -> Any:
    return sound(sizes[::-1], values)


@fault_around(
    "judgement.uncertainty-first",
    "The uncertainty of the first number for all",
    "validation.solids.legs.Refinement.uncertainty",
)
def _first_number(sound: Faulty, self: Any, *index: int) -> Any:
    return sound(self, *(0 for _ in index)) if index else sound(self)


@fault_around(
    "judgement.uncertainty-coarser",
    "The uncertainty of the second finest mesh",
    "validation.solids.legs.Refinement.uncertainty",
)
def _coarser_number(sound: Faulty, self: Any, *index: int) -> Any:
    if len(self.divisions) < 3:
        return 0.5 * sound(self, *index)
    coarser = replace(self, divisions=self.divisions[:-1], values=self.values[:-1])
    return sound(coarser, *index)


@fault_around(
    "judgement.oscillation",
    "Oscillating values taken for monotone",
    "validation.agreement.convergence.classify",
)
def _nothing_oscillates(sound: Faulty, *args: Any) -> Any:
    found = sound(*args)
    return "monotone" if found == "oscillating" else found


@fault(
    "judgement.spearman",
    "Correlation of values for that of ranks",
    "validation.sweeps.decision.spearman",
)
def _by_value(one: Any, other: Any) -> float:
    return float(np.corrcoef(np.asarray(one) ** 3, np.asarray(other) ** 3)[0, 1])


fault_in_value(
    "judgement.uncertainty-half",
    "Half of the half-width",
    "validation.case.Measurement.numerical_uncertainty",
)(_times(0.5))
fault_in_value(
    "judgement.tolerance-percent", "A fraction taken for percent", "validation.case.Relative.at"
)(_times(100.0))
fault_in_value(
    "judgement.step-factor",
    "Two grids without a safety factor",
    "validation.agreement.convergence.step_factor",
)(_times(1.0 / 3.0))
fault_in_value(
    "judgement.uncertainty-quarter",
    "A quarter of the uncertainty",
    "validation.agreement.convergence.uncertainty_of",
)(_times(0.25))
