"""Opening the folder of a run: what can be refused is refused before anything is touched.

A folder is a run's by what its files say, not by their names. One that holds an earlier run is
left as it is until the new run is whole (see `validation.store.replacement`).
"""

import fcntl
import os
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any, Literal, TypeAlias

from lumped.errors import InputError
from validation.store import manifest as manifests
from validation.store.manifest import manifest_of
from validation.store.mark import FILE, Mark, another_run, mark_in, mark_of, mark_text
from validation.store.replacement import (
    ARRIVING,
    FOLDERS,
    UNFINISHED,
    discard,
    has_results,
    is_run,
    replace,
    settle,
)
from validation.store.run_folder import RECORDS, RunFolder
from validation.store.tree import Tree, refusals

Header: TypeAlias = Mapping[str, Any]
Start: TypeAlias = Literal["afresh", "resumed"]
_LOCK = ".lock"
_DIGITS = 20


@contextmanager
def open_folder(path: Path, header: Header, start: Start) -> Iterator[RunFolder]:
    """Lock the folder for this run and prepare it.

    "afresh" begins anew: beside an earlier run, if there is one, which makes way at the end if
    the new run is `complete`. "resumed" goes on with what was begun last. Raises InputError where
    the folder cannot be used: not writable, something else's, in use, or of a different run.
    """
    mark = mark_of(header)
    if start == "resumed" and not path.is_dir():
        raise InputError(f"--resume: {path} holds no run to go on with")
    with _refused(path):
        path.mkdir(parents=True, exist_ok=True)
    with _opened(path, start) as root, _locked(root):
        remarks = settle(root)
        area = _begun_last(root, mark) if start == "resumed" else _cleared(root)
        with root.below(area) as tree:
            folder = _prepared(tree, mark, header)
            folder.remarks[:0] = remarks
            yield folder
        if area and folder.complete:
            with refusals(path):
                folder.remarks += replace(root)


@contextmanager
def _opened(path: Path, start: Start) -> Iterator[Tree]:
    with ExitStack() as stack:
        with _refused(path):
            root = stack.enter_context(Tree.opened(path))
        # A run that was killed before it wrote what it is has left a lock, and nothing to lose.
        names = [name for name in root.names() if not _is_first_trace(root, name)]
        if names and not any(is_run(root, area) for area in ("", ARRIVING, UNFINISHED)):
            raise InputError(
                f"--out {path}: the folder holds other files; name a new folder or one of a run"
            )
        if start == "resumed" and not root.names():
            raise InputError(f"--resume: {path} holds no run to go on with")
        yield root


def _is_first_trace(root: Tree, name: str) -> bool:
    return (name == _LOCK and _is_lock(root)) or (name == manifests.FILE and not root.read(name))


def _is_lock(root: Tree) -> bool:
    content = root.read(_LOCK)
    return content is not None and len(content) < _DIGITS and (content or b"0").isdigit()


@contextmanager
def _locked(root: Tree) -> Iterator[None]:
    with _refused(root.path):
        if not root.lacks(_LOCK) and not _is_lock(root):
            root.aside(_LOCK)
        flags = os.O_RDWR | os.O_CREAT | os.O_NOFOLLOW | os.O_CLOEXEC
        descriptor = os.open(_LOCK, flags, 0o666, dir_fd=root.descriptor)
    with os.fdopen(descriptor, "rb+", buffering=0) as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            holder = lock.read().decode().strip() or "unknown"
            raise InputError(
                f"--out {root.path}: another run (process {holder}) is writing there"
            ) from error
        except OSError as error:
            raise InputError(
                f"--out {root.path}: the file system cannot lock: {error.strerror}"
            ) from error
        # The number only serves the message; on a full disk the lock holds all the same.
        with suppress(OSError):
            if os.fstat(lock.fileno()).st_nlink == 1:
                lock.truncate(0)
                lock.write(str(os.getpid()).encode())
        yield


def _begun_last(root: Tree, mark: Mark) -> str:
    """Where the run to go on with is; raises InputError where none is of the same input."""
    begun = [area for area in (UNFINISHED, "") if is_run(root, area)]
    if not begun:
        return _cleared(root)
    for area in begun:
        with root.below(area) as tree:
            if _is_same(tree, mark):
                return area
    with root.below(begun[0]) as tree:
        found = mark_in(tree)
        if found is not None:
            found.require_same(mark, tree)
        raise another_run(tree, "what it says of itself cannot be read, and its files differ")


def _is_same(tree: Tree, mark: Mark) -> bool:
    """Either witness will do: records say for themselves which run they belong to."""
    found = mark_in(tree)
    return mark.run in {found.run if found else None, manifest_of(tree).run}


def _cleared(root: Tree) -> str:
    """Where to begin afresh; a run that was begun and not finished beside an earlier one goes."""
    if not root.lacks(UNFINISHED):
        if not is_run(root, UNFINISHED):
            raise InputError(
                f"--out {root.path}: '{UNFINISHED}' in it is no run's; name another folder"
            )
        with refusals(root.path):
            discard(root, UNFINISHED)
    with refusals(root.path):
        if is_run(root) and has_results(root):
            _require_space(root)
            root.make(UNFINISHED)
            return UNFINISHED
        discard(root)
    return ""


def _require_space(root: Tree) -> None:
    """The new run stands beside the earlier one for a while, and may be as large."""
    sizes = (
        os.stat(name, dir_fd=root.descriptor, follow_symlinks=False).st_size
        for name in manifest_of(root).own()
    )
    needed, volume = sum(sizes), os.fstatvfs(root.descriptor)
    free = volume.f_bavail * volume.f_frsize
    if free < needed:
        raise InputError(
            f"--out {root.path}: {free / 1e6:.1f} MB are free, and the new run needs about "
            f"{needed / 1e6:.1f} MB beside the earlier one; make room or name another folder"
        )


def _prepared(tree: Tree, mark: Mark, header: Header) -> RunFolder:
    """The folder of a new run, or of one that goes on, without what a kill left half-written."""
    manifest = manifest_of(tree)
    folder = RunFolder(tree, manifest, mark.run)
    with refusals(tree.path):
        if manifest.run is None and not tree.lacks(manifests.FILE):
            folder.set_aside(manifests.FILE)
        manifest.begin(mark.run)
        for name in manifest.half_written():
            tree.remove(name)
        for name in FOLDERS:
            folder.clear_way(f"{name}/any")
        if mark_in(tree) != mark:
            folder.write(FILE, mark_text(header))
        tree.make(RECORDS)
        folder.open_log()
    return folder


@contextmanager
def _refused(path: Path) -> Iterator[None]:
    try:
        yield
    except OSError as error:
        raise InputError(f"--out {path}: cannot write there: {error.strerror}") from error
