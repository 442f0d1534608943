"""What the program's checks found, kept in the user's cache for runs to come.

One file for each preset and all that its numbers depend on: sources and libraries by version, the
processor. A line for each finished check is added in one step, so that two runs at once, or a kill,
leave whole lines; each carries its digest, so that nothing damaged or foreign is believed. What is
missing is computed again.
"""

from collections.abc import Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from time import time
from typing import Any

import msgspec

from validation.results.provenance import processor
from validation.results.tasks import Record
from validation.store.cache import cache_folder
from validation.store.manifest import digest
from validation.store.sealed_record import sealed_record, unsealed_record
from validation.store.tree import Tree, read_regular

FOLDER = "selftest"
# Files of versions that nobody has asked for in so many seconds are removed.
_FORGOTTEN = 60 * 24 * 3600.0


@dataclass
class Kept:
    """The file of a preset and its key; `path` None: nothing is kept, and `why` says so."""

    key: str
    path: Path | None
    why: str = ""
    _begun: bool = field(default=False, repr=False)

    def records(self) -> dict[str, Record]:
        """The records that hold, by id; of two of one id the later."""
        content = (read_regular(self.path) if self.path else None) or b""
        found = (unsealed_record(self.key, line) for line in content.splitlines())
        return {str(record.get("id")): record for record in found if record is not None}

    def add(self, record: Mapping[str, Any]) -> None:
        """Keep a check that was just made; one that failed is to be tried again.

        What the disk refuses costs time, not the answer.
        """
        if self.path is None or record["verdict"] == "failed":
            return
        now = datetime.now(UTC).isoformat(timespec="seconds")
        line = sealed_record(self.key, {**record, "checked": now})
        try:
            if not self._begun:
                self.path.parent.mkdir(parents=True, exist_ok=True)
                _remove_forgotten(self.path.parent)
                self._begun = True
            # A line that a full disk cut off does not spoil the next one.
            with Tree.opened(self.path.parent) as folder:
                folder.append(self.path.name, f"\n{line}".encode())
        except OSError as error:
            self.path, self.why = None, f"{self.path}: {error.strerror or error}"

    def forget(self, why: str = "") -> None:
        """Remove what is kept, for a reason `why`: the checks are to be made again."""
        if self.path is not None:
            with suppress(OSError):
                self.path.unlink(missing_ok=True)
        self.why = self.why or why


def kept_of(header: Mapping[str, Any]) -> Kept:
    """Where the checks of a run with this header are kept."""
    named = {name: header[name] for name in ("preset", "suite_sha256", "versions")}
    text = msgspec.json.encode({**named, "processor": processor()}, order="deterministic")
    key, folder = digest(text), cache_folder(FOLDER)
    if folder is None:
        return Kept(key, None, "FLEXPROOF_CACHE is off, or there is no home folder")
    return Kept(key, folder / f"{header['preset']}-{key}.jsonl")


def _remove_forgotten(folder: Path) -> None:
    for path in folder.glob("*.jsonl"):
        with suppress(OSError):
            if path.lstat().st_mtime < time() - _FORGOTTEN:
                path.unlink()
