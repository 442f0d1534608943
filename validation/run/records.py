"""Reading and writing of results.json, the interface to later runs and other programs.

Input: outcomes, matrices and figures of a run, or a file. Output: `RunRecord`, or the text of the
file. Raises InputError for an invalid file.
"""

from collections.abc import Mapping, Sequence
from math import nan
from pathlib import Path
from typing import Any, TypeAlias

import msgspec
from msgspec import UNSET, UnsetType
from msgspec.structs import asdict, replace

from lumped.errors import InputError
from lumped.files import read_ordinary
from validation.case import Measurement
from validation.published_statements import Claim, claim_records, merged_claims
from validation.record_fields import json_object
from validation.run.outcome import Outcome
from validation.studies_and_figures import Figure, Study, study_record
from validation.verdicts import CauseShare, EntryRecord, Matrix

_FILE = "results.json"
# Largest size (bytes) of a file. Runs of large mechanisms have a few MB.
_LARGEST = 200_000_000
# Entry of a matrix in results.json.
StoredEntry: TypeAlias = EntryRecord[str, CauseShare]
# Largest allowed number: sums, differences and squares of smaller ones are finite.
_LARGEST_NUMBER = 1e150


class RunRecord(msgspec.Struct, frozen=True, kw_only=True):
    """Content of results.json.

    `run`: header. `cases`: outcomes in catalogue order. `adequacy`: entries of the matrices of
    verdicts. `adequacy_of_parts`: entries of the matrices of single legs and of formulations.
    `statements`: statements of publications. `studies`: convergence studies.
    """

    schema: int = 1
    run: Mapping[str, Any] = {}
    cases: tuple[Outcome, ...]
    adequacy: tuple[StoredEntry, ...] = ()
    adequacy_of_parts: tuple[StoredEntry, ...] = ()
    statements: tuple[Any, ...] = ()
    studies: tuple[Any, ...] = ()

    @property
    def by_id(self) -> dict[str, Outcome]:
        """Outcomes by id."""
        return {case.id: case for case in self.cases}


def run_record(
    header: Mapping[str, Any],
    outcomes: Sequence[Outcome],
    matrices: Sequence[Matrix],
    figures: Sequence[Figure] = (),
) -> RunRecord:
    """Record of a run from its header, outcomes of comparisons, matrices and figures."""
    return RunRecord(
        run=header,
        cases=tuple(outcomes),
        adequacy=tuple(record for matrix in matrices for record in stored_entries(matrix)),
        adequacy_of_parts=tuple(
            record
            for matrix in matrices
            for part in matrix.attached
            for record in stored_entries(part, part.robot)
        ),
        statements=tuple(claim_records(claims_of(outcomes))),
        studies=(
            *(study_record(study) for study in studies_of(outcomes)),
            *(study for figure in figures for study in figure.studies),
        ),
    )


def run_json(run: RunRecord) -> str:
    """Text of results.json."""
    contents = asdict(run) | {"cases": [_case_object(outcome) for outcome in run.cases]}
    # Written after each case, for which Python's own encoder would be too slow.
    return msgspec.json.format(msgspec.json.encode(contents), indent=1).decode() + "\n"


def _case_object(outcome: Outcome) -> dict[str, Any]:
    """Object of "cases": fields of declaration, measurement and outcome next to each other.

    If there is no measurement, the values of the measurement's keys are null or empty.
    """
    measurement = outcome.measurement
    numbers = json_object(measurement or Measurement(nan, nan, exact=True), "results.json")
    if measurement is None:
        numbers = {key: value if value in ((), {}) else None for key, value in numbers.items()}
    return {
        **json_object(outcome.case, "results.json"),
        **numbers,
        **json_object(outcome, "results.json"),
        "error": measurement and measurement.difference,
        "unexplained": measurement and measurement.unexplained,
        "numerical_uncertainty": measurement and measurement.numerical_uncertainty,
        "tolerance": outcome.tolerance,
    }


