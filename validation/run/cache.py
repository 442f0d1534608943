"""Cache on disk for arrays that are expensive to compute and depend on their key only.

Input: a key, a function that computes arrays, and one that converts them to a value. Output: the
value. Rule: a file with a valid seal, a checksum over key and content, is used; a damaged, changed
or renamed file counts as absent, and its content is computed again.

The folder is $XDG_CACHE_HOME/flexproof, otherwise ~/.cache/flexproof. FLEXPROOF_CACHE sets another
folder, or "off". Each key has a file (numpy's npz, which needs neither pickle nor a further
library), which appears whole or not at all. Any number of processes share the cache: if several
need the same entry, one process computes it and the other processes wait. Content is never
unpickled.

Keys contain a fingerprint of the sources that compute, so that changed sources or libraries give
new keys. It covers names and contents of files relative to the folder of the packages, so that a
wheel and a checkout of the same sources have the same keys. File times and compiled files do not
count. It is computed once per process.
"""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
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
from lumped.solver_request import requested_library

Arrays: TypeAlias = dict[str, Array]
T = TypeVar("T")
CACHE_VARIABLE = "FLEXPROOF_CACHE"
# Largest size of the cache (bytes). Beyond it, the entries unused for longest are removed until
# this fraction of the limit is left.
_CACHE_LIMIT, _REMAINING_SHARE = 5_000_000_000, 0.8
# Age (s) from which on locks and incomplete files of dead processes are removed.
_DAY = 86_400.0
# Number of entries last used by this process that it holds in memory.
_ENTRIES_IN_MEMORY = 64
_SEAL = b"\nflexproof "
PACKAGES = ("lumped", "meshes", "fem", "validation")
# Libraries on which numbers and meshes depend.
_LIBRARIES = ("gmsh", "numpy", "nvidia-cudss-cu13", "rslab", "scikit-fem", "scipy")
_SOURCES = (".py", ".toml", ".j2", ".css", ".js")


@dataclass(frozen=True)
class CacheEntry(Generic[T]):
    """A cached result: its key, and functions that compute its arrays and convert them to a value.

    An entry with a missing array or a wrong shape counts as absent, even if its seal is valid.
    `needs`: entries that the computation uses.
    """

    key: str
    compute: Callable[[], Mapping[str, Any]]
    read: Callable[[Arrays], T]
    needs: "tuple[CacheEntry[Any], ...]" = ()

    @property
    def is_stored(self) -> bool:
        """True if the value needs no computation."""
        return _read(self.key, self.read) is not None

    @property
    def stored_arrays(self) -> dict[str, Arrays]:
        """Stored arrays by key, of this entry and of those that it needs."""
        arrays = find(self.key)
        needed = {
            key: arrays for entry in self.needs for key, arrays in entry.stored_arrays.items()
        }
        return needed if arrays is None else needed | {self.key: arrays}

    def value(self) -> T:
        """Value from stored arrays, or from arrays that are computed now and stored."""
        value = _read(self.key, self.read)
        if value is None:
            with _key_lock(self.key):
                value = _read(self.key, self.read)
                if value is None:
                    value = self.read(keep(self.key, self.compute()))
        return value


def cache_folder() -> Path | None:
    """Folder of the cache, which need not exist.

    None if the cache is off or there is no home folder.
    """
    setting = os.environ.get(CACHE_VARIABLE)
    if setting:
        return None if setting == "off" else Path(setting)
    base = os.environ.get("XDG_CACHE_HOME")
    # By the XDG specification, relative paths are ignored.
    if base and Path(base).is_absolute():
        return Path(base) / "flexproof"
    try:
        return Path.home() / ".cache" / "flexproof"
    except RuntimeError:
        return None


@contextmanager
def available_cache() -> Iterator[None]:
    """Context with a cache for processes started in it: the user's, otherwise a temporary one."""
    if cache_folder() is not None:
        yield
        return
    setting = os.environ.get(CACHE_VARIABLE)
    with TemporaryDirectory(prefix="flexproof-cache-") as folder:
        os.environ[CACHE_VARIABLE] = folder
        try:
            yield
        finally:
            os.environ.pop(CACHE_VARIABLE) if setting is None else os.environ.update(
                {CACHE_VARIABLE: setting}
            )


def key_of(*inputs: object) -> str:
    """Key of a result that depends on plain `inputs`, including all fields of records in them."""
    return fingerprint(inputs)


def find(key: str) -> Arrays | None:
    """Arrays stored under a key, by name. None if there is no valid file."""
    remembered = _arrays_in_memory(key)
    if not remembered and (path := _path(key)) is not None:
        remembered |= _unsealed(key, read_regular(path) or b"")
        with suppress(OSError):
            os.utime(path, follow_symlinks=False)
    return remembered or None


