"""Files of CAD parts and cache entries that other machines need.

Input: a robot and arrays from the cache of this machine, or a part and a function that returns its
cache entry. Output: `Provisions`, which travel to each worker of a cluster once, or the value of
the entry, computed by a worker. Rules: files are compared by content. If a worker has another file
at the path, or none, it writes a copy. The cache of this machine is searched before a worker
computes an entry, and results of a worker are stored in it.
"""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from lumped.errors import InputError
from lumped.mechanism.body import Body, Part
from lumped.robot_file import RobotFile
from lumped.robot_file.included import part_content
from meshes.part.reading.read import PartFile
from validation.run.cache import Arrays, CacheEntry, find, keep
from validation.run.executor import Executor, in_order

T = TypeVar("T")


@dataclass(frozen=True)
class Provisions:
    """Contents of the files of CAD parts, and arrays of cache entries by key."""

    files: Mapping[Path, bytes]
    entries: Mapping[str, Arrays]

    def unpack(self, robot_file: RobotFile) -> RobotFile:
        """Store the entries in the cache of this machine. Copy part files that it lacks.

        Returns the robot with paths of part files on this machine.
        """
        for key, arrays in self.entries.items():
            if find(key) is None:
                keep(key, arrays)
        bodies = {name: self._local(body) for name, body in robot_file.mechanism.bodies.items()}
        if bodies == robot_file.mechanism.bodies:
            return robot_file
        return replace(robot_file, mechanism=replace(robot_file.mechanism, bodies=bodies))

    def _local(self, body: Body) -> Body:
        """The body, with a copy of its file if this machine lacks it or has a different one."""
        if not isinstance(body.shape, Part):
            return body
        file, content = body.shape.file, self.files[body.shape.file]
        with suppress(OSError, InputError):
            if part_content(file) == content:
                return body
        copy = Path(tempfile.mkdtemp(prefix="flexproof-part-")) / file.name
        copy.write_bytes(content)
        return replace(body, shape=replace(body.shape, file=copy))


def provisions(robot_file: RobotFile, entries: Mapping[str, Arrays] | None = None) -> Provisions:
    """Provisions of a robot: the files of all its parts, and the cache `entries`."""
    shapes = [body.shape for body in robot_file.mechanism.bodies.values()]
    files = {shape.file for shape in shapes if isinstance(shape, Part)}
    return Provisions({file: part_content(file) for file in files}, entries or {})


@contextmanager
def sent_file(name: str, content: bytes) -> Iterator[Path]:
    """Context manager that yields a temporary file with the name and content of a part's file."""
    with tempfile.TemporaryDirectory(prefix="flexproof-part-") as folder:
        copy = Path(folder) / name
        copy.write_bytes(content)
        yield copy


@dataclass(frozen=True)
class _SentPart:
    """Computation of a part's cache entry on a machine without the file of the part.

    `content`: content of the file. `entry_of`: function that returns the cache entry of a part.
    """

    file: PartFile
    content: bytes
    entry_of: Callable[[PartFile], CacheEntry[Any]]

    def __call__(self) -> dict[str, Arrays]:
        """Arrays of the entry and of the entries that it needs, by cache key."""
        with sent_file(self.file.path.name, self.content) as copy:
            entry = self.entry_of(replace(self.file, path=copy))
            entry.value()
            return entry.stored_arrays


def value_by_worker(
    executor: Executor, file: PartFile, entry_of: Callable[[PartFile], CacheEntry[T]]
) -> T:
    """Value of the cache entry of a part, computed by a worker unless this machine has stored it.

    `entry_of`: function that returns the entry of a part.
    """
    entry = entry_of(file)
    if not entry.is_stored:
        work = _SentPart(file, part_content(file.path), entry_of)
        (entries,) = in_order(executor, [work])
        for key, arrays in entries.items():
            keep(key, arrays)
    return entry.value()
