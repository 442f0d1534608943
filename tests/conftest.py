"""Settings of all tests: no windows, and a cache folder for the session."""

import os
import shutil
import signal
import tempfile

import pytest

os.environ["MPLBACKEND"] = "Agg"
os.environ["PYVISTA_OFF_SCREEN"] = "true"

CACHE = pytest.StashKey[str]()
# Time limits (s) of the sets that run only when asked for; pyproject.toml has that of all others.
LIMITS = {"exhaustive": 3600, "faults": 3600, "soak": 6 * 3600}


def pytest_configure(config):
    """Create a cache folder that the workers of this session share. It is removed at the end."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        # In the background of a script Ctrl-C is ignored, by all that is started there as well.
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if not hasattr(config, "workerinput"):
        config.stash[CACHE] = tempfile.mkdtemp(prefix="flexproof-cache-")
        os.environ["XDG_CACHE_HOME"] = config.stash[CACHE]
        # The fonts of this machine are looked for once, not by each worker of each session.
        os.environ["MPLCONFIGDIR"] = str(config.rootpath / ".pytest_cache" / "matplotlib")


def pytest_collection_modifyitems(items):
    """Set the time limit of each test that has a mark of `LIMITS`."""
    for item in items:
        for mark, seconds in LIMITS.items():
            if item.get_closest_marker(mark):
                item.add_marker(pytest.mark.timeout(seconds))


def pytest_unconfigure(config):
    if CACHE in config.stash:
        shutil.rmtree(config.stash[CACHE], ignore_errors=True)
