"""Arrays on the disk, to be found again: what costs time to compute and depends on its key alone.

A file per key, written whole or not at all, with a seal that covers the key and the content: what
is damaged, changed, or filed under another name is nothing, and is computed again. Any number of
processes may share a folder, as the user's cache: $XDG_CACHE_HOME/flexproof, else
~/.cache/flexproof; FLEXPROOF_CACHE names another one, or says "off".
"""

import os
from collections.abc import Mapping
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from lumped.arrays import Array
from validation.store.manifest import sealed, unsealed
from validation.store.tree import read_regular, refusals, write_atomically


def cache_folder(name: str) -> Path | None:
    """Where results of that kind are kept; None where nothing is to be kept, or there is no home.

    The folder need not exist.
    """
    told = os.environ.get("FLEXPROOF_CACHE")
    if told == "off":
        return None
    if told:
        return Path(told) / name
    base = os.environ.get("XDG_CACHE_HOME")
    # The specification has relative paths ignored.
    if base and Path(base).is_absolute():
        return Path(base) / "flexproof" / name
    try:
        return Path.home() / ".cache" / "flexproof" / name
    except RuntimeError:
        return None


def place_of(folder: Path, key: str) -> Path:
    """The file of a key."""
    return folder / f"{key}.npz"


def find_arrays(folder: Path, key: str) -> dict[str, Array] | None:
    """The arrays kept under a key; None where there are none that hold."""
    content = unsealed(key, read_regular(place_of(folder, key)) or b"")
    if content is None:
        return None
    # What the seal covers was written here, and needs no further doubt.
    with np.load(BytesIO(content), allow_pickle=False) as arrays:
        return dict(arrays)


def keep_arrays(folder: Path, key: str, arrays: Mapping[str, Any]) -> None:
    """Keep arrays and numbers under a key. Raises StoreError if the disk refuses."""
    buffer = BytesIO()
    np.savez(buffer, **arrays)
    with refusals(folder):
        folder.mkdir(parents=True, exist_ok=True)
    write_atomically(place_of(folder, key), sealed(key, buffer.getvalue()))
