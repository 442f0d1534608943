"""results.json: records that a run writes, and that later runs and other programs read."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import msgspec
from msgspec import UNSET, UnsetType
from msgspec.structs import replace

from lumped.errors import InputError
from lumped.files import read_ordinary
from validation.case import Relation
from validation.published_statements import Claim, claim_records, merged_claims
from validation.run.outcome import Outcome, Verdict
from validation.studies_and_figures import Figure, Study, study_record
from validation.verdicts import CauseShare, EntryRecord, Matrix

_FILE = "results.json"
# Bytes. Runs of large mechanisms have a few MB.
_LARGEST = 200_000_000
# An entry of a matrix in results.json.
StoredEntry: TypeAlias = EntryRecord[str, CauseShare]
# Sums, differences and squares of smaller numbers are finite.
_LARGEST_NUMBER = 1e150


class CaseRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A comparison: an object of "cases" in results.json.

    The only place that lists these fields. Numbers are in `unit`; one that is not finite is null in
    JSON, and null is read as None. The numbers of a comparison that was skipped or failed are None.
    The fields up to `tolerance_reason` are those of `Case`, where they are described, those up to
    `shown` of `Measurement`; then come the outcome and the drift from the baseline.
    """

    id: str
    title: str = ""
    quantity: str = ""
    model: str = ""
    subject: str = "robot"
    kind: str = "comparison"
    figure: str = ""
    unit: str = "1"
    reference_kind: str = ""
    citation: str = ""
    relation: Relation = Relation.EQUAL
    tolerance_reason: str = ""
    value: float | None = None
    reference: float | None = None
    # value − reference, and the part of it that no allowance explains.
    error: float | None = None
    unexplained: float | None = None
    exact: bool | None = None
    numerical_uncertainty: float | None = None
    value_uncertainty: float | None = None
    reference_uncertainty: float | None = None
    # `Allowance` as plain data.
    allowances: tuple[Any, ...] = ()
    notes: tuple[str, ...] = ()
    table: Mapping[str, tuple[float | str | None, ...]] = {}
    pose: tuple[float, ...] = ()
    # `Elsewhere` and `UnjudgedValue` as plain data.
    elsewhere: tuple[Any, ...] = ()
    shown: tuple[Any, ...] = ()
    # Largest accepted size of the unexplained difference.
    tolerance: float | None = None
    verdict: Verdict
    # Time of the computation (s).
    seconds: float = 0.0
    # Reason of a verdict that the numbers do not give.
    message: str = ""
    # Value of the baseline, value − earlier, and the largest size of this that is no drift. None
    # without a baseline, and if the baseline has no value in this pose.
    earlier: float | None = None
    drift: float | None = None
    drift_allowed: float | None = None
    drifted: bool | None = None


class RunRecord(msgspec.Struct, frozen=True, kw_only=True):
    """The whole file: `run` is the header, `cases` the results in the order of the catalogue."""

    schema: int = 1
    run: Mapping[str, Any] = {}
    cases: tuple[CaseRecord, ...]
    adequacy: tuple[StoredEntry, ...] = ()
    adequacy_of_parts: tuple[StoredEntry, ...] = ()
    statements: tuple[Any, ...] = ()
    studies: tuple[Any, ...] = ()

    @property
    def by_id(self) -> dict[str, CaseRecord]:
        """The cases by id."""
        return {case.id: case for case in self.cases}


def run_record(
    header: Mapping[str, Any],
    cases: Sequence[CaseRecord],
    outcomes: Sequence[Outcome],
    matrices: Sequence[Matrix],
    figures: Sequence[Figure] = (),
) -> RunRecord:
    """Record of a run: its cases, matrices, statements and studies."""
    return RunRecord(
        run=header,
        cases=tuple(cases),
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


def case_record(outcome: Outcome) -> CaseRecord:
    """A case with its measurement and outcome: each field from the last of them that has it."""
    fields = {
        name: getattr(source, name)
        for source in (outcome.case, outcome.measurement, outcome)
        for name in CaseRecord.__struct_fields__
        if hasattr(source, name)
    }
    if outcome.measurement is not None:
        fields["error"] = outcome.measurement.difference
    return CaseRecord(**fields)


def stored_entries(matrix: Matrix, part: str | UnsetType = UNSET) -> list[StoredEntry]:
    """Entries of results.json from the matrix of the robot, or of a `part` of it."""
    entries = (
        replace(entry, quantity=entry.quantity.name, poses=matrix.poses, part=part)
        for entry in matrix.entries
    )
    # Encoding replaces infinite numbers and drops fields that exist only during the run.
    return [msgspec.json.decode(msgspec.json.encode(entry), type=StoredEntry) for entry in entries]


def studies_of(outcomes: Sequence[Outcome]) -> list[Study]:
    """Studies of the outcomes, each id once."""
    measured = [outcome.measurement for outcome in outcomes if outcome.measurement]
    return list({study.id: study for m in measured for study in m.studies}.values())


def claims_of(outcomes: Sequence[Outcome]) -> tuple[Claim, ...]:
    """Statements of sources in the outcomes, one claim for each sentence."""
    measured = [outcome.measurement for outcome in outcomes if outcome.measurement]
    return merged_claims(m.claim for m in measured if m.claim)


def load_run(path: Path) -> RunRecord:
    """The run in a run folder or a results.json.

    Raises InputError if there is none or if it is invalid.
    """
    file = path / _FILE if path.is_dir() else path
    try:
        return parse_run(read_ordinary(file, "results of a run", _LARGEST), str(file))
    except FileNotFoundError as error:
        reason = f"holds no {_FILE}" if path.is_dir() else "no such run folder or file"
        raise InputError(f"{path}: {reason}") from error
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from error


def parse_run(content: bytes | str, source: str) -> RunRecord:
    """The run from the text of a results.json; `source` names it in messages."""
    try:
        run = msgspec.json.decode(content, type=RunRecord)
        largest = _largest(msgspec.to_builtins((run.cases, run.adequacy, run.adequacy_of_parts)))
    except (msgspec.MsgspecError, RecursionError, UnicodeDecodeError) as error:
        raise InputError(f"{source}: not a {_FILE} of flexproof: {error}") from error
    if largest > _LARGEST_NUMBER:
        raise InputError(
            f"{source}: not a {_FILE} of flexproof: a number exceeds {_LARGEST_NUMBER:g}"
        )
    if run.schema != 1:
        raise InputError(f"{source}: schema = {run.schema}: only schema 1 is understood")
    if len(run.by_id) < len(run.cases):
        raise InputError(f"{source}: not a {_FILE} of flexproof: two of its cases have the same id")
    return run


def _largest(data: Any) -> float:
    """Largest size of all numbers in plain data; 0 if there are none."""
    match data:
        case dict():
            return max(map(_largest, data.values()), default=0.0)
        case list() | tuple():
            return max(map(_largest, data), default=0.0)
        case int() | float():
            return abs(data)
    return 0.0
