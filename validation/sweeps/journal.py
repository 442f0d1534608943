"""What a sweep has finished, kept in memory and, with a folder, on the disk.

One file per unit (validation.store.arrays), named by the unit's content and the program's own
sources: another robot, mesh or version never meets an old result.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

from validation.context import fingerprint
from validation.results.provenance import suite_digest
from validation.store.arrays import find_arrays, keep_arrays

T = TypeVar("T")


@dataclass(frozen=True)
class Journal:
    """Finished results by key; without a `folder` they last as long as the process."""

    folder: Path | None = None
    _memory: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def find(self, key: str, kind: Callable[..., T]) -> T | None:
        """The result of type `kind` kept under `key`; None if there is none or it is damaged."""
        if key not in self._memory and self.folder is not None:
            kept = find_arrays(self.folder, key)
            if kept is None:
                return None
            # Numbers come back as arrays of no dimension.
            self._memory[key] = kind(**{name: array[()] for name, array in kept.items()})
        found: T | None = self._memory.get(key)
        return found

    def keep(self, key: str, result: Any) -> None:
        """Keep a dataclass of numbers and arrays. Raises StoreError if the disk refuses."""
        self._memory[key] = result
        if self.folder is not None:
            arrays = {entry.name: getattr(result, entry.name) for entry in fields(result)}
            keep_arrays(self.folder, key, arrays)


@cache
def journal_in(folder: str) -> Journal:
    """The journal of a folder, one per process; "" for one in memory."""
    return Journal(Path(folder) if folder else None)


def key_of(unit: object) -> str:
    """Name of a unit's result: equal for equal units computed by equal sources."""
    return fingerprint((_sources(), unit))


@cache
def _sources() -> str:
    return suite_digest()
