"""Files that a user names for results: refused before those are computed, written after."""

import os
from pathlib import Path

from lumped.errors import InputError
from validation.console.streams import complain


def require_place(path: Path | None) -> None:
    """Raise InputError where no file can be written to `path`, before anything is computed for it.

    Folders that it lacks count as there: `write` makes them. None asks for no file.
    """
    if path is None:
        return
    if path.is_dir():
        raise InputError(f"{path}: cannot be written (is a folder); must be a file")
    nearest = next(place for place in (path, *path.absolute().parents) if place.exists())
    if nearest != path and not nearest.is_dir():
        raise InputError(f"{path}: cannot be written ({nearest} is no folder)")
    if not os.access(nearest, os.W_OK):
        raise InputError(f"{path}: cannot be written ({nearest} is not yours to write to)")


def write(path: Path, content: bytes) -> None:
    """Write a file, and say so; raises InputError with the system's reason."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror})") from error
    complain([f"{path} written"], 0)
