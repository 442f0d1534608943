"""Mistakes in what judges: verdicts, allowances, uncertainties, orders, ranks."""

from dataclasses import replace
from math import hypot
from typing import Any

import numpy as np

from lumped.arrays import Array
from validation.case import Measurement, Relation
from validation.faults.fault import Fault, Faulty, around, instead, result
from validation.studies.convergence import Convergence, Fit


def _negative(value: Any) -> Any:
    return -value


def _times(factor: float) -> Any:
    return result(lambda value: None if value is None else factor * value)


def _added(measurement: Measurement) -> float:
    return measurement.difference + sum(a.amount for a in measurement.allowances)


def _sizes_taken_off(measurement: Measurement) -> float:
    allowed = sum(abs(a.amount) for a in measurement.allowances)
    return abs(measurement.difference) - allowed


def _absorbed(sound: Faulty, measurement: Measurement) -> Any:
    return 0.0 if measurement.allowances else sound(measurement)


def _first_only(measurement: Measurement) -> float:
    return measurement.difference - sum(a.amount for a in measurement.allowances[:1])


def _reference_less_value(measurement: Measurement) -> float:
    return measurement.reference - measurement.value


def _of_value(measurement: Measurement) -> float | None:
    return measurement.value_uncertainty


def _of_both_sides(measurement: Measurement) -> float | None:
    known = [
        u
        for u in (measurement.value_uncertainty, measurement.reference_uncertainty)
        if u is not None
    ]
    return hypot(*known) if known else None


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


def _unknown(_measurement: Measurement) -> None:
    return None


def _one_sided(relation: Relation, difference: float) -> float:
    return -difference if relation is Relation.AT_LEAST else difference


def _bounds_exchanged(sound: Faulty, relation: Relation, difference: float) -> Any:
    other = {Relation.AT_MOST: Relation.AT_LEAST, Relation.AT_LEAST: Relation.AT_MOST}
    return sound(other.get(relation, relation), difference)


def _bounds_as_equalities(_relation: Relation, difference: float) -> float:
    return abs(difference)


def _widened(
    sound: Faulty, left: float, relation: Any, tolerance: float, uncertainty: Any = None
) -> Any:
    return sound(left, relation, tolerance + (uncertainty or 0.0), None)


def _doubled(
    sound: Faulty, left: float, relation: Any, tolerance: float, uncertainty: Any = None
) -> Any:
    return sound(left, relation, 2.0 * tolerance, uncertainty)


def _never_undecided(
    sound: Faulty, left: float, relation: Any, tolerance: float, _uncertainty: Any = None
) -> Any:
    return sound(left, relation, tolerance, None)


def _nan_agrees(
    sound: Faulty, left: float, relation: Any, tolerance: float, uncertainty: Any = None
) -> Any:
    return "agree" if left != left else sound(left, relation, tolerance, uncertainty)  # noqa: PLR0124


def _always(*_args: Any, **_kwargs: Any) -> str:
    return "agree"


def _without_allowances(sound: Faulty, case: Any, measurement: Measurement, seconds: float) -> Any:
    return sound(case, replace(measurement, allowances=()), seconds)


def _of_one(sound: Faulty, self: Any, _reference: float) -> Any:
    return sound(self, 1.0)


def _scaled(sound: Faulty, self: Any, reference: float) -> Any:
    return sound(self, reference) * abs(reference)


def _the_other_way(middle: float, fine: float, ratio: float, order: float) -> float:
    return fine - (fine - middle) / float(ratio**order - 1.0)


def _from_the_middle(middle: float, fine: float, ratio: float, order: float) -> float:
    return middle + (fine - middle) / float(ratio**order - 1.0)


def _without_safety(sound: Faulty, *args: float) -> Any:
    return sound(*args[:-1], 1.0)


def _ratios_exchanged(sound: Faulty, coarse: float, middle: float, fine: float, *r: float) -> Any:
    return sound(coarse, middle, fine, *r[::-1])


def _one_order_more(order: float) -> float:
    return order + 1.0


def _finest_is_limit(fit: Fit) -> Fit:
    return replace(fit, limit=fit.limit + fit.coefficient * 0.1)


def _optimistic(_observed: float, _formal: float) -> float:
    return 1.25


def _uncapped(sound: Faulty, sizes: Array, values: Array, _formal: float, *rest: Any) -> Any:
    return sound(sizes, values, 12.0, *rest)


def _last_step(convergence: Convergence) -> float:
    return float(abs(convergence.values[-1] - convergence.values[-2]))


def _in_sizes(sound: Faulty, sizes: Array, values: Array) -> Any:
    return sound(sizes[::-1], values)


def _first_number(sound: Faulty, self: Any, *index: int) -> Any:
    return sound(self, *(0 for _ in index)) if index else sound(self)


def _coarser_number(sound: Faulty, self: Any, *index: int) -> Any:
    if len(self.divisions) < 3:
        return 0.5 * sound(self, *index)
    coarser = replace(self, divisions=self.divisions[:-1], values=self.values[:-1])
    return sound(coarser, *index)


def _nothing_oscillates(sound: Faulty, *args: Any) -> Any:
    found = sound(*args)
    return "monotone" if found == "oscillating" else found


def _by_value(one: Any, other: Any) -> float:
    return float(np.corrcoef(np.asarray(one) ** 3, np.asarray(other) ** 3)[0, 1])


def _fault(name: str, title: str, place: str, change: Any, kind: Any = "numerics") -> Fault:
    return Fault(f"judgement.{name}", title, place, kind, change)


_CASE = "validation.case:"
_CONVERGENCE = "validation.studies.convergence:"
_REFINEMENT = "validation.solids.legs:Refinement."

