"""What the last self-test found on this machine: one line in the user's cache, which runs quote.

It holds for the sources, libraries and processor it was made with; of others nothing is known.
"""

import json
from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from validation.run.cache import cache_folder
from validation.run.files import read_regular, write_whole
from validation.run.provenance import processor, suite_digest, versions


def keep(*, passed: bool) -> None:
    """Remember how the self-test ended; a disk that refuses is not in the way."""
    path = _path()
    if path is None:
        return
    said = f"{'passed' if passed else 'FAILED'} on {datetime.now(UTC).date().isoformat()}"
    record = {"said": said, **_installation(versions(), suite_digest())}
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, f"{json.dumps(record)}\n".encode())


def last(header: Mapping[str, Any]) -> str:
    """As "passed on 2026-01-31", or "not run" where none is known of the program of a header."""
    path = _path()
    content = read_regular(path) if path else None
    try:
        record = json.loads(content or b"{}")
        said = str(record.pop("said"))
    except (ValueError, KeyError, AttributeError, TypeError):
        return "not run"
    known = _installation(header["versions"], header["suite_sha256"])
    return said if record == known else "not run"


def _path() -> Path | None:
    folder = cache_folder()
    return folder / "selftest.json" if folder else None


def _installation(libraries: Mapping[str, str], sources: str) -> dict[str, Any]:
    return {"versions": dict(libraries), "sources": sources, "processor": processor()}
