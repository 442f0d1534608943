"""Folder of a run, which is written as DIR.partial next to DIR and renamed when complete.

Input: header and records of a run. Output: the files below. Rule: an earlier run in DIR stays until
the new one is complete; files that a run did not write, or that a user changed, are never removed.

    run.json        header of the run (robot, preset, versions), and the files that it wrote
    results.jsonl   a line for each finished case or figure, from which a run can be resumed
    results.json    the cases and studies so far (interface of the project)
    log.txt         tracebacks and output of the computations
    export/         meshes, fields and matrices, if requested

Each file is written whole under another name and then renamed, so that no link is followed. All
checks are made before any file is changed. When the new run is complete, the earlier one is renamed
DIR.partial/.earlier, DIR.partial is renamed DIR, and the files of the earlier run are removed. A
kill between these steps leaves both runs, and the next run in the folder finishes the steps.
Foreign files are moved to the new folder.
"""

import json
import os
import shutil
from collections.abc import Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory
from types import ModuleType
from typing import Any, Literal, TypeAlias

import msgspec

from lumped.errors import InputError
from lumped.files import NO_FOLLOW, digest, os_errors_as_store_errors, read_regular, write_whole
from lumped.posix import fcntl

MARK, RECORDS, RESULTS, LOG = "run.json", "results.jsonl", "results.json", "log.txt"
# Lock, folder of the earlier run until it is removed, and folder of unfinished files.
LOCK, EARLIER, UNFINISHED = ".lock", ".earlier", ".unfinished"
# Files of every run, even if its mark cannot be read.
ALWAYS = (RECORDS, RESULTS, LOG)
_SEAL = b'{"seal": "'
Header: TypeAlias = Mapping[str, Any]
Start: TypeAlias = Literal["afresh", "resumed"]
_FIELD_NAMES = {"robot_sha256": "robot file", "suite_sha256": "source files of flexproof"}