FAULTS = (
    _fault("allowance-sign", "Allowances added instead of taken off",
           f"{_CASE}Measurement.unexplained", instead(_added)),
    _fault("allowance-size", "Sizes of allowances taken off, whatever their sign",
           f"{_CASE}Measurement.unexplained", instead(_sizes_taken_off)),
    _fault("allowance-absorbs", "An allowance absorbs what is left",
           f"{_CASE}Measurement.unexplained", around(_absorbed)),
    _fault("allowance-first", "Only the first allowance counts",
           f"{_CASE}Measurement.unexplained", instead(_first_only)),
    _fault("allowances-dropped", "Allowances forgotten when judging",
           f"{_CASE}judge", around(_without_allowances)),
    _fault("error-sign", "E = reference − value", f"{_CASE}Measurement.difference",
           instead(_reference_less_value)),
    _fault("uncertainty-of-value", "The uncertainty of the value for that of the difference",
           f"{_CASE}Measurement.numerical_uncertainty", instead(_of_value)),
    _fault("uncertainty-of-sides", "The uncertainty of both sides where what is judged has its own",
           f"{_CASE}Measurement.numerical_uncertainty", instead(_of_both_sides)),
    _fault("uncertainty-smallest", "The smallest of the uncertainties",
           f"{_CASE}Measurement.numerical_uncertainty", instead(_smaller)),
    _fault("uncertainty-unknown", "Uncertainties ignored",
           f"{_CASE}Measurement.numerical_uncertainty", instead(_unknown)),
    _fault("uncertainty-half", "Half of the half-width",
           f"{_CASE}Measurement.numerical_uncertainty", _times(0.5)),
    _fault("one-sided", "Equality judged on one side", f"{_CASE}Relation.excess",
           instead(_one_sided)),
    _fault("bounds-exchanged", "At most for at least", f"{_CASE}Relation.excess",
           around(_bounds_exchanged)),
    _fault("bounds-equal", "Bounds judged as equalities", f"{_CASE}Relation.excess",
           instead(_bounds_as_equalities)),
    _fault("adverse", "The reference perturbed to the better side", f"{_CASE}Relation.adverse",
           result(_negative)),
    _fault("tolerance-percent", "A fraction taken for percent", f"{_CASE}Relative.at",
           _times(100.0), "data"),
    _fault("tolerance-of-one", "A relative tolerance of one instead of the reference",
           f"{_CASE}Relative.at", around(_of_one)),
    _fault("tolerance-scaled", "An absolute tolerance scaled with the reference",
           f"{_CASE}Absolute.at", around(_scaled)),
    _fault("uncertainty-widens", "The uncertainty widens the tolerance", f"{_CASE}verdict",
           around(_widened)),
    _fault("full-width", "Twice the tolerance: full width for half", f"{_CASE}verdict",
           around(_doubled)),
    _fault("never-undecided", "An uncertain comparison is decided", f"{_CASE}verdict",
           around(_never_undecided)),
    _fault("nan-agrees", "Not a number agrees", f"{_CASE}verdict", around(_nan_agrees)),
    _fault("always-agrees", "Everything agrees", f"{_CASE}verdict", instead(_always)),
    _fault("richardson-sign", "Extrapolation away from the limit", f"{_CONVERGENCE}richardson",
           instead(_the_other_way)),
    _fault("richardson-middle", "Extrapolation from the second finest grid",
           f"{_CONVERGENCE}richardson", instead(_from_the_middle)),
    _fault("gci-safety", "Uncertainty without its safety factor",
           f"{_CONVERGENCE}safety_factor", instead(_optimistic)),
    _fault("gci-bare", "Grid convergence index without a safety factor",
           f"{_CONVERGENCE}grid_convergence_index", around(_without_safety)),
    _fault("order-ratios", "Order from grids with their ratios exchanged",
           f"{_CONVERGENCE}three_grid_order", around(_ratios_exchanged)),
    _fault("order-more", "Observed order one too high", f"{_CONVERGENCE}three_grid_order",
           result(_one_order_more)),
    _fault("order-uncapped", "Observed orders above the formal one not capped",
           f"{_CONVERGENCE}analyse", around(_uncapped)),
    _fault("order-sizes", "Orders with mesh sizes in the wrong order",
           f"{_CONVERGENCE}pairwise_orders", around(_in_sizes)),
    _fault("fit-limit", "A fit's limit moved by its coefficient", f"{_CONVERGENCE}fit_order",
           result(_finest_is_limit)),
    _fault("errors-sign", "Order of errors with the wrong sign",
           f"{_CONVERGENCE}order_of_errors", result(_negative)),
    _fault("step-factor", "Two grids without a safety factor", f"{_CONVERGENCE}step_factor",
           _times(1.0 / 3.0)),
    _fault("uncertainty-last-step", "The last step for the uncertainty",
           f"{_CONVERGENCE}uncertainty_of", instead(_last_step)),
    _fault("uncertainty-quarter", "A quarter of the uncertainty",
           f"{_CONVERGENCE}uncertainty_of", _times(0.25)),
    _fault("oscillation", "Oscillating values taken for monotone", f"{_CONVERGENCE}classify",
           around(_nothing_oscillates)),
    _fault("uncertainty-first", "The uncertainty of the first number for all",
           f"{_REFINEMENT}uncertainty", around(_first_number)),
    _fault("uncertainty-coarser", "The uncertainty of the second finest mesh",
           f"{_REFINEMENT}uncertainty", around(_coarser_number)),
    _fault("spearman", "Correlation of values for that of ranks",
           "validation.studies.ranks:spearman", instead(_by_value)),
    _fault("kendall", "Kendall's τ with the wrong sign", "validation.studies.ranks:kendall",
           result(_negative)),
)  # fmt: skip
