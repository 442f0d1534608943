"""Modules of POSIX systems: without them no limit is known and no lock is taken."""

from importlib import import_module
from types import ModuleType


def _module(name: str) -> ModuleType | None:
    try:
        return import_module(name)
    except ImportError:
        return None


# None on Windows.
fcntl, resource = map(_module, ("fcntl", "resource"))
