"""The folder of a run: written into DIR.partial beside DIR, and renamed when all is done.

    run.json        what is being run (robot, preset, versions), and the files that the run wrote
    results.jsonl   a line for every finished case or figure, from which a run can go on
    results.json    the cases and studies so far (interface of the project)
    log.txt         tracebacks and whatever the computations print
    export/         meshes, fields and matrices, if asked for

An earlier run in DIR stays whole until then; it is renamed DIR.partial/.earlier, DIR.partial takes
its name, and its files are removed: a kill between these steps leaves both, and whoever opens the
folder next finishes them. What a run did not write, or somebody changed in a finished run, is
carried over; no link is followed.
"""

import json
import os
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import msgspec

from validation.run.files import (
    digest,
    free,
    halves,
    is_file,
    is_folder,
    lies,
    read_regular,
    refusals,
    write_whole,
)
from validation.run.mark import (
    ALWAYS,
    EARLIER,
    LOG,
    MARK,
    RECORDS,
    Header,
    files_of,
    is_own,
    mark_of,
    sealed,
    unsealed,
)

_EXPORTING = ".export"


@dataclass
class RunFolder:
    """An open, locked run folder; `remarks` say what was found in it that is not as it should be.

    `records` are the finished pieces of work by id. `begun` says when the run was begun and how
    long it has computed (s). `complete` is set by whoever has finished the run.
    """

    path: Path
    header: Header
    begun: dict[str, Any]
    records: dict[str, dict[str, Any]] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
    complete: bool = False
    _files: dict[str, str] = field(default_factory=dict)

    @property
    def log(self) -> Path:
        """File for tracebacks and stray output."""
        return self.path / LOG

    def write(self, contents: Mapping[str, str | bytes]) -> None:
        """Write files by name, noted as the run's before. Raises StoreError if the disk refuses."""
        data = {
            name: text.encode("utf-8") if isinstance(text, str) else text
            for name, text in contents.items()
        }
        with refusals(self.path):
            if not {*data} <= {*self._files, *ALWAYS}:
                self._note(data)
            for name, content in data.items():
                write_whole(self._cleared(name), content)

    def keep(self, record: Mapping[str, Any], seconds: float) -> None:
        """Add a finished piece of work (with its "id"), `seconds` after the run was begun."""
        told = {"started": self.header.get("started", ""), "seconds": seconds, "record": record}
        # Records hold NaN, which JSON proper cannot: only this program reads them.
        line = sealed(mark_of(self.header).run, json.dumps(told).encode())
        with refusals(self.path / RECORDS):
            flags = os.O_WRONLY | os.O_CREAT | os.O_APPEND | os.O_NOFOLLOW | os.O_CLOEXEC
            with os.fdopen(os.open(self.path / RECORDS, flags, 0o666), "wb") as file:
                file.write(line + b"\n")
                file.flush()
                os.fsync(file.fileno())

    @contextmanager
    def exporting(self) -> Iterator[Path]:
        """A new folder to fill with files, which is `export` at a good end.

        Raises StoreError if the disk refuses.
        """
        beside = self.path / _EXPORTING
        with refusals(self.path / "export"):
            beside.mkdir()
            try:
                yield beside
                made = [path for path in beside.rglob("*") if path.is_file()]
                names = [f"export/{path.relative_to(beside)}" for path in made]
                self._note(dict.fromkeys(names, b""))
                for path, name in zip(made, names, strict=True):
                    path.replace(self._cleared(name))
            finally:
                shutil.rmtree(beside, ignore_errors=True)

    def _note(self, data: Mapping[str, bytes]) -> None:
        """Say in run.json what the run writes, before it does."""
        self._files |= {name: digest(content) for name, content in data.items()}
        text = msgspec.json.encode({"flexproof": "run", **self.header, "files": self._files})
        write_whole(self._cleared(MARK), msgspec.json.format(text, indent=2) + b"\n")

    def finish(self) -> None:
        """Say in run.json what the whole run consists of."""
        names = (*ALWAYS, *self._files)
        self._note({name: read_regular(self.path / name) or b"" for name in names})

    def _cleared(self, name: str) -> Path:
        """Where a file belongs, what is no file there, or no folder that holds it, moved aside."""
        place = self.path / name
        for folder in reversed(place.relative_to(self.path).parents[:-1]):
            if lies(self.path / folder) and not is_folder(self.path / folder):
                self._aside(self.path / folder)
        # What is added to must not be another file as well.
        shared = name in {RECORDS, LOG} and is_file(place) and place.stat().st_nlink > 1
        if lies(place) and (shared or not is_file(place)):
            self._aside(place)
        place.parent.mkdir(parents=True, exist_ok=True)
        return place

    def _aside(self, place: Path) -> None:
        kept = place.rename(free(place))
        self.remarks.append(f"{place} was not as this run wrote it: kept as {kept.name}")

    def begin(self, former: Path) -> None:
        """Clear the way, and take up what is finished, copied from a run that is whole."""
        self._files |= files_of(former)
        if lies(self.path / EARLIER):
            self._aside(self.path / EARLIER)
        shutil.rmtree(self.path / _EXPORTING, ignore_errors=True)
        for name in (MARK, *ALWAYS, *self._files):
            place = self._cleared(name)
            for half in halves(place):
                half.unlink()
            if former != self.path and is_own(former, name):
                shutil.copyfile(former / name, place)
        content = read_regular(self.path / RECORDS) or b""
        self._take_up(content)
        self._note({})
        with self.log.open("a"), (self.path / RECORDS).open("ab") as records:
            # A line that a kill or a full disk cut off does not spoil the next one.
            records.write(b"" if content.endswith(b"\n") or not content else b"\n")

    def _take_up(self, content: bytes) -> None:
        run, lines = mark_of(self.header).run, content.split(b"\n")
        for number, line in enumerate(lines, start=1):
            told = unsealed(run, line)
            if told is not None:
                self.begun = {"started": told["started"], "seconds": told["seconds"]}
                self.header = {**self.header, "started": told["started"]}
                self.records[told["record"]["id"]] = told["record"]
            elif line:
                place = self.path / RECORDS
                self.remarks.append(f"{place}, line {number} does not hold: not finished")
