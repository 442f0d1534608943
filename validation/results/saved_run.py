"""A run as it was saved: what later runs are compared with."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from lumped.errors import InputError
from lumped.files import read_ordinary
from validation.adequacy.matrix import Adequacy
from validation.case import Verdict

_FILE = "results.json"
# Runs of large mechanisms with faults come to a few MB.
_LARGEST = 200_000_000


@dataclass(frozen=True)
class SavedCase:
    """A case's entry in results.json, as far as runs are compared (numbers in `unit`)."""

    id: str
    verdict: Verdict
    title: str = ""
    unit: str = "1"
    value: float | None = None
    reference: float | None = None
    numerical_uncertainty: float | None = None
    tolerance: float | None = None
    seconds: float = 0.0
    pose: tuple[float, ...] = ()


@dataclass(frozen=True)
class SavedEntry:
    """An entry of the `adequacy` array, as far as runs are compared; `values` in SI at `poses`."""

    model: str
    quantity: str
    verdict: Adequacy
    error: float | None = None
    uncertainty: float | None = None
    reference: str = ""
    measured: bool = False
    poses: tuple[tuple[float, ...], ...] = ()
    values: tuple[float | None, ...] = ()


@dataclass(frozen=True)
class SavedRun:
    """results.json: `run` says what was run, `cases` what came out, in the order of the file."""

    cases: tuple[SavedCase, ...]
    run: Mapping[str, Any] = field(default_factory=dict)
    schema: int = 1
    adequacy: tuple[SavedEntry, ...] = ()

    @property
    def by_id(self) -> dict[str, SavedCase]:
        """The cases by id."""
        return {case.id: case for case in self.cases}


def load_run(path: Path) -> SavedRun:
    """The run in a run folder or a results.json.

    Raises InputError where there is none or it is not understood.
    """
    file = path / _FILE if path.is_dir() else path
    try:
        return parse_run(read_ordinary(file, "results of a run", _LARGEST), str(file))
    except FileNotFoundError as error:
        place = f"holds no {_FILE}" if path.is_dir() else "no such run folder or file"
        raise InputError(f"{path}: {place}") from error
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}") from error


def parse_run(content: bytes | str, source: str) -> SavedRun:
    """The run from the text of a results.json; `source` names it in messages."""
    try:
        run = msgspec.json.decode(content, type=SavedRun)
    except (msgspec.MsgspecError, RecursionError) as error:
        raise InputError(f"{source}: not a {_FILE} of flexproof: {error}") from error
    if run.schema != 1:
        raise InputError(f"{source}: schema = {run.schema}: only schema 1 is understood")
    return run