def keep(key: str, arrays: Mapping[str, Any]) -> Arrays:
    """Store arrays and numbers under a key. Returns the arrays even if the disk fails."""
    remembered = _arrays_in_memory(key)
    remembered |= {name: np.asarray(value) for name, value in arrays.items()}
    if (path := _path(key)) is not None:
        with suppress(OSError):
            path.parent.mkdir(parents=True, exist_ok=True)
            write_whole(path, _sealed(key, remembered))
            _make_room(path.parent)
    return remembered


def require_shape(arrays: Arrays, **shapes: tuple[int | None, ...]) -> None:
    """Raise ValueError if an array does not have the shape given under its name.

    None in a shape stands for any positive length.
    """
    for name, expected_shape in shapes.items():
        shape = arrays[name].shape
        if len(shape) != len(expected_shape) or any(
            n != expected if expected is not None else not n
            for n, expected in zip(shape, expected_shape, strict=True)
        ):
            raise ValueError(f"{name} is of shape {shape}")


def _read(key: str, read: Callable[[Arrays], T]) -> T | None:
    try:
        arrays = find(key)
        return None if arrays is None else read(arrays)
    except (LookupError, TypeError, ValueError):
        _arrays_in_memory(key).clear()
        return None


@memo(_ENTRIES_IN_MEMORY)
def _arrays_in_memory(_key: str) -> Arrays:
    """Arrays of a key, by name, in the memory of this process. Empty at first."""
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
    """Arrays in the `content` of a file. {} if its seal is invalid or it cannot be read."""
    body, _, seal = content.rpartition(_SEAL)
    if seal != digest(key.encode() + body).encode():
        return {}
    try:
        with np.load(BytesIO(body), allow_pickle=False) as arrays:
            return dict(arrays)
    except (ValueError, OSError, BadZipFile):
        return {}


@contextmanager
def _key_lock(key: str) -> Iterator[None]:
    """Context with the lock of a key. Waits while another process computes the entry.

    Locks of dead processes are free.
    """
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
    """Remove the least recently used entries above the size limit, and files of dead processes."""
    files = sorted(
        (entry.stat().st_mtime, entry.stat().st_size, Path(entry.path))
        for entry in os.scandir(folder)
        if entry.name.endswith((".npz", ".lock", ".tmp")) and entry.is_file(follow_symlinks=False)
    )
    now = files[-1][0] if files else 0.0
    size_in_use = sum(size for _, size, _ in files)
    limit = _CACHE_LIMIT if size_in_use <= _CACHE_LIMIT else _REMAINING_SHARE * _CACHE_LIMIT
    for modified, size, path in files:
        if path.suffix == ".npz" and size_in_use > limit:
            size_in_use -= size
            path.unlink(missing_ok=True)
        elif path.suffix != ".npz" and now - modified > _DAY:
            path.unlink(missing_ok=True)


def program(*places: str) -> str:
    """Fingerprint of the sources in `places` and of the libraries that compute.

    `places` are names of folders and files; without any, all packages are covered. If "fem" is
    among them, the fingerprint also covers the requested library for sparse systems.
    """
    selected = places or PACKAGES
    return _program(selected, requested_library() if "fem" in selected else "")


@memo(8)
def _program(places: tuple[str, ...], solver: str) -> str:
    libraries = [_version(library) for library in _LIBRARIES]
    return fingerprint([source_digest(places), libraries, solver])


@memo(8)
def source_digest(places: tuple[str, ...] = PACKAGES) -> str:
    """Digest of the sources in these folders and files, by paths relative to the packages."""
    # Paths as text, since those of pathlib take twice as long as reading the files.
    root = str(Path(__file__).resolve().parents[2])
    fingerprints = sha256()
    for name in places:
        for path in _files(os.path.join(root, name)):  # noqa: PTH118
            with open(path, "rb") as file:  # noqa: PTH123
                content = file.read()
            file_name = path[len(root) :].replace(os.sep, "/")
            fingerprints.update(f"{file_name} {len(content)} ".encode())
            fingerprints.update(content)
    return fingerprints.hexdigest()


def _files(path: str) -> Iterator[str]:
    """Paths of a source file, or of the source files in a folder, in alphabetical order."""
    if path.endswith(_SOURCES):
        yield path
    for folder, folders, names in os.walk(path):
        folders[:] = sorted(set(folders) - {"__pycache__"})
        yield from (f"{folder}{os.sep}{name}" for name in sorted(names) if name.endswith(_SOURCES))


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        return ""
