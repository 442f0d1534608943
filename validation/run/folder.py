"""The folder of a run: written into DIR.partial beside DIR, and renamed when all is done.

    run.json        what is being run (robot, preset, versions), and the files that the run wrote
    results.jsonl   a line for every finished case or figure, from which a run can go on
    results.json    the cases and studies so far (interface of the project)
    log.txt         tracebacks and whatever the computations print
    export/         meshes, fields and matrices, if asked for

Every file is written whole under another name and then renamed, so that no link is followed.

What can be refused is refused before anything is touched. An earlier run in DIR stays whole until
the new one in DIR.partial is: then it is renamed DIR.partial/.earlier, DIR.partial takes its name,
and its files are removed. A kill between these steps leaves both, and whoever opens the folder next
finishes them. What a run did not write, or somebody changed in a finished run, is carried over.
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
# The earlier run until it is removed, and files that are written before they get their names.
LOCK, EARLIER, UNFINISHED = ".lock", ".earlier", ".unfinished"
# What every run has, whether its mark can be read or not.
ALWAYS = (RECORDS, RESULTS, LOG)
_SEAL = b'{"seal": "'
Header: TypeAlias = Mapping[str, Any]
Start: TypeAlias = Literal["afresh", "resumed"]
_SPOKEN = {"robot_sha256": "robot file", "suite_sha256": "source files of flexproof"}


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


@dataclass
class RunFolder:
    """An open, locked run folder; `remarks` say what was found in it that is not as it should be.

    `records` are the finished pieces of work by id. `begun` says when the run was begun and how
    long it has computed (s). `complete` is set by whoever has finished the run.
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
        """File for tracebacks and stray output."""
        return self.path / LOG

    def begin(self, former: Path) -> None:
        """Clear the way, and take up what is finished, copied from a run that is whole."""
        shutil.rmtree(self.path / UNFINISHED, ignore_errors=True)
        (self.path / UNFINISHED).mkdir(exist_ok=True)
        own, content = files_of(former), read_regular(former / RECORDS) or b""
        self._files = dict.fromkeys(ALWAYS, "") | own
        self._take_up(content)
        self._mark()
        # What is added to must not be another file as well, nor end in half a line.
        self._put(RECORDS, content if content.endswith(b"\n") or not content else content + b"\n")
        self._put(LOG, read_regular(former / LOG) or b"")
        for name in own.keys() - {RECORDS, LOG} if former != self.path else ():
            shutil.copyfile(former / name, self._cleared(name))

    def write(self, contents: Mapping[str, str | bytes]) -> None:
        """Write files by name, noted as the run's before. Raises StoreError if the disk refuses."""
        with os_errors_as_store_errors(self.path):
            self._note(contents)
            for name, content in contents.items():
                self._put(name, content.encode() if isinstance(content, str) else content)

    def keep(self, record: Mapping[str, Any], seconds: float) -> None:
        """Add a finished piece of work (with its "id"), `seconds` after the run was begun."""
        told = {"started": self.header.get("started", ""), "seconds": seconds, "record": record}
        # Records hold NaN, which JSON proper cannot: only this program reads them.
        line = sealed(mark_of(self.header).run, json.dumps(told).encode())
        with (
            os_errors_as_store_errors(self.path / RECORDS),
            (self.path / RECORDS).open("ab") as file,
        ):
            file.write(line + b"\n")
            file.flush()
            os.fsync(file.fileno())

    @contextmanager
    def exporting(self) -> Iterator[Path]:
        """A new folder to fill with files, which is `export` at a good end.

        Raises StoreError if the disk refuses.
        """
        with (
            os_errors_as_store_errors(self.path / "export"),
            TemporaryDirectory(dir=self.path / UNFINISHED) as beside,
        ):
            yield Path(beside)
            made = [path for path in Path(beside).rglob("*") if path.is_file()]
            names = [f"export/{path.relative_to(beside)}" for path in made]
            self._note(names)
            for path, name in zip(made, names, strict=True):
                path.replace(self._cleared(name))

    def finish(self) -> None:
        """Say in run.json what the whole run consists of."""
        self._files = {name: digest(read_regular(self.path / name) or b"") for name in self._files}
        self._mark()
        shutil.rmtree(self.path / UNFINISHED)

    def _note(self, names: Collection[str]) -> None:
        """Say in run.json what the run writes, before it does."""
        if not set(names) <= self._files.keys():
            self._files |= dict.fromkeys(names, "")
            self._mark()

    def _mark(self) -> None:
        text = msgspec.json.encode({"flexproof": "run", **self.header, "files": self._files})
        self._put(MARK, msgspec.json.format(text, indent=2) + b"\n")

    def _put(self, name: str, content: bytes) -> None:
        write_whole(self._cleared(name), content, self.path / UNFINISHED)

    def _cleared(self, name: str) -> Path:
        """Where a file belongs; a folder there, or what is none above it, is moved aside."""
        place = self.path / name
        for folder in reversed(place.relative_to(self.path).parents[:-1]):
            if os.path.lexists(self.path / folder) and not is_folder(self.path / folder):
                self._aside(self.path / folder)
        if is_folder(place):
            self._aside(place)
        place.parent.mkdir(parents=True, exist_ok=True)
        return place

    def _aside(self, place: Path) -> None:
        kept = place.rename(free(place))
        self.remarks.append(f"{place} was not as this run wrote it: kept as {kept.name}")

    def _take_up(self, content: bytes) -> None:
        run = mark_of(self.header).run
        for number, line in enumerate(content.split(b"\n"), start=1):
            told = unsealed(run, line)
            if told is not None:
                self.begun = {"started": told["started"], "seconds": told["seconds"]}
                self.header = {**self.header, "started": told["started"]}
                self.records[told["record"]["id"]] = told["record"]
            elif line:
                place = self.path / RECORDS
                self.remarks.append(
                    f"{place}, line {number} is damaged or of another run: passed over"
                )


