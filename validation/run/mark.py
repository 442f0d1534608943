"""What the folder of a run says of itself: which run it is of, and what the run wrote."""

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, TypeAlias

import msgspec

from validation.run.files import digest, is_file, is_folder, read_regular

MARK, RECORDS, RESULTS, LOG = "run.json", "results.jsonl", "results.json", "log.txt"
LOCK, EARLIER = ".lock", ".earlier"
# What every run has, whether its mark can be read or not.
ALWAYS = (RECORDS, RESULTS, LOG)
_SEAL = b'{"seal": "'
Header: TypeAlias = Mapping[str, Any]


class Mark(msgspec.Struct, frozen=True):
    """What must not change when a run goes on: else old and new numbers would be mixed.

    run.json holds the whole header of the run; the rest of it is for people.
    """

    flexproof: Literal["run"]
    robot: str = ""
    robot_sha256: str = ""
    preset: str = ""
    suite_sha256: str = ""
    versions: Mapping[str, str] = msgspec.field(default_factory=dict)
    options: Mapping[str, str] = msgspec.field(default_factory=dict)

    @property
    def run(self) -> str:
        """Name of the run: equal for runs whose numbers may be mixed."""
        return digest(msgspec.json.encode(self, order="deterministic"))


class _Written(msgspec.Struct, frozen=True):
    """The part of run.json on the files of the run: their digests by name."""

    files: Mapping[str, str]


def mark_of(header: Header) -> Mark:
    """The mark of a run with this header."""
    return msgspec.convert({"flexproof": "run", **header}, Mark)


def is_run(folder: Path) -> bool:
    """Whether a folder is a run's: known by what its mark or the first of its records says."""
    records = read_regular(folder / RECORDS) or b""
    return mark_in(folder) is not None or records.lstrip().startswith(_SEAL)


def mark_in(folder: Path) -> Mark | None:
    """The mark in a folder; None where there is none, or none that can be read."""
    with suppress(msgspec.MsgspecError, RecursionError):
        return msgspec.json.decode(read_regular(folder / MARK) or b"", type=Mark)
    return None


def files_of(folder: Path) -> dict[str, str]:
    """Digests, as the run knew them, of the files that it wrote into a folder."""
    with suppress(msgspec.MsgspecError, RecursionError):
        files = msgspec.json.decode(read_regular(folder / MARK) or b"", type=_Written).files
        return {name: seal for name, seal in files.items() if not {"..", "/"} & {*Path(name).parts}}
    return {}


def is_own(folder: Path, name: str) -> bool:
    """Whether a name of a run's leads to a file, and through no link."""
    within = [folder / inner for inner in Path(name).parents]
    return all(map(is_folder, within)) and is_file(folder / name)


def sealed(run: str, told: bytes) -> bytes:
    """A line of JSON that says what it belongs to, and whether it is as it was written."""
    return _SEAL + digest(run.encode() + told).encode() + b'", ' + told[1:]


def unsealed(run: str, line: bytes) -> dict[str, Any] | None:
    """What a line tells; None where it is damaged, changed, or of another run."""
    told = b"{" + line[len(_SEAL) + 35 :]
    if line != sealed(run, told):
        return None
    found: dict[str, Any] = json.loads(told)
    return found
