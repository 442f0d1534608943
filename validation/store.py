"""The folder of a run: every finished piece of work is on disk before the next one is reported.

    records/      one file per finished case or figure, the journal from which a run can go on
    run.json      what is being run (robot, preset, versions)
    results.json  the cases and studies so far (interface of the project)
    log.txt       tracebacks and whatever the computations print

Files are replaced atomically: written beside, flushed to the disk, renamed. A lock keeps a second
run out; the operating system lifts it when the process ends, however it ends.
"""

import fcntl
import json
import os
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from hashlib import blake2b
from pathlib import Path
from typing import Any, Literal, TypeAlias

from lumped.errors import InputError

Header: TypeAlias = Mapping[str, Any]
Start: TypeAlias = Literal["afresh", "resumed"]

# What must not have changed when a run goes on: else old and new numbers would be mixed.
SAME_RUN = ("robot", "robot_sha256", "preset", "suite_sha256", "versions", "options")
_OWN = ("run.json", "results.json", "junit.xml", "report.html", "log.txt", "records", "figures")


class StoreError(Exception):
    """Nothing more can be written (disk full, device gone); what was written before is kept."""


@dataclass(frozen=True)
class RunFolder:
    """An open, locked run folder."""

    path: Path

    @property
    def log(self) -> Path:
        """File for tracebacks and stray output."""
        return self.path / "log.txt"

    def write(self, name: str, content: str | bytes) -> None:
        """Replace a file of the folder atomically. Raises StoreError if the disk refuses."""
        write_atomically(self.path / name, content)

    def keep(self, record: Mapping[str, Any]) -> None:
        """Add a finished piece of work (with its "id") to the journal."""
        # The journal keeps NaN, which JSON proper cannot: only this program reads it.
        self.write(f"records/{_file_name(record['id'])}.json", json.dumps(record))

    def records(self) -> dict[str, dict[str, Any]]:
        """The journal by id. A file that cannot be read counts as not finished."""
        found: dict[str, dict[str, Any]] = {}
        for path in sorted((self.path / "records").glob("*.json")):
            with suppress(ValueError, OSError):
                record = json.loads(path.read_text(encoding="utf-8"))
                found[record["id"]] = record
        return found


@contextmanager
def open_folder(path: Path, header: Header, start: Start) -> Iterator[RunFolder]:
    """Lock the folder for this run and prepare it.

    "afresh" clears what an earlier run left, "resumed" keeps its journal. Raises InputError where
    the folder cannot be used: not writable, something else's, in use, or of a different run.
    """
    _prepare(path)
    with _locked(path):
        folder = RunFolder(path)
        if start == "resumed":
            _require_same_run(folder, header)
        else:
            _clear(path)
        (path / "records").mkdir(exist_ok=True)
        folder.write("run.json", json.dumps(header, indent=2, ensure_ascii=False) + "\n")
        yield folder


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write beside, flush to the disk, rename. Raises StoreError; the old file then remains."""
    data = content.encode("utf-8") if isinstance(content, str) else content
    temporary = path.with_name(f".{path.name}.tmp")
    try:
        with temporary.open("wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        temporary.replace(path)
        _flush_directory(path.parent)
    except OSError as error:
        with suppress(OSError):
            temporary.unlink()
        raise StoreError(
            f"cannot write {path}: {error.strerror}; what was finished before is kept"
        ) from error


def _prepare(path: Path) -> None:
    try:
        path.mkdir(parents=True, exist_ok=True)
        names = {entry.name for entry in path.iterdir()}
        if names and not names & {"run.json", ".lock"}:
            raise InputError(
                f"--out {path}: the folder holds other files; name a new folder or one of a run"
            )
        (path / ".lock").touch()
    except OSError as error:
        raise InputError(f"--out {path}: cannot write there: {error.strerror}") from error


@contextmanager
def _locked(path: Path) -> Iterator[None]:
    try:
        lock = (path / ".lock").open("r+")
    except OSError as error:
        raise InputError(f"--out {path}: cannot write there: {error.strerror}") from error
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            holder = lock.read().strip() or "unknown"
            raise InputError(
                f"--out {path}: another run (process {holder}) is writing there"
            ) from error
        lock.truncate(0)
        lock.write(str(os.getpid()))
        lock.flush()
        yield


def _require_same_run(folder: RunFolder, header: Header) -> None:
    try:
        former = json.loads((folder.path / "run.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"--resume: {folder.path} holds no run to go on with") from error
    changed = [name for name in SAME_RUN if former.get(name) != header.get(name)]
    if changed:
        raise InputError(
            f"--resume: {folder.path} belongs to another run ({', '.join(changed)} differ); "
            "start afresh without --resume"
        )


def _clear(path: Path) -> None:
    for name in _OWN:
        entry = path / name
        if entry.is_dir():
            shutil.rmtree(entry)
        else:
            entry.unlink(missing_ok=True)


def _flush_directory(path: Path) -> None:
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def _file_name(identifier: str) -> str:
    """A readable and unique file name for an id."""
    readable = re.sub(r"[^\w.=+-]+", "_", identifier)[:100]
    return f"{readable}-{blake2b(identifier.encode(), digest_size=4).hexdigest()}"