class Mark(msgspec.Struct, frozen=True):
    """Header fields that must be equal to resume a run, so that all numbers fit together.

    `files`: files of the run, with their digests once it is complete. run.json also contains the
    rest of the header, for readers.
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
        """Identity of the run, equal for runs whose numbers can be combined."""
        without_files = msgspec.structs.replace(self, files={})
        return digest(msgspec.json.encode(without_files, order="deterministic"))


def mark_of(header: Header) -> Mark:
    """Mark of a run with this header."""
    return msgspec.convert({"flexproof": "run", **header}, Mark)


def mark_in(folder: Path) -> Mark | None:
    """Mark in a folder. None if there is none, or if it cannot be read."""
    with suppress(msgspec.MsgspecError, RecursionError):
        return msgspec.json.decode(read_regular(folder / MARK) or b"", type=Mark)
    return None


def is_run(folder: Path) -> bool:
    """True if a folder contains the mark, or a first record, of a run."""
    records = read_regular(folder / RECORDS) or b""
    return mark_in(folder) is not None or records.lstrip().startswith(_SEAL)


def files_of(folder: Path) -> dict[str, str]:
    """Files in a folder that its run wrote, with their digests. "" for an unknown digest.

    Names that lead out of the folder, for example by a link, do not count.
    """
    mark, root = mark_in(folder), folder.resolve()
    digests = dict.fromkeys(ALWAYS, "") | dict(mark.files if mark else {})
    paths = {name: root / name for name in digests}
    return {
        name: digests[name]
        for name, path in paths.items()
        if path.is_file() and path.resolve() == path and path.is_relative_to(root)
    }


def sealed(run: str, content: bytes) -> bytes:
    """Line of JSON with a seal over `run` and `content`, so that changes are detected.

    `run`: identity of the run (`Mark.run`). `content`: JSON object without the seal.
    """
    return _SEAL + digest(run.encode() + content).encode() + b'", ' + content[1:]


def unsealed(run: str, line: bytes) -> dict[str, Any] | None:
    """Data in a line of the records. None if the line is damaged, changed, or of another run.

    `run`: identity of the run (`Mark.run`).
    """
    content = b"{" + line[len(_SEAL) + 35 :]
    if line != sealed(run, content):
        return None
    data: dict[str, Any] = json.loads(content)
    return data


@dataclass
class RunFolder:
    """An open, locked run folder. `remarks` list faults found in it.

    `records`: records of finished tasks by id. `begun`: time at which the run was started
    ("started"), and computing time so far ("seconds"); empty for a new run. `complete`: set to True
    at the end of the run.
    """

    path: Path
    header: Header
    begun: dict[str, Any] = field(default_factory=dict)
    records: dict[str, dict[str, Any]] = field(default_factory=dict)
    remarks: list[str] = field(default_factory=list)
    complete: bool = False
    _files: dict[str, str] = field(default_factory=dict)

    @property
    def log(self) -> Path:
        """File for tracebacks and other output."""
        return self.path / LOG

    def begin(self, former: Path) -> None:
        """Prepare the folder.

        Finished tasks of the run in the folder `former` become finished tasks of this run.
        """
        shutil.rmtree(self.path / UNFINISHED, ignore_errors=True)
        (self.path / UNFINISHED).mkdir(exist_ok=True)
        digests, content = files_of(former), read_regular(former / RECORDS) or b""
        self._files = dict.fromkeys(ALWAYS, "") | digests
        self._load_records(content)
        self._mark()
        # Files that are appended to must not be linked elsewhere, nor end in an incomplete line.
        self._put(RECORDS, content if content.endswith(b"\n") or not content else content + b"\n")
        self._put(LOG, read_regular(former / LOG) or b"")
        for name in digests.keys() - {RECORDS, LOG} if former != self.path else ():
            shutil.copyfile(former / name, self._clear_path(name))

    def write(self, contents: Mapping[str, str | bytes]) -> None:
        """Write files by name, after listing them in run.json. Raises StoreError on disk errors."""
        with os_errors_as_store_errors(self.path):
            self._note(contents)
            for name, content in contents.items():
                self._put(name, content.encode() if isinstance(content, str) else content)

    def keep(self, record: Mapping[str, Any], seconds: float) -> None:
        """Append the record of a finished task.

        `seconds`: computing time of the run so far, without the time between an interruption and
        its resumption.
        """
        data = {"started": self.header.get("started", ""), "seconds": seconds, "record": record}
        # Records can contain NaN, which standard JSON excludes; only this program reads them.
        line = sealed(mark_of(self.header).run, json.dumps(data).encode())
        with (
            os_errors_as_store_errors(self.path / RECORDS),
            (self.path / RECORDS).open("ab") as file,
        ):
            file.write(line + b"\n")
            file.flush()
            os.fsync(file.fileno())

    @contextmanager
    def exporting(self) -> Iterator[Path]:
        """Context with a temporary folder. Its files are moved to `export` if no error is raised.

        Raises StoreError on disk errors.
        """
        with (
            os_errors_as_store_errors(self.path / "export"),
            TemporaryDirectory(dir=self.path / UNFINISHED) as temporary,
        ):
            yield Path(temporary)
            paths = [path for path in Path(temporary).rglob("*") if path.is_file()]
            names = [f"export/{path.relative_to(temporary)}" for path in paths]
            self._note(names)
            for path, name in zip(paths, names, strict=True):
                path.replace(self._clear_path(name))

    def finish(self) -> None:
        """Write the digests of all files of the run to run.json."""
        self._files = {name: digest(read_regular(self.path / name) or b"") for name in self._files}
        self._mark()
        shutil.rmtree(self.path / UNFINISHED)

    def _note(self, names: Collection[str]) -> None:
        """List new files in run.json before they are written."""
        if not set(names) <= self._files.keys():
            self._files |= dict.fromkeys(names, "")
            self._mark()

    def _mark(self) -> None:
        text = msgspec.json.encode({"flexproof": "run", **self.header, "files": self._files})
        self._put(MARK, msgspec.json.format(text, indent=2) + b"\n")

    def _put(self, name: str, content: bytes) -> None:
        write_whole(self._clear_path(name), content, self.path / UNFINISHED)

    def _clear_path(self, name: str) -> Path:
        """Path for the file `name`.

        A folder with this name is renamed, and so is a file in the place of a parent folder.
        """
        path = self.path / name
        for folder in reversed(path.relative_to(self.path).parents[:-1]):
            if os.path.lexists(self.path / folder) and not is_folder(self.path / folder):
                self._move_aside(self.path / folder)
        if is_folder(path):
            self._move_aside(path)
        path.parent.mkdir(parents=True, exist_ok=True)
        return path

    def _move_aside(self, path: Path) -> None:
        renamed = path.rename(unused_name(path))
        self.remarks.append(f"{path} was changed after this run wrote it; kept as {renamed.name}")

    def _load_records(self, content: bytes) -> None:
        run = mark_of(self.header).run
        for line_number, line in enumerate(content.split(b"\n"), start=1):
            data = unsealed(run, line)
            if data is not None:
                self.begun = {"started": data["started"], "seconds": data["seconds"]}
                self.header = {**self.header, "started": data["started"]}
                self.records[data["record"]["id"]] = data["record"]
            elif line:
                path = self.path / RECORDS
                self.remarks.append(
                    f"{path}, line {line_number} is damaged or of another run; "
                    "its result is computed again"
                )


@contextmanager
def open_folder(path: Path, header: Header, start: Start) -> Iterator[RunFolder]:
    """Context with the locked folder DIR.partial, which is renamed to `path` if it is `complete`.

    `start`: "afresh" begins a new run, "resumed" continues the last one. Raises InputError if the
    folder is not writable, contains files of other programs, is in use, or belongs to a different
    run. All checks are made before any file is changed.
    """
    _file_locks()
    has_name = path.name not in {"", ".."} and not path.is_symlink()
    target = path if has_name else Path(os.path.realpath(path))
    current = Path.cwd()
    for reason, is_fixed in {
        "a mount point": target.is_mount(),
        "the folder that you are in": Path(os.path.realpath(target)) in {current, *current.parents},
    }.items():
        if is_fixed:
            raise InputError(
                f"--out {path}: is {reason}, which cannot be renamed; name a folder in it"
            )
    partial = target.with_name(f"{target.name}.partial")
    with _input_errors(path):
        _require_ours(path, target, partial)
        remarks = _finish_interrupted(path, target, partial)
    mark = mark_of(header)
    former = _folder_to_resume(path, target, partial, mark) if start == "resumed" else partial
    if start == "afresh" and target.is_dir():
        _require_space(path, target)
    with _input_errors(path):
        partial.mkdir(parents=True, exist_ok=True)
    with _locked(path, partial):
        folder = RunFolder(partial, header, remarks=remarks)
        with os_errors_as_store_errors(partial):
            if start == "afresh":
                for name in files_of(partial):
                    (partial / name).unlink()
            folder.begin(former)
        yield folder
        if folder.complete:
            with os_errors_as_store_errors(target):
                folder.finish()
                if target.exists():
                    target.rename(partial / EARLIER)
                partial.rename(target)
                folder.remarks += _remove_earlier_run(target)


def _require_ours(path: Path, target: Path, partial: Path) -> None:
    for folder in (target, partial):
        names = {entry.name for entry in folder.iterdir()} if os.path.lexists(folder) else set()
        # A run that was killed before it wrote its mark has left only a lock.
        if partial.is_symlink() or (names - {LOCK, UNFINISHED} and not is_run(folder)):
            text = "the folder" if folder == target else f"{partial.name}, where runs begin,"
            raise InputError(
                f"--out {path}: {text} contains other files; name a new folder or that of a run"
            )


def _folder_to_resume(path: Path, target: Path, partial: Path, mark: Mark) -> Path:
    """Folder of the run to resume: `partial` (DIR.partial) if it has a run, else `target` (DIR).

    `path`: DIR as typed by the user, for messages. `mark`: mark of the requested run. Raises
    InputError if neither folder has a run, or if the run has another input.
    """
    former = next((folder for folder in (partial, target) if is_run(folder)), None)
    if former is None:
        raise InputError(f"--resume: {path} contains no run that can be resumed")
    former_mark = mark_in(former)
    # The mark or one record suffices, since the seal of a record identifies its run.
    lines = (read_regular(former / RECORDS) or b"").split(b"\n")
    if (former_mark is None or former_mark.run != mark.run) and not any(
        unsealed(mark.run, x) for x in lines
    ):
        differing = [
            _FIELD_NAMES.get(name, name)
            for name in Mark.__struct_fields__
            if name != "files" and former_mark and getattr(former_mark, name) != getattr(mark, name)
        ]
        differences = f"{', '.join(differing)} differ"
        raise InputError(
            f"--resume: {path} belongs to another run "
            f"({differences if former_mark else 'its run.json cannot be read'}); "
            "start afresh without --resume, or name another folder with --out"
        )
    return former


def _require_space(path: Path, target: Path) -> None:
    """Raise InputError if there is no disk space for a second run as large as that in `target`.

    `path`: the folder as typed by the user, for the message.
    """
    needed = sum((target / name).stat().st_size for name in files_of(target))
    free_bytes = shutil.disk_usage(target).free
    if free_bytes < needed:
        raise InputError(
            f"--out {path}: {free_bytes / 1e6:.1f} MB are free, and the new run needs about "
            f"{needed / 1e6:.1f} MB in addition to the earlier run; make room or "
            "name another folder"
        )


def _file_locks() -> ModuleType:
    """Module of file locks. Raises InputError on a system without them."""
    if fcntl is None:
        raise InputError(
            "run: needs locks of files as Linux and macOS have them; on Windows run flexproof in "
            "the Windows Subsystem for Linux"
        )
    return fcntl


@contextmanager
def _locked(path: Path, folder: Path) -> Iterator[None]:
    """Context with the lock of a run's folder, which other processes then cannot use.

    The lock file moves with the folder; the folder of a finished run has none. `path`: DIR as typed
    by the user, for messages. Raises InputError if another run has the lock.
    """
    lock_path, locks = folder / LOCK, _file_locks()
    with _input_errors(path), ExitStack() as stack:
        is_own_file = (
            lock_path.is_file() and not lock_path.is_symlink() and lock_path.stat().st_nlink == 1
        )
        if os.path.lexists(lock_path) and not is_own_file:
            lock_path.rename(unused_name(lock_path))
        flags = os.O_RDWR | os.O_CREAT | NO_FOLLOW
        lock = stack.enter_context(os.fdopen(os.open(lock_path, flags, 0o666), "rb+", buffering=0))
        try:
            locks.flock(lock, locks.LOCK_EX | locks.LOCK_NB)
            if not lock_path.exists() or not os.path.samestat(
                lock_path.stat(), os.fstat(lock.fileno())
            ):
                # The process with the lock has ended in the meantime.
                raise BlockingIOError
        except BlockingIOError as error:
            holder = lock.read().decode(errors="replace").strip() or "unknown"
            raise InputError(
                f"--out {path}: another run (process {holder}) is writing to this folder"
            ) from error
        # The process number is for the message only; the lock is valid even on a full disk.
        with suppress(OSError):
            lock.truncate(0)
            lock.write(str(os.getpid()).encode())
        lock_context = stack.pop_all()
    with lock_context:
        yield


def _finish_interrupted(path: Path, target: Path, partial: Path) -> list[str]:
    """Finish the steps of a completed run that a kill interrupted.

    `target` is DIR, `partial` is DIR.partial, and `path` is DIR as typed by the user, for messages.
    Returns remarks on renamed files.
    """
    if is_folder(partial / EARLIER) and not target.exists():
        with _locked(path, partial):
            partial.rename(target)
    earlier = target / EARLIER
    if not is_folder(earlier) or (any(earlier.iterdir()) and not is_run(earlier)):
        return []
    with _locked(path, target):
        return _remove_earlier_run(target)


def _remove_earlier_run(target: Path) -> list[str]:
    """Remove the files of the earlier run in `target`/.earlier. Move other files to `target`.

    Returns remarks on renamed files.
    """
    earlier, remarks = target / EARLIER, list[str]()
    if earlier.exists():
        for name, digest_at_end in files_of(earlier).items():
            if digest(read_regular(earlier / name) or b"") == digest_at_end:
                (earlier / name).unlink()
        if (earlier / LOCK).is_file():
            (earlier / LOCK).unlink()
        _merge(earlier, target, remarks)
        # The mark is removed last, since it identifies the folder as a run.
        (earlier / MARK).unlink(missing_ok=True)
        earlier.rmdir()
    (target / LOCK).unlink(missing_ok=True)
    return remarks


def _merge(source: Path, target: Path, remarks: list[str]) -> None:
    """Move the content of the folder `source`, except a run's mark, to `target`.

    A file whose name is taken there is renamed, with a line in `remarks`.
    """
    for entry in sorted(source.iterdir()):
        destination = target / entry.name
        if entry == target / EARLIER / MARK and mark_in(source):
            continue
        if is_folder(entry) and (is_folder(destination) or not any(entry.iterdir())):
            _merge(entry, destination, remarks)
            entry.rmdir()
            continue
        renamed = entry.rename(
            unused_name(destination) if os.path.lexists(destination) else destination
        )
        if renamed != destination:
            remarks.append(f"{destination} was not written by a run; kept as {renamed.name}")


@contextmanager
def _input_errors(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(f"--out {path}: cannot write there: {error.strerror}") from error


def unused_name(path: Path) -> Path:
    """An unused path next to `path`, with ".kept" and a number."""
    names = (f"{path.name}.kept{'' if number == 1 else number}" for number in count(1))
    return next(
        candidate for name in names if not os.path.lexists(candidate := path.with_name(name))
    )


def is_folder(path: Path) -> bool:
    """True for a folder that is not a link."""
    return path.is_dir() and not path.is_symlink()