def _outcome_data(case_object: Mapping[str, Any]) -> dict[str, Any]:
    """Plain data of an `Outcome` from an object of "cases", the inverse of `_case_object`.

    The tolerance is absolute. A null stands for an unknown or infinite number or NaN.
    """
    fields = {key: _nan_for_null(value) for key, value in case_object.items() if value is not None}
    tolerance = fields.get("tolerance")
    rule = {"kind": "absolute", "amount": tolerance} if tolerance is not None else None
    half_width = fields.get("numerical_uncertainty", None if fields.get("exact", True) else nan)
    numbers = {"judged_uncertainty": half_width, "exact": half_width is None}
    is_measured = fields.get("verdict") not in ("failed", "skipped")
    return {
        "seconds": 0.0,
        **fields,
        "case": {"title": "", **fields, "tolerance": rule},
        "found": {"value": nan, "reference": nan, **fields, **numbers} if is_measured else None,
    }


def _nan_for_null(data: Any) -> Any:
    """Plain data with NaN for every null."""
    match data:
        case None:
            return nan
        case dict():
            return {key: _nan_for_null(value) for key, value in data.items()}
        case list():
            return [_nan_for_null(value) for value in data]
    return data


def stored_entries(matrix: Matrix, part: str | UnsetType = UNSET) -> list[StoredEntry]:
    """Entries for results.json from the matrix of the robot.

    `part`: name of the leg or formulation, if the matrix is one of those attached to the robot's.
    """
    entries = (
        replace(entry, quantity=entry.quantity.name, poses=matrix.poses, part=part)
        for entry in matrix.entries
    )
    # Encoding replaces infinite numbers and drops fields that exist only during the run.
    return [msgspec.json.decode(msgspec.json.encode(entry), type=StoredEntry) for entry in entries]


def studies_of(outcomes: Sequence[Outcome]) -> list[Study]:
    """Studies of the outcomes. Of studies with the same id, only one is listed."""
    measured = [outcome.measurement for outcome in outcomes if outcome.measurement]
    return list({study.id: study for m in measured for study in m.studies}.values())


def claims_of(outcomes: Sequence[Outcome]) -> tuple[Claim, ...]:
    """Statements of publications in the outcomes, one claim for each sentence."""
    measured = [outcome.measurement for outcome in outcomes if outcome.measurement]
    return merged_claims(m.claim for m in measured if m.claim)


def load_run(path: Path) -> RunRecord:
    """Record of a run, from its folder or its results.json.

    Raises InputError if there is none or if it is invalid.
    """
    file = path / _FILE if path.is_dir() else path
    try:
        return parse_run(read_ordinary(file, "results of a run", _LARGEST), str(file))
    except FileNotFoundError as error:
        reason = f"contains no {_FILE}" if path.is_dir() else "no such run folder or file"
        raise InputError(f"{path}: {reason}") from error
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from error


def parse_run(content: bytes | str, source: str) -> RunRecord:
    """Record of a run from the text of a results.json. `source` names it in messages."""
    try:
        data = msgspec.json.decode(content, type=dict[str, Any])
        cases = msgspec.convert(data.get("cases"), tuple[dict[str, Any], ...])
        run = msgspec.convert(data | {"cases": tuple(map(_outcome_data, cases))}, RunRecord)
        largest = _largest([cases, data.get("adequacy"), data.get("adequacy_of_parts")])
    except (msgspec.MsgspecError, RecursionError, UnicodeDecodeError) as error:
        raise InputError(f"{source}: not a {_FILE} of flexproof: {error}") from error
    if largest > _LARGEST_NUMBER:
        raise InputError(
            f"{source}: not a {_FILE} of flexproof: a number exceeds {_LARGEST_NUMBER:g}"
        )
    if run.schema != 1:
        raise InputError(f"{source}: schema = {run.schema}: only schema 1 is understood")
    if len(run.by_id) < len(run.cases):
        raise InputError(f"{source}: not a {_FILE} of flexproof: two cases in it have the same id")
    return run


def _largest(data: Any) -> float:
    """Largest magnitude of all numbers in plain data. 0 if there are none."""
    match data:
        case dict():
            return max(map(_largest, data.values()), default=0.0)
        case list() | tuple():
            return max(map(_largest, data), default=0.0)
        case int() | float():
            return abs(data)
    return 0.0
