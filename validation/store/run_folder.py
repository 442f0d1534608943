"""The folder of a run: every finished piece of work is on disk before the next one is reported.

    records/      one file per finished case or figure, the journal from which a run can go on
    run.json      what is being run (robot, preset, versions)
    results.json  the cases and studies so far (interface of the project)
    log.txt       tracebacks and whatever the computations print
    export/       meshes, fields and matrices, if asked for
    sweeps/       finished units of the sweeps
    .manifest     what of all this the run itself wrote

What stands in the way and is not ours, a link say, is kept beside under another name.
"""

import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from hashlib import blake2b
from math import isfinite
from pathlib import Path
from typing import Any

import msgspec

from validation.store.manifest import Manifest
from validation.store.sealed_record import sealed_record, unsealed_record
from validation.store.tree import Tree, refusals, temporary_name

LOG = "log.txt"
RECORDS = "records"


class _Begun(msgspec.Struct, frozen=True):
    started: str
    seconds: float


class _Results(msgspec.Struct, frozen=True):
    """What of results.json is needed to go on."""

    run: _Begun


@dataclass
class RunFolder:
    """An open, locked run folder; `remarks` say what was found in it that is not as it should be.

    `complete` is set by whoever has finished the run: an earlier one then makes way.
    """

    tree: Tree
    manifest: Manifest
    run: str
    remarks: list[str] = field(default_factory=list)
    complete: bool = False
    _cleared: set[str] = field(default_factory=set)

    @property
    def path(self) -> Path:
        """Where the files are."""
        return self.tree.path

    @property
    def log(self) -> Path:
        """File for tracebacks and stray output."""
        return self.path / LOG

    def write(self, name: str, content: str | bytes) -> None:
        """Replace a file of the folder atomically. Raises StoreError if the disk refuses."""
        data = content.encode("utf-8") if isinstance(content, str) else content
        with refusals(self.path / name):
            self.clear_way(name)
            temporary = temporary_name(name)
            self.manifest.expect(name, data, temporary)
            self.tree.write(name, data, temporary)

    def keep(self, record: Mapping[str, Any]) -> None:
        """Add a finished piece of work (with its "id") to the journal."""
        self.write(_file_of(record["id"]), f"{sealed_record(self.run, record)}\n")

    def record(self, identifier: str) -> dict[str, Any] | None:
        """What the journal holds under an id; None, and a remark, for what does not hold."""
        name = _file_of(identifier)
        if self.tree.lacks(name):
            return None
        found = unsealed_record(self.run, self.tree.read(name) or b"")
        if found is None or found.get("id") != identifier:
            self.remarks.append(f"{self.path / name} does not hold: {identifier} is not finished")
            return None
        return found

    def begun(self) -> dict[str, Any]:
        """When the run was begun and how long it has computed: empty for a run afresh."""
        try:
            former = msgspec.json.decode(self.tree.read("results.json") or b"", type=_Results).run
        except (msgspec.MsgspecError, RecursionError):
            return {}
        sound = isfinite(former.seconds) and former.seconds >= 0.0
        return {"started": former.started, "seconds": former.seconds} if sound else {}

    @contextmanager
    def replacing(self, name: str) -> Iterator[Path]:
        """A new folder to fill with files; they take their places in folder `name` at a good end.

        Raises StoreError if the disk refuses.
        """
        beside = temporary_name(name)
        with refusals(self.path / name):
            self.tree.make(beside)
            try:
                yield self.path / beside
                for file in self.tree.files(beside):
                    to = name + file.removeprefix(beside)
                    self.clear_way(to)
                    self.manifest.expect(to, self.tree.read(file) or b"", file)
                    self.tree.move(file, to)
            finally:
                shutil.rmtree(self.path / beside, ignore_errors=True)

    def open_log(self) -> None:
        """Make the log, or go on with the one of this run."""
        with refusals(self.log):
            shared = self.tree.kind(LOG) == "file" and self.log.stat().st_nlink > 1
            if not self.tree.lacks(LOG) and (shared or not self.manifest.owns(LOG)):
                self.set_aside(LOG)
            if self.tree.lacks(LOG):
                first = f"log of run {self.run}".encode()
                self.manifest.expect(LOG, first, kind="growing")
                self.tree.write(LOG, first + b"\n")

    def clear_way(self, name: str) -> None:
        """Move aside what stands in the place of a file or of the folders that hold it."""
        if name in self._cleared:
            return
        folder = name.rpartition("/")[0]
        if folder and not self.tree.lacks(folder) and self.tree.kind(folder) != "folder":
            self.set_aside(folder)
        if not self.tree.lacks(name) and not self.manifest.owns(name):
            self.set_aside(name)
        self._cleared.add(name)

    def set_aside(self, name: str) -> None:
        """Keep under another name what is not ours, and say so."""
        kept = self.tree.aside(name)
        self.remarks.append(f"{self.path / name} was not as this run wrote it: kept as {kept}")


def _file_of(identifier: str) -> str:
    """A readable and unique name for an id's record."""
    readable = re.sub(r"[^\w.=+-]+", "_", identifier)[:100]
    return f"{RECORDS}/{readable}-{blake2b(identifier.encode(), digest_size=4).hexdigest()}.json"
