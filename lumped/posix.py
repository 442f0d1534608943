"""Optional modules of POSIX systems. Without them, limits are unknown and locks not taken."""

from importlib import import_module
from types import ModuleType


def _module(name: str) -> ModuleType | None:
    try:
        return import_module(name)
    except ImportError:
        return None


# None on Windows.
fcntl, resource = map(_module, ("fcntl", "resource"))
