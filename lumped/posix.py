"""Modules that exist on POSIX systems only. On other systems, files are not locked."""

from importlib import import_module
from types import ModuleType


def _module(name: str) -> ModuleType | None:
    try:
        return import_module(name)
    except ImportError:
        return None


# The module is None on Windows.
fcntl, resource = map(_module, ("fcntl", "resource"))
