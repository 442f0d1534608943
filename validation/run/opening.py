"""Opening the folder of a run, and putting a finished one in its place.

What can be refused is refused before anything is touched. An earlier run in DIR stays whole until
the new one in DIR.partial is: then it is renamed DIR.partial/.earlier, DIR.partial takes its name,
and its files are removed. A kill between these steps leaves both, and whoever opens the folder next
finishes them. What a run did not write, or somebody changed in a finished run, is carried over.
"""

import fcntl
import os
import shutil
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Literal, TypeAlias

from lumped.errors import InputError
from validation.run.files import digest, free, is_folder, read_regular, refusals
from validation.run.folder import (
    EARLIER,
    LOCK,
    MARK,
    RECORDS,
    UNFINISHED,
    Header,
    Mark,
    RunFolder,
    files_of,
    is_run,
    mark_in,
    mark_of,
    unsealed,
)

Start: TypeAlias = Literal["afresh", "resumed"]
_SPOKEN = {"robot_sha256": "robot file", "suite_sha256": "source files of flexproof"}


@contextmanager
def open_folder(path: Path, header: Header, start: Start) -> Iterator[RunFolder]:
    """Lock the folder for this run and prepare it beside; it takes its place if it is `complete`.

    "afresh" begins anew, "resumed" goes on with what was begun last. Raises InputError where
    the folder cannot be used: not writable, something else's, in use, or of a different run; what
    can be refused is refused before anything is touched.
    """
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
        with refusals(partial):
            if start == "afresh":
                for name in files_of(partial):
                    (partial / name).unlink()
            folder.begin(former)
        yield folder
        if folder.complete:
            with refusals(place):
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


@contextmanager
def _locked(path: Path, folder: Path) -> Iterator[None]:
    """Hold the lock of a folder, which moves with it; it goes when the folder is a finished run."""
    place = folder / LOCK
    with _refused(path), ExitStack() as stack:
        own = place.is_file() and not place.is_symlink() and place.stat().st_nlink == 1
        if os.path.lexists(place) and not own:
            place.rename(free(place))
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
        lock = stack.enter_context(os.fdopen(os.open(place, flags, 0o666), "rb+", buffering=0))
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
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
