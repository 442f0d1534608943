"""What every test needs: no windows, and a cache of their own."""

import os
import shutil
import signal
import tempfile

import pytest

os.environ["MPLBACKEND"] = "Agg"
os.environ["PYVISTA_OFF_SCREEN"] = "true"

CACHE = pytest.StashKey[str]()


def pytest_configure(config):
    """The workers of a session share a cache, which is nobody else's and goes with it."""
    if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
        # In the background of a script Ctrl-C is ignored, by all that is started there as well.
        signal.signal(signal.SIGINT, signal.default_int_handler)
    if not hasattr(config, "workerinput"):
        config.stash[CACHE] = tempfile.mkdtemp(prefix="flexproof-cache-")
        os.environ["XDG_CACHE_HOME"] = config.stash[CACHE]
        # The fonts of this machine are looked for once, not by each worker of each session.
        os.environ["MPLCONFIGDIR"] = str(config.rootpath / ".pytest_cache" / "matplotlib")


def pytest_unconfigure(config):
    if CACHE in config.stash:
        shutil.rmtree(config.stash[CACHE], ignore_errors=True)
