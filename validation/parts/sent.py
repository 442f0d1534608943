"""Computation of a CAD part's results by a worker of a cluster, which receives the part's file.

Input: a part as it was read on this machine, and a function that returns its cache entry. Output:
the value of the entry. Rule: the cache of this machine is searched first. Results of a worker are
stored in it.
"""

import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from lumped.robot_file.included import part_content
from meshes.part.reading.read import PartFile
from validation.run.cache import Arrays, CacheEntry, keep
from validation.run.executor import Executor, in_order

T = TypeVar("T")


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
