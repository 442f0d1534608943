"""What was computed of a part, kept on the disk: a second run meshes and reduces nothing again.

A file (validation.store.arrays) is named by the digest of everything that its numbers depend on. Of
processes that need the same at the same time one computes, the others wait.
"""

import fcntl
import hashlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import Lock
from typing import Any

import gmsh
import numpy as np

from lumped.arrays import Array
from lumped.legs import Material
from meshes.part.interfaces import Interface
from meshes.part.reading.read import PartFile
from validation.store.arrays import cache_folder, find_arrays, keep_arrays, place_of
from validation.store.tree import StoreError

# Raised where the same input gives other numbers than before: meshes, elements, reduction.
_EDITION = 12
# What this process computed or read last stays in its memory.
_MOST_IN_MEMORY = 24
_in_memory: dict[str, dict[str, Array]] = {}
_MEMORY = Lock()
# Who collects what is asked for, the innermost last.
_collecting: list[dict[str, dict[str, Array]]] = []
# Not empty while it is only looked at what is there.
_looking: list[bool] = []


class _NotKept(Exception):  # noqa: N818  ends a look at what is kept, never leaves this module
    pass


def key_of(
    part: PartFile, interfaces: Sequence[Interface], material: Material, *more: object
) -> str:
    """The digest of a part's content, unit, interfaces, material, and of what `more` says."""
    parts: list[object] = [
        _EDITION,
        gmsh.__version__,
        hashlib.sha256(part.path.read_bytes()).hexdigest(),
        part.unit,
        material,
        *more,
    ]
    parts += [(i.name, i.faces, i.coupling, [float(x).hex() for x in i.point]) for i in interfaces]
    return hashlib.sha256(repr(parts).encode()).hexdigest()


def kept(key: str, compute: Callable[[], Mapping[str, Any]]) -> dict[str, Array]:
    """The arrays of that `key` from memory or the disk, else computed and put there."""
    with _MEMORY:
        found = _in_memory.get(key)
    if found is None:
        found = _from_disk(key, compute)
    _remember(key, found)
    for collected in _collecting:
        collected[key] = found
    return found


@contextmanager
def collected() -> Iterator[dict[str, dict[str, Array]]]:
    """All arrays, by key, that are asked for in this context, computed or read."""
    entries: dict[str, dict[str, Array]] = {}
    _collecting.append(entries)
    try:
        yield entries
    finally:
        _collecting.pop()


def put(entries: Mapping[str, dict[str, Array]]) -> None:
    """Keep what another machine computed as if it had been computed here."""
    folder = cache_folder("parts")
    for key, arrays in entries.items():
        _remember(key, arrays)
        if folder is not None and not place_of(folder, key).exists():
            with suppress(StoreError):
                keep_arrays(folder, key, arrays)


def is_kept(ask: Callable[[], object]) -> bool:
    """Whether what `ask` asks for is all kept, so that nothing is computed for it."""
    _looking.append(True)
    try:
        ask()
    except _NotKept:
        return False
    finally:
        _looking.pop()
    return True


def _computed(compute: Callable[[], Mapping[str, Any]]) -> dict[str, Array]:
    if _looking:
        raise _NotKept
    return {name: np.asarray(value) for name, value in compute().items()}


def _remember(key: str, found: dict[str, Array]) -> None:
    with _MEMORY:
        _in_memory.pop(key, None)
        _in_memory[key] = found
        if len(_in_memory) > _MOST_IN_MEMORY:
            del _in_memory[next(iter(_in_memory))]


def _from_disk(key: str, compute: Callable[[], Mapping[str, Any]]) -> dict[str, Array]:
    folder = cache_folder("parts")
    if folder is None:
        return _computed(compute)
    found = find_arrays(folder, key)
    if found is None:
        with _alone(place_of(folder, key)):
            found = find_arrays(folder, key)
            if found is None:
                found = _computed(compute)
                # A cache that cannot be written costs time, not the answer.
                with suppress(StoreError):
                    keep_arrays(folder, key, found)
    return found


@contextmanager
def _alone(place: Path) -> Iterator[None]:
    """Wait until no other process computes the same; the system frees locks of the dead."""
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        file = place.with_suffix(".lock").open("w")
    except OSError:
        yield
        return
    with file:
        fcntl.flock(file, fcntl.LOCK_EX)
        try:
            yield
        finally:
            place.with_suffix(".lock").unlink(missing_ok=True)
