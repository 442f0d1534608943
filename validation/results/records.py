"""Finished work as plain data: what workers send, the journal keeps, and results.json shows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import msgspec
import numpy as np

from validation.adequacy.assessment import Assessed, Assessment
from validation.adequacy.matrix import Matrix, matrix_records, part_records
from validation.case import Case, Measurement, Outcome, Verdict, finite, judge
from validation.claims import Claim, claim_records, gathered
from validation.exhibits import Drawing, Figure, Study, study_record
from validation.results.drift import Drift

Task: TypeAlias = Case | Drawing | Assessment
Record: TypeAlias = dict[str, Any]


def is_check(task: Task) -> bool:
    """Whether a task says something of the program, not of the run's robot."""
    return not isinstance(task, Assessment) and task.subject == "program"


@dataclass(frozen=True)
class Drawn:
    """A figure that was asked for; where there is none, or no picture, `message` says why.

    `failed` tells a computation that failed from a figure that this machine cannot draw.
    """

    drawing: Drawing
    seconds: float
    figure: Figure | None = None
    message: str = ""
    failed: bool = False


Done: TypeAlias = Outcome | Drawn | Assessed


class _OutcomeRecord(msgspec.Struct, frozen=True):
    verdict: Verdict
    seconds: float
    message: str
    measurement: Measurement | None


class _AssessedRecord(msgspec.Struct, frozen=True):
    seconds: float
    message: str
    failed: bool
    matrix: Matrix | None


class _DrawnRecord(msgspec.Struct, frozen=True):
    seconds: float
    message: str
    failed: bool
    figure: Figure | None


def outcome_to_record(outcome: Outcome) -> Record:
    """An outcome as plain data."""
    return {
        "id": outcome.case.id,
        "verdict": outcome.verdict,
        "seconds": outcome.seconds,
        "message": outcome.message,
        "measurement": _plain(outcome.measurement),
    }


def drawn_to_record(drawn: Drawn) -> Record:
    """A drawn figure as plain data."""
    return {
        "id": drawn.drawing.id,
        "seconds": drawn.seconds,
        "message": drawn.message,
        "failed": drawn.failed,
        "figure": _plain(drawn.figure),
    }


def assessed_to_record(assessed: Assessed) -> Record:
    """An assessment that was made as plain data."""
    return {
        "id": assessed.assessment.id,
        "seconds": assessed.seconds,
        "message": assessed.message,
        "failed": assessed.failed,
        "matrix": _plain(assessed.matrix),
    }


def from_record(task: Task, record: Mapping[str, Any]) -> Done:
    """What the record says of `task`; raises msgspec.ValidationError where it is none of it."""
    if isinstance(task, Case):
        outcome = msgspec.convert(record, _OutcomeRecord)
        told = outcome.verdict, outcome.seconds, outcome.measurement, outcome.message
        return Outcome(task, *told)
    if isinstance(task, Assessment):
        assessed = msgspec.convert(record, _AssessedRecord)
        kept = assessed.seconds, assessed.matrix, assessed.message, assessed.failed
        return Assessed(task, *kept)
    drawn = msgspec.convert(record, _DrawnRecord)
    return Drawn(task, drawn.seconds, drawn.figure, drawn.message, drawn.failed)


def still_holding(task: Task, record: Mapping[str, Any]) -> Done | None:
    """What an earlier process recorded of `task`, judged again; None if it is to be done again.

    That is so for what failed, for what is no such record, and for a verdict that its numbers do
    not bear out.
    """
    try:
        done = from_record(task, record)
        if not isinstance(done, Outcome):
            return None if done.failed else done
        if done.measurement is None:
            return done if done.verdict == "skipped" else None
        again = judge(done.case, done.measurement, done.seconds)
    except (msgspec.ValidationError, ValueError):
        return None
    return again if again.verdict == done.verdict else None


def results(
    header: Mapping[str, Any],
    outcomes: Sequence[Outcome],
    drifts: Mapping[str, Drift],
    matrices: Sequence[Matrix],
) -> dict[str, Any]:
    """The content of results.json; `drifts` by case id."""
    return {
        "schema": 1,
        "run": dict(header),
        "cases": [
            outcome.entry | _drift_record(drifts.get(outcome.case.id)) for outcome in outcomes
        ],
        "adequacy": [record for matrix in matrices for record in matrix_records(matrix)],
        "adequacy_of_parts": [record for matrix in matrices for record in part_records(matrix)],
        "statements": claim_records(claims_of(outcomes)),
        "studies": [study_record(study) for study in studies_of(outcomes)],
    }


def studies_of(outcomes: Sequence[Outcome]) -> list[Study]:
    """The studies that came with the outcomes, each id once."""
    measured = [outcome.measurement for outcome in outcomes if outcome.measurement]
    return list({study.id: study for m in measured for study in m.studies}.values())


def claims_of(outcomes: Sequence[Outcome]) -> tuple[Claim, ...]:
    """What sources say of the outcomes, one claim for each sentence."""
    measured = [outcome.measurement for outcome in outcomes if outcome.measurement]
    return gathered(m.claim for m in measured if m.claim)


def _drift_record(drift: Drift | None) -> dict[str, float | bool | None]:
    """Truth and frozen apart: beside the reference stands what this project found earlier."""
    if drift is None:
        return {"frozen": None, "drift": None, "drift_allowed": None, "drifted": None}
    return {
        "frozen": drift.frozen,
        "drift": finite(drift.amount),
        "drift_allowed": finite(drift.allowed),
        "drifted": drift.beyond,
    }


def _plain(value: object) -> Any:
    return msgspec.to_builtins(value, enc_hook=_numpy_to_builtin)


def _numpy_to_builtin(value: object) -> object:
    if isinstance(value, np.generic | np.ndarray):
        return value.tolist()
    raise NotImplementedError(f"{type(value).__name__} cannot be stored")
