"""Finished work as plain data: what workers send, the journal keeps, and results.json shows."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import msgspec
import numpy as np

from validation.adequacy.assessment import Assessed, Assessment
from validation.adequacy.matrix import Matrix, entry_record
from validation.case import Case, Measurement, Outcome, finite
from validation.exhibits import Drawing, Figure, Study, study_record
from validation.results.drift import Drift

Task: TypeAlias = Case | Drawing | Assessment
Record: TypeAlias = dict[str, Any]


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


def assessed_from_record(assessment: Assessment, record: Mapping[str, Any]) -> Assessed:
    """The assessment from its record."""
    matrix = record["matrix"]
    return Assessed(
        assessment=assessment,
        seconds=record["seconds"],
        matrix=msgspec.convert(matrix, Matrix) if matrix else None,
        message=record["message"],
        failed=record["failed"],
    )


def outcome_from_record(case: Case, record: Mapping[str, Any]) -> Outcome:
    """The outcome of `case` from its record."""
    measurement = record["measurement"]
    return Outcome(
        case=case,
        verdict=record["verdict"],
        seconds=record["seconds"],
        measurement=msgspec.convert(measurement, Measurement) if measurement else None,
        message=record["message"],
    )


def drawn_from_record(drawing: Drawing, record: Mapping[str, Any]) -> Drawn:
    """The drawn figure from its record."""
    figure = record["figure"]
    return Drawn(
        drawing=drawing,
        seconds=record["seconds"],
        figure=msgspec.convert(figure, Figure) if figure else None,
        message=record["message"],
        failed=record["failed"],
    )


def succeeded(record: Mapping[str, Any]) -> bool:
    """Whether the work need not be done again when a run goes on."""
    return record.get("verdict") != "failed" and not record.get("failed", False)


def results(
    header: Mapping[str, Any],
    outcomes: Sequence[Outcome],
    drifts: Mapping[str, Drift],
    matrix: Matrix | None,
) -> dict[str, Any]:
    """The content of results.json; `drifts` by case id."""
    return {
        "schema": 1,
        "run": dict(header),
        "cases": [
            outcome.entry | _drift_record(drifts.get(outcome.case.id)) for outcome in outcomes
        ],
        "adequacy": [entry_record(entry) for entry in matrix.entries] if matrix else [],
        "studies": [study_record(study) for study in studies_of(outcomes)],
    }


def studies_of(outcomes: Sequence[Outcome]) -> list[Study]:
    """The studies that came with the outcomes, each id once."""
    measured = [outcome.measurement for outcome in outcomes if outcome.measurement]
    return list({study.id: study for m in measured for study in m.studies}.values())


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
