"""What a sweep has finished, kept in memory and, with a folder, on the disk.

One file per unit, written whole or not at all, named by the unit's content and the program's own
sources: another robot, mesh or version never meets an old result. Several processes may share a
folder.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from io import BytesIO
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from lumped.caches import lru_cache
from validation.context import fingerprint
from validation.results.provenance import suite_digest
from validation.store.manifest import sealed, unsealed
from validation.store.tree import read_regular, refusals, write_atomically

T = TypeVar("T")


@dataclass(frozen=True)
class Journal:
    """Finished results by key; without a `folder` they last as long as the process."""

    folder: Path | None = None
    _memory: dict[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def find(self, key: str, kind: Callable[..., T]) -> T | None:
        """The result of type `kind` kept under `key`; None if there is none or it is damaged."""
        if key not in self._memory and self.folder is not None:
            content = unsealed(key, read_regular(self.folder / f"{key}.npz") or b"")
            if content is None:
                return None
            # What the seal covers was written here, and needs no further doubt.
            with np.load(BytesIO(content), allow_pickle=False) as file:
                # Numbers come back as arrays of no dimension.
                entries = {name: file[name][()] for name in file.files}
            self._memory[key] = kind(**entries)
        found: T | None = self._memory.get(key)
        return found

    def keep(self, key: str, result: Any) -> None:
        """Keep a dataclass of numbers and arrays. Raises StoreError if the disk refuses."""
        self._memory[key] = result
        if self.folder is None:
            return
        with refusals(self.folder):
            self.folder.mkdir(parents=True, exist_ok=True)
        buffer = BytesIO()
        np.savez(buffer, **{entry.name: getattr(result, entry.name) for entry in fields(result)})
        write_atomically(self.folder / f"{key}.npz", sealed(key, buffer.getvalue()))


def key_of(unit: object) -> str:
    """Name of a unit's result: equal for equal units computed by equal sources."""
    return fingerprint((_sources(), unit))


@lru_cache(maxsize=None)
def _sources() -> str:
    return suite_digest()