@contextmanager
def open_folder(path: Path, header: Header, start: Start) -> Iterator[RunFolder]:
    """Lock the folder for this run and prepare it beside; it takes its place if it is `complete`.

    "afresh" begins anew, "resumed" goes on with what was begun last. Raises InputError where
    the folder cannot be used: not writable, something else's, in use, or of a different run; what
    can be refused is refused before anything is touched.
    """
    _file_locks()
    named = path.name not in {"", ".."} and not path.is_symlink()
    place = path if named else Path(os.path.realpath(path))
    here = Path.cwd()
    for what, stays in {
        "a mount point": place.is_mount(),
        "the folder that you are in": Path(os.path.realpath(place)) in {here, *here.parents},
    }.items():
        if stays:
            raise InputError(
                f"--out {path}: is {what}, which cannot be renamed; name a folder in it"
            )
    partial = place.with_name(f"{place.name}.partial")
    with _refused(path):
        _require_ours(path, place, partial)
        remarks = _settled(path, place, partial)
    mark = mark_of(header)
    former = _begun_last(path, place, partial, mark) if start == "resumed" else partial
    if start == "afresh" and place.is_dir():
        _require_space(path, place)
    with _refused(path):
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
            with os_errors_as_store_errors(place):
                folder.finish()
                if place.exists():
                    place.rename(partial / EARLIER)
                partial.rename(place)
                folder.remarks += _carried_over(place)


def _require_ours(path: Path, place: Path, partial: Path) -> None:
    for folder in (place, partial):
        names = {entry.name for entry in folder.iterdir()} if os.path.lexists(folder) else set()
        # A run that was killed before it wrote what it is has left a lock, and nothing to lose.
        if partial.is_symlink() or (names - {LOCK, UNFINISHED} and not is_run(folder)):
            named = "the folder" if folder == place else f"{partial.name}, where runs begin,"
            raise InputError(
                f"--out {path}: {named} holds other files; name a new folder or one of a run"
            )


def _begun_last(path: Path, place: Path, partial: Path, mark: Mark) -> Path:
    """The folder to go on from; raises InputError where none is of the same input."""
    begun = next((folder for folder in (partial, place) if is_run(folder)), None)
    if begun is None:
        raise InputError(f"--resume: {path} holds no run to go on with")
    found = mark_in(begun)
    # Either witness will do: records say for themselves which run they belong to.
    lines = (read_regular(begun / RECORDS) or b"").split(b"\n")
    if (found is None or found.run != mark.run) and not any(unsealed(mark.run, x) for x in lines):
        differing = [
            _SPOKEN.get(name, name)
            for name in Mark.__struct_fields__
            if name != "files" and found and getattr(found, name) != getattr(mark, name)
        ]
        spoken = f"{', '.join(differing)} differ"
        raise InputError(
            f"--resume: {path} belongs to another run "
            f"({spoken if found else 'its run.json cannot be read'}); "
            "start afresh without --resume, or name another folder with --out"
        )
    return begun


