"""What became of a piece of work, and the verdict on what a case measured.

The numerical uncertainty of both sides never widens the tolerance: where it exceeds it, the
comparison is undecided and does not count as agreement.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite, nan
from typing import Any, Generic, Literal, TypeAlias, TypeVar

import msgspec
import numpy as np

from validation.case import Case, Measurement, Relation
from validation.studies_and_figures import Figure, PlannedFigure
from validation.verdicts import Assessment, Matrix

Verdict: TypeAlias = Literal["agree", "disagree", "undecided", "failed", "skipped"]
V = TypeVar("V")
F = TypeVar("F")
Task: TypeAlias = Case | PlannedFigure | Assessment
# A result as plain data, with the "id" of its task.
Record: TypeAlias = dict[str, Any]
Made: TypeAlias = Literal["made", "failed", "skipped"]


class Result(msgspec.Struct, Generic[V, F], frozen=True):
    """What became of a task: sent by a worker, kept in results.jsonl, read by the run and its page.

    `verdict` is that on a comparison, of anything else whether it was made; `found` a measurement,
    figure or matrix, None where there is none, and `message` says why.
    """

    id: str
    verdict: V
    seconds: float
    message: str = ""
    found: F | None = None


AnyResult: TypeAlias = Result[Any, Any]


@dataclass(frozen=True)
class Outcome:
    """A case with its result."""

    case: Case
    result: Result[Verdict, Measurement]

    @property
    def verdict(self) -> Verdict:
        """The verdict on what it measured, or that it failed or was skipped."""
        return self.result.verdict

    @property
    def seconds(self) -> float:
        """How long it took."""
        return self.result.seconds

    @property
    def measurement(self) -> Measurement | None:
        """What it measured."""
        return self.result.found

    @property
    def message(self) -> str:
        """Why it failed, was skipped, or cannot be decided."""
        return self.result.message

    @property
    def tolerance(self) -> float:
        """Tolerance in the unit of the case, NaN where nothing was measured."""
        if self.measurement is None:
            return nan
        return self.case.tolerance.at(self.measurement.reference)

    @property
    def share(self) -> float:
        """Unexplained error on the wrong side over tolerance, the largest: above 1 it disagrees."""
        if self.measurement is None:
            return nan
        own = self.case.relation.excess(self.measurement.unexplained) / self.tolerance
        others = (
            self.case.relation.excess(one.difference) / self.case.tolerance.at(one.reference)
            for one in self.measurement.elsewhere
        )
        return max([own, *others])


def verdict(
    unexplained: float, relation: Relation, tolerance: float, uncertainty: float | None = None
) -> Literal["agree", "disagree", "undecided"]:
    """Agree if the unexplained difference keeps the relation within `tolerance` (same unit).

    NaN never agrees. A numerical `uncertainty` above the tolerance leaves it undecided, unless the
    difference is beyond the tolerance by more than that.
    """
    if not isfinite(unexplained):
        return "disagree"
    beyond = relation.excess(unexplained) - tolerance
    certain = uncertainty is None or uncertainty <= tolerance or beyond > uncertainty
    if not certain:
        return "undecided"
    return "agree" if beyond <= 0.0 else "disagree"


def judge(case: Case, measurement: Measurement, seconds: float) -> Outcome:
    """The outcome of a case that was computed: the worst verdict of all places it looked at.

    Raises ValueError for a relative tolerance about a reference of zero.
    """
    tolerance = case.tolerance.at(measurement.reference)
    uncertainty = measurement.numerical_uncertainty
    said = verdict(measurement.unexplained, case.relation, tolerance, uncertainty)
    message = ""
    if not (isfinite(measurement.value) and isfinite(measurement.reference)):
        message = "the computation gave no finite number"
    elif said == "undecided" and uncertainty is not None:
        message = (
            f"numerical uncertainty {uncertainty:.3g} {case.unit} exceeds the tolerance "
            f"{tolerance:.3g} {case.unit}, so nothing is decided: {measurement.decides}"
        )
    for one in measurement.elsewhere:
        allowed = case.tolerance.at(one.reference)
        there = verdict(one.difference, case.relation, allowed, one.uncertainty)
        if _GRAVITY[there] > _GRAVITY[said]:
            said = there
            message = (
                f"{there} at {one.where}: {one.value:.6g} {case.unit} against {one.reference:.6g} "
                f"{case.unit}, tolerance {allowed:.3g} {case.unit}"
            )
    return Outcome(case, Result(case.id, said, seconds, message, measurement))


_GRAVITY: Mapping[Verdict, int] = {"agree": 0, "undecided": 1, "disagree": 2}


def plain(result: Result[Any, Any]) -> Record:
    """A result as plain data; numbers that JSON does not know stay."""
    record: Record = msgspec.to_builtins(result, enc_hook=_numpy_to_builtin)
    return record


def from_plain(task: Task, record: Mapping[str, Any]) -> AnyResult:
    """The result of `task`; raises msgspec.ValidationError where the record is none."""
    match task:
        case Case():
            return msgspec.convert(record, Result[Verdict, Measurement])
        case PlannedFigure():
            return msgspec.convert(record, Result[Made, Figure])
        case Assessment():
            return msgspec.convert(record, Result[Made, Matrix])


def still_holding(task: Task, record: Mapping[str, Any]) -> AnyResult | None:
    """What an earlier process recorded of `task`, judged again; None if it is to be done again.

    That is so for what failed, for what is no such record, and for a verdict that its numbers do
    not bear out.
    """
    try:
        result = from_plain(task, record)
        if (result.found is None) is not (result.verdict == "skipped"):
            return None
        if isinstance(task, Case) and result.found is not None:
            again = judge(task, result.found, result.seconds)
            return result if again.verdict == result.verdict else None
    except (msgspec.ValidationError, ValueError):
        return None
    return result


def _numpy_to_builtin(value: object) -> object:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise NotImplementedError(f"{type(value).__name__} cannot be stored")
