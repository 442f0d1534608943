"""The folder of a run: every finished piece of work is on disk before the next one is reported.

    records/      one file per finished case or figure, the journal from which a run can go on
    run.json      what is being run (robot, preset, versions)
    results.json  the cases and studies so far (interface of the project)
    log.txt       tracebacks and whatever the computations print
    export/       meshes, fields and matrices, if asked for

Files are replaced atomically: written beside, flushed to the disk, renamed. A lock keeps a second
run out; the operating system lifts it when the process ends, however it ends.
"""

import fcntl
import json
import os
import re
import shutil
from collections.abc import Iterator, Mapping, Sequence
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
_OWN = (
    "run.json",
    "results.json",
    "junit.xml",
    "report.html",
    "log.txt",
    "records",
    "figures",
    "export",
    "sweeps",
)


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

    def make(self, name: str) -> None:
        """Make a folder in it, if there is none. Raises StoreError if the disk refuses."""
        with _refusals(self.path / name):
            (self.path / name).mkdir(exist_ok=True)

    @contextmanager
    def replacing(self, name: str) -> Iterator[Path]:
        """A new folder to fill; it takes the place of folder `name` when the context ends well.

        Raises StoreError if the disk refuses.
        """
        new = self.path / f".{name}.tmp"
        with _refusals(self.path / name):
            try:
                _remove(new)
                new.mkdir()
                yield new
                _remove(self.path / name)
                new.replace(self.path / name)
            finally:
                shutil.rmtree(new, ignore_errors=True)

    def begun(self) -> dict[str, Any]:
        """When the run was begun and how long it has computed: empty for a run afresh."""
        try:
            former = json.loads((self.path / "results.json").read_text(encoding="utf-8"))["run"]
            return {name: former[name] for name in ("started", "seconds")}
        except (OSError, ValueError, KeyError):
            return {}

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
    if start == "resumed" and not _is_run_folder(path):
        raise InputError(f"--resume: {path} holds no run to go on with")
    _prepare(path)
    with _locked(path):
        folder = RunFolder(path)
        # A run that was killed before it wrote what it is has nothing to go on from.
        if start == "resumed" and (path / "run.json").exists():
            _require_same_run(folder, header)
        else:
            _clear(path)
        folder.make("records")
        folder.write("run.json", json.dumps(header, indent=2, ensure_ascii=False) + "\n")
        yield folder


def write_atomically(path: Path, content: str | bytes) -> None:
    """Write beside, flush to the disk, rename. Raises StoreError; the old file then remains."""
    data = content.encode("utf-8") if isinstance(content, str) else content
    temporary = path.with_name(f".{path.name}.tmp")
    with _refusals(path):
        try:
            with temporary.open("wb") as file:
                file.write(data)
                file.flush()
                os.fsync(file.fileno())
            temporary.replace(path)
            _flush_directory(path.parent)
        except OSError:
            with suppress(OSError):
                temporary.unlink()
            raise


@contextmanager
def _refusals(path: Path) -> Iterator[None]:
    """What the operating system refuses while `path` is written, as StoreError."""
    try:
        yield
    except OSError as error:
        raise StoreError(
            f"cannot write {path}: {error.strerror or error}; what was finished before is kept"
        ) from error


def _is_run_folder(path: Path) -> bool:
    return any((path / name).exists() for name in ("run.json", ".lock"))


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
        lock = (path / ".lock").open("rb+", buffering=0)
    except OSError as error:
        raise InputError(f"--out {path}: cannot write there: {error.strerror}") from error
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            holder = lock.read().decode().strip() or "unknown"
            raise InputError(
                f"--out {path}: another run (process {holder}) is writing there"
            ) from error
        # The number only serves the message; on a full disk the lock holds all the same.
        with suppress(OSError):
            lock.truncate(0)
            lock.write(str(os.getpid()).encode())
        yield


def _require_same_run(folder: RunFolder, header: Header) -> None:
    try:
        former = json.loads((folder.path / "run.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise InputError(f"--resume: {folder.path / 'run.json'} cannot be read") from error
    changed = [name for name in SAME_RUN if former.get(name) != header.get(name)]
    if changed:
        raise InputError(
            f"--resume: {folder.path} belongs to another run ({_differences(changed)} differ); "
            "start afresh without --resume, or name another folder with --out"
        )


def _differences(names: Sequence[str]) -> str:
    spoken = {"robot_sha256": "robot file", "suite_sha256": "source files of flexproof"}
    return ", ".join(spoken.get(name, name) for name in names)


def _clear(path: Path) -> None:
    # run.json goes first: what is left without it is never taken for a run to go on with.
    with _refusals(path):
        for name in _OWN:
            _remove(path / name)


def _remove(entry: Path) -> None:
    if entry.is_dir() and not entry.is_symlink():
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
