"""Work of a run and its results as plain data: what workers send and results.jsonl keeps."""

from collections.abc import Mapping
from typing import Any, Literal, TypeAlias

import msgspec
import numpy as np

from validation.adequacy.matrix import Assessment, Matrix
from validation.case import Case, Measurement
from validation.exhibits import Figure, PlannedFigure
from validation.results.outcome import Result, Verdict, judge

Task: TypeAlias = Case | PlannedFigure | Assessment
# A result as plain data, with the "id" of its task.
Record: TypeAlias = dict[str, Any]
Made: TypeAlias = Literal["made", "failed", "skipped"]
AnyResult: TypeAlias = Result[Any, Any]


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