def _require_space(path: Path, place: Path) -> None:
    """The new run stands beside the earlier one for a while, and may be as large."""
    needed = sum((place / name).stat().st_size for name in files_of(place))
    free = shutil.disk_usage(place).free
    if free < needed:
        raise InputError(
            f"--out {path}: {free / 1e6:.1f} MB are free, and the new run needs about "
            f"{needed / 1e6:.1f} MB beside the earlier one; make room or name another folder"
        )


def _file_locks() -> ModuleType:
    """The module of file locks; raises InputError on a system without them."""
    if fcntl is None:
        raise InputError(
            "run: needs locks of files as Linux and macOS have them; on Windows run flexproof in "
            "the Windows Subsystem for Linux"
        )
    return fcntl


@contextmanager
def _locked(path: Path, folder: Path) -> Iterator[None]:
    """Hold the lock of a folder, which moves with it; it goes when the folder is a finished run."""
    place, locks = folder / LOCK, _file_locks()
    with _refused(path), ExitStack() as stack:
        own = place.is_file() and not place.is_symlink() and place.stat().st_nlink == 1
        if os.path.lexists(place) and not own:
            place.rename(free(place))
        flags = os.O_RDWR | os.O_CREAT | NO_FOLLOW
        lock = stack.enter_context(os.fdopen(os.open(place, flags, 0o666), "rb+", buffering=0))
        try:
            locks.flock(lock, locks.LOCK_EX | locks.LOCK_NB)
            if not place.exists() or not os.path.samestat(place.stat(), os.fstat(lock.fileno())):
                # Whoever held it has finished meanwhile.
                raise BlockingIOError
        except BlockingIOError as error:
            holder = lock.read().decode(errors="replace").strip() or "unknown"
            raise InputError(
                f"--out {path}: another run (process {holder}) is writing there"
            ) from error
        # The number only serves the message; on a full disk the lock holds all the same.
        with suppress(OSError):
            lock.truncate(0)
            lock.write(str(os.getpid()).encode())
        held = stack.pop_all()
    with held:
        yield


def _settled(path: Path, place: Path, partial: Path) -> list[str]:
    """Finish what a kill interrupted; the remarks say what was carried over under another name."""
    if is_folder(partial / EARLIER) and not place.exists():
        with _locked(path, partial):
            partial.rename(place)
    earlier = place / EARLIER
    if not is_folder(earlier) or (any(earlier.iterdir()) and not is_run(earlier)):
        return []
    with _locked(path, place):
        return _carried_over(place)


def _carried_over(place: Path) -> list[str]:
    """Remove the earlier run below the one that took its place, but for what it did not write."""
    earlier, remarks = place / EARLIER, list[str]()
    if earlier.exists():
        for name, written in files_of(earlier).items():
            if digest(read_regular(earlier / name) or b"") == written:
                (earlier / name).unlink()
        if (earlier / LOCK).is_file():
            (earlier / LOCK).unlink()
        _merge(earlier, place, remarks)
        # Last of all what it is known by.
        (earlier / MARK).unlink(missing_ok=True)
        earlier.rmdir()
    (place / LOCK).unlink(missing_ok=True)
    return remarks


def _merge(source: Path, target: Path, remarks: list[str]) -> None:
    """Move what a folder holds, but a run's mark, beside what stands in another under its name."""
    for entry in sorted(source.iterdir()):
        there = target / entry.name
        if entry == target / EARLIER / MARK and mark_in(source):
            continue
        if is_folder(entry) and (is_folder(there) or not any(entry.iterdir())):
            _merge(entry, there, remarks)
            entry.rmdir()
            continue
        moved = entry.rename(free(there) if os.path.lexists(there) else there)
        if moved != there:
            remarks.append(f"{there} was not written by a run: kept as {moved.name}")


@contextmanager
def _refused(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(f"--out {path}: cannot write there: {error.strerror}") from error


def free(place: Path) -> Path:
    """A name beside that nobody has."""
    names = (f"{place.name}.kept{'' if number == 1 else number}" for number in count(1))
    return next(kept for name in names if not os.path.lexists(kept := place.with_name(name)))


def is_folder(place: Path) -> bool:
    """Whether a name is that of a folder, and no link."""
    return place.is_dir() and not place.is_symlink()
