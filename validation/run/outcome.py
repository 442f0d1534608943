"""Results of tasks, and the verdict on the measurement of a case.

Input: a case and its measurement. Output: an `Outcome`. Rule: the case agrees if its unexplained
difference is within the tolerance in all poses, and disagrees otherwise. The numerical uncertainty
of value and reference never widens the tolerance. If it exceeds the tolerance, the case is
undecided, unless the difference exceeds the tolerance by more than the uncertainty. An undecided
case does not count as agreement.
"""

from collections.abc import Mapping
from math import isfinite, nan
from typing import Annotated, Any, Generic, Literal, TypeAlias, TypeVar

import msgspec

from validation.case import Case, Declaration, Measurement, Relation
from validation.drawing.text import function_name
from validation.record_fields import RESULTS
from validation.studies_and_figures import Figure, PlannedFigure
from validation.verdicts import Assessment, Matrix

Verdict: TypeAlias = Literal["agree", "disagree", "undecided", "failed", "skipped"]
V = TypeVar("V")
F = TypeVar("F")
Task: TypeAlias = Case | PlannedFigure | Assessment
# Result as plain data, with the "id" of its task.
Record: TypeAlias = dict[str, Any]
Completion: TypeAlias = Literal["made", "failed", "skipped"]


class Result(msgspec.Struct, Generic[V, F], frozen=True):
    """Result of a task: returned by a worker, stored in results.jsonl, displayed by the page.

    `verdict`: verdict on a comparison; "made", "failed" or "skipped" for other tasks. `found`: a
    measurement, figure or matrix. None if there is none, with the reason in `message`.
    """

    id: Annotated[str, RESULTS]
    verdict: Annotated[V, RESULTS]
    # Time of the computation (s).
    seconds: Annotated[float, RESULTS]
    message: Annotated[str, RESULTS] = ""
    found: F | None = None


AnyResult: TypeAlias = Result[Any, Any]


class Outcome(Result[Verdict, Measurement], frozen=True, kw_only=True):
    """Result of a comparison: its declaration, measurement and verdict.

    Workers, results.jsonl, results.json, `compare`, the API and the page use this class. Fields are
    listed here, in `Declaration` and in `Measurement` only. In results.json, an object of "cases"
    contains the annotated fields of all three. Numbers are in the unit of the case. Infinite
    numbers and NaN are null in JSON.
    """

    case: Declaration
    # Function that computed the measurement.
    computed_by: str = ""
    # Value of the baseline, value − earlier, and its largest magnitude that is not drift. None
    # without a baseline, or if the baseline has no value in this pose.
    earlier: Annotated[float | None, RESULTS] = None
    drift: Annotated[float | None, RESULTS] = None
    drift_allowed: Annotated[float | None, RESULTS] = None
    drifted: Annotated[bool | None, RESULTS] = None

    @property
    def measurement(self) -> Measurement | None:
        """Measurement of the case. None if it failed or was skipped."""
        return self.found

    @property
    def tolerance(self) -> float:
        """Tolerance in the unit of the case. NaN if there is no measurement."""
        if self.found is None or self.case.tolerance is None:
            return nan
        return self.case.tolerance.at(self.found.reference)

    @property
    def share(self) -> float:
        """Largest violation of the claimed relation, divided by the tolerance, over all poses.

        Above 1, the comparison disagrees, unless it is undecided. NaN if there is no measurement.
        """
        tolerance, relation = self.case.tolerance, self.case.relation
        if self.found is None or tolerance is None:
            return nan
        main_share = relation.excess(self.found.unexplained) / self.tolerance
        further = (
            relation.excess(pose_value.difference) / tolerance.at(pose_value.reference)
            for pose_value in self.found.elsewhere
        )
        return max([main_share, *further])


def verdict(
    unexplained: float, relation: Relation, tolerance: float, uncertainty: float | None = None
) -> Literal["agree", "disagree", "undecided"]:
    """Verdict on a comparison whose unexplained difference is `unexplained`.

    "agree" if it violates the relation by at most `tolerance`, otherwise "disagree". All numbers
    have the same unit. An infinite number or NaN disagrees. If the numerical `uncertainty` exceeds
    the tolerance, the verdict is "undecided", unless the difference exceeds the tolerance by more
    than the uncertainty.
    """
    if not isfinite(unexplained):
        return "disagree"
    beyond = relation.excess(unexplained) - tolerance
    certain = uncertainty is None or uncertainty <= tolerance or beyond > uncertainty
    if not certain:
        return "undecided"
    return "agree" if beyond <= 0.0 else "disagree"


def judge(case: Case, measurement: Measurement, seconds: float) -> Outcome:
    """Outcome of a computed case: the worst verdict over all poses of its measurement.

    Raises ValueError for a relative tolerance if the reference is zero.
    """
    tolerance = case.tolerance.at(measurement.reference)
    uncertainty = measurement.numerical_uncertainty
    worst = verdict(measurement.unexplained, case.relation, tolerance, uncertainty)
    message = ""
    if not (isfinite(measurement.value) and isfinite(measurement.reference)):
        message = "the computation returned a number that is not finite"
    elif worst == "undecided" and uncertainty is not None:
        message = (
            f"numerical uncertainty {uncertainty:.3g} {case.unit} exceeds the tolerance "
            f"{tolerance:.3g} {case.unit}, so the comparison is undecided: {measurement.decides}"
        )
    for pose_value in measurement.elsewhere:
        tolerance_there = case.tolerance.at(pose_value.reference)
        verdict_there = verdict(
            pose_value.difference, case.relation, tolerance_there, pose_value.uncertainty
        )
        if _SEVERITY[verdict_there] > _SEVERITY[worst]:
            worst = verdict_there
            message = (
                f"{verdict_there} at {pose_value.where}: {pose_value.value:.6g} {case.unit} "
                f"against {pose_value.reference:.6g} {case.unit}, "
                f"tolerance {tolerance_there:.3g} {case.unit}"
            )
    return outcome_of(case, worst, seconds, message, measurement)


def outcome_of(
    case: Case,
    case_verdict: Verdict,
    seconds: float,
    message: str,
    measurement: Measurement | None = None,
) -> Outcome:
    """Outcome of a case with the verdict `case_verdict`."""
    return Outcome(
        case.id,
        case_verdict,
        seconds,
        message,
        measurement,
        case=case.declaration,
        computed_by=function_name(case.compute),
    )


_SEVERITY: Mapping[Verdict, int] = {"agree": 0, "undecided": 1, "disagree": 2}


def from_plain(task: Task, record: Mapping[str, Any]) -> AnyResult:
    """Result of `task` from its record. Raises msgspec.ValidationError for an invalid record."""
    match task:
        case Case():
            return msgspec.convert(record, Outcome)
        case PlannedFigure():
            return msgspec.convert(record, Result[Completion, Figure])
        case Assessment():
            return msgspec.convert(record, Result[Completion, Matrix])


def valid_result(task: Task, record: Mapping[str, Any]) -> AnyResult | None:
    """Result of `task` recorded by an earlier process. None if it must be computed again.

    A task is computed again if it failed, if the record is invalid, if the declaration of the case
    has changed, or if the verdict does not follow from the recorded numbers.
    """
    try:
        result = from_plain(task, record)
        if (result.found is None) is not (result.verdict == "skipped"):
            return None
        if isinstance(task, Case) and isinstance(result, Outcome) and result.found is not None:
            outcome = judge(task, result.found, result.seconds)
            if (outcome.verdict, outcome.case) != (result.verdict, result.case):
                return None
    except (msgspec.ValidationError, ValueError):
        return None
    return result
