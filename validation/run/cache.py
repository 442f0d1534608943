"""The cache on the disk: arrays that cost time to compute and depend on their key alone.

$XDG_CACHE_HOME/flexproof, else ~/.cache/flexproof; FLEXPROOF_CACHE names another folder, or says
"off". A file per key (numpy's npz, which needs no pickle and no further library), written whole or
not at all, with a seal over key and content: what is damaged, changed, or filed under another name
is nothing, and is computed again. Any number of processes share it: of those that need the same at
the same time one computes, and the others wait. Nothing that is read is ever unpickled.
"""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, Generic, TypeAlias, TypeVar
from zipfile import BadZipFile

import numpy as np

from lumped.arrays import Array
from lumped.files import digest, read_regular, write_whole
from lumped.memo import fingerprint, memo
from lumped.posix import fcntl

Arrays: TypeAlias = dict[str, Array]
T = TypeVar("T")
_SWITCH = "FLEXPROOF_CACHE"
# Bytes that the cache may take; what was not asked for the longest goes first, to a share of it.
_MOST, _SHARE = 5_000_000_000, 0.8
# Files of dead processes, locks and halves, are swept up after a day (s).
_DAY = 86_400.0
# What this process computed or read last stays in its memory.
_IN_MEMORY = 64
_SEAL = b"\nflexproof "


@dataclass(frozen=True)
class CacheEntry(Generic[T]):
    """A result that is kept: its key, how its arrays are computed, and the value read from them.

    Arrays without one that `read` needs, or with another shape, count as absent, even if sealed.
    `needs` are entries that computing asks for.
    """

    key: str
    compute: Callable[[], Mapping[str, Any]]
    read: Callable[[Arrays], T]
    needs: "tuple[CacheEntry[Any], ...]" = ()

    @property
    def is_kept(self) -> bool:
        """Whether nothing would be computed for the value."""
        return _read(self.key, self.read) is not None

    @property
    def kept(self) -> dict[str, Arrays]:
        """Arrays by key that are kept of this entry and of those that it needs."""
        own = find(self.key)
        needed = {key: arrays for entry in self.needs for key, arrays in entry.kept.items()}
        return needed if own is None else needed | {self.key: own}

    def value(self) -> T:
        """The value: of the arrays that are kept, else of those computed now, which are kept."""
        found = _read(self.key, self.read)
        if found is None:
            with _alone(self.key):
                found = _read(self.key, self.read)
                if found is None:
                    found = self.read(keep(self.key, self.compute()))
        return found


def cache_folder() -> Path | None:
    """Where results are kept; None where nothing is to be kept, or there is no home.

    The folder need not exist.
    """
    told = os.environ.get(_SWITCH)
    if told:
        return None if told == "off" else Path(told)
    base = os.environ.get("XDG_CACHE_HOME")
    # The specification has relative paths ignored.
    if base and Path(base).is_absolute():
        return Path(base) / "flexproof"
    try:
        return Path.home() / ".cache" / "flexproof"
    except RuntimeError:
        return None


@contextmanager
def some_cache() -> Iterator[None]:
    """A cache that processes started here share: without one of the user's, for the meantime."""
    if cache_folder() is not None:
        yield
        return
    told = os.environ.get(_SWITCH)
    with TemporaryDirectory(prefix="flexproof-cache-") as folder:
        os.environ[_SWITCH] = folder
        try:
            yield
        finally:
            os.environ.pop(_SWITCH) if told is None else os.environ.update({_SWITCH: told})


def key_of(*inputs: object) -> str:
    """The key of what depends on plain data: every field of every record is in it."""
    return fingerprint(inputs)


def find(key: str) -> Arrays | None:
    """The arrays kept under a key; None where there are none that hold."""
    remembered = _remembered(key)
    if not remembered and (path := _path(key)) is not None:
        remembered |= _unsealed(key, read_regular(path) or b"")
        with suppress(OSError):
            os.utime(path, follow_symlinks=False)
    return remembered or None


def keep(key: str, arrays: Mapping[str, Any]) -> Arrays:
    """Keep arrays and numbers under a key; a disk that refuses costs time, not the answer."""
    remembered = _remembered(key)
    remembered |= {name: np.asarray(value) for name, value in arrays.items()}
    if (path := _path(key)) is not None:
        with suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, _sealed(key, remembered))
            _make_room(path.parent)
    return remembered


def require_shape(arrays: Arrays, **shapes: tuple[int | None, ...]) -> None:
    """Raise ValueError where an array has another shape, or none of what any number there is of."""
    for name, shape in shapes.items():
        found = arrays[name].shape
        if len(found) != len(shape) or any(
            n != wanted if wanted is not None else not n
            for n, wanted in zip(found, shape, strict=True)
        ):
            raise ValueError(f"{name} is of shape {found}")


def _read(key: str, read: Callable[[Arrays], T]) -> T | None:
    try:
        arrays = find(key)
        return None if arrays is None else read(arrays)
    except (LookupError, TypeError, ValueError):
        _remembered(key).clear()
        return None


@memo(_IN_MEMORY)
def _remembered(_key: str) -> Arrays:
    """A place in this process's memory, empty at first."""
    return {}


def _path(key: str) -> Path | None:
    folder = cache_folder()
    return folder / f"{key}.npz" if folder else None


def _sealed(key: str, arrays: Arrays) -> bytes:
    buffer = BytesIO()
    np.savez(buffer, allow_pickle=False, **arrays)
    content = buffer.getvalue()
    return content + _SEAL + digest(key.encode() + content).encode()


def _unsealed(key: str, content: bytes) -> Arrays:
    """The arrays in a file; none where its seal does not hold."""
    body, _, seal = content.rpartition(_SEAL)
    if seal != digest(key.encode() + body).encode():
        return {}
    try:
        with np.load(BytesIO(body), allow_pickle=False) as arrays:
            return dict(arrays)
    except (ValueError, OSError, BadZipFile):
        return {}


@contextmanager
def _alone(key: str) -> Iterator[None]:
    """Wait until no other process computes the same; the system frees locks of the dead."""
    path = _path(key)
    with ExitStack() as stack:
        with suppress(OSError):
            if path is not None:
                path.parent.mkdir(parents=True, exist_ok=True)
                lock = path.with_suffix(".lock")
                file = stack.enter_context(lock.open("a"))
                if fcntl is not None:
                    fcntl.flock(file, fcntl.LOCK_EX)
                stack.callback(lock.unlink, missing_ok=True)
        yield


def _make_room(folder: Path) -> None:
    """Remove what was not asked for the longest where there is too much, and what the dead left."""
    files = sorted(
        (entry.stat().st_mtime, entry.stat().st_size, Path(entry.path))
        for entry in os.scandir(folder)
        if entry.name.endswith((".npz", ".lock", ".tmp")) and entry.is_file(follow_symlinks=False)
    )
    now = files[-1][0] if files else 0.0
    taken = sum(size for _, size, _ in files)
    most = _MOST if taken <= _MOST else _SHARE * _MOST
    for at, size, path in files:
        if path.suffix == ".npz" and taken > most:
            taken -= size
            path.unlink(missing_ok=True)
        elif path.suffix != ".npz" and now - at > _DAY:
            path.unlink(missing_ok=True)
