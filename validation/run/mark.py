"""What the folder of a run says of itself: which run it is of, and what the run wrote."""

import json
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any, Literal, TypeAlias

import msgspec

from validation.run.files import digest, read_regular

MARK, RECORDS, RESULTS, LOG = "run.json", "results.jsonl", "results.json", "log.txt"
# The earlier run until it is removed, and files that are written before they get their names.
LOCK, EARLIER, UNFINISHED = ".lock", ".earlier", ".unfinished"
# What every run has, whether its mark can be read or not.
ALWAYS = (RECORDS, RESULTS, LOG)
_SEAL = b'{"seal": "'
Header: TypeAlias = Mapping[str, Any]


class Mark(msgspec.Struct, frozen=True):
    """What must not change when a run goes on, else old and new numbers would be mixed.

    `files` are what the run wrote, with their digests once it is whole. run.json holds the whole
    header of the run besides, for people.
    """

    flexproof: Literal["run"]
    robot: str = ""
    robot_sha256: str = ""
    preset: str = ""
    suite_sha256: str = ""
    versions: Mapping[str, str] = {}
    options: Mapping[str, str] = {}
    files: Mapping[str, str] = {}

    @property
    def run(self) -> str:
        """Name of the run: equal for runs whose numbers may be mixed."""
        named = msgspec.structs.replace(self, files={})
        return digest(msgspec.json.encode(named, order="deterministic"))


def mark_of(header: Header) -> Mark:
    """The mark of a run with this header."""
    return msgspec.convert({"flexproof": "run", **header}, Mark)


def mark_in(folder: Path) -> Mark | None:
    """The mark in a folder; None where there is none, or none that can be read."""
    with suppress(msgspec.MsgspecError, RecursionError):
        return msgspec.json.decode(read_regular(folder / MARK) or b"", type=Mark)
    return None


def is_run(folder: Path) -> bool:
    """Whether a folder is a run's: known by what its mark or the first of its records says."""
    records = read_regular(folder / RECORDS) or b""
    return mark_in(folder) is not None or records.lstrip().startswith(_SEAL)


def files_of(folder: Path) -> dict[str, str]:
    """The files in a folder that its run wrote, with their digests as far as it knew them.

    Names that lead elsewhere, by a link say, are none of the run's.
    """
    mark, root = mark_in(folder), folder.resolve()
    named = dict.fromkeys(ALWAYS, "") | dict(mark.files if mark else {})
    places = {name: root / name for name in named}
    return {
        name: named[name]
        for name, place in places.items()
        if place.is_file() and place.resolve() == place and place.is_relative_to(root)
    }


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
