"""What every test needs: no windows, a cache of their own, and the same examples on every run."""

import os
import shutil
import signal
import tempfile

import pytest
from hypothesis import HealthCheck, settings

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
        # Wherever a test puts that, the fonts of this machine are looked for once.
        os.environ["MPLCONFIGDIR"] = config.stash[CACHE]


def pytest_unconfigure(config):
    if CACHE in config.stash:
        shutil.rmtree(config.stash[CACHE], ignore_errors=True)


settings.register_profile(
    "default",
    derandomize=True,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.register_profile("ci", settings.get_profile("default"), print_blob=True)
settings.register_profile(
    "search", settings.get_profile("default"), derandomize=False, max_examples=2000
)
settings.load_profile("ci" if "CI" in os.environ else "default")
