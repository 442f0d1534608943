"""The user's cache: what can be computed again, and is kept to save the time.

The folder is $XDG_CACHE_HOME/flexproof, else ~/.cache/flexproof; FLEXPROOF_CACHE names another one,
or says "off".
"""

import os
from pathlib import Path


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
