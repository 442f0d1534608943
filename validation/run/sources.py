"""Digest of the computing sources, so that changed sources or libraries give new cache keys.

Input: names of folders and files. Output: a fingerprint. Rule: it covers names and contents of
files relative to the folder of the packages, so that a wheel and a checkout of the same sources
have the same digest. File times and compiled files do not count. Computed once per process.
"""

import os
from collections.abc import Iterator
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from lumped.memo import fingerprint, memo
from lumped.solver_request import requested_library

PACKAGES = ("lumped", "meshes", "fem", "validation")
# Libraries on which numbers and meshes depend.
_LIBRARIES = ("gmsh", "numpy", "nvidia-cudss-cu13", "rslab", "scikit-fem", "scipy")
_SOURCES = (".py", ".toml", ".j2", ".css", ".js")


def program(*places: str) -> str:
    """Fingerprint of the sources in `places` and of the libraries that compute.

    `places` are names of folders and files; without any, all packages are covered. If "fem" is
    among them, the fingerprint also covers the requested library for sparse systems.
    """
    selected = places or PACKAGES
    return _program(selected, requested_library() if "fem" in selected else "")


@memo(8)
def _program(places: tuple[str, ...], solver: str) -> str:
    libraries = [_version(library) for library in _LIBRARIES]
    return fingerprint([source_digest(places), libraries, solver])


@memo(8)
def source_digest(places: tuple[str, ...] = PACKAGES) -> str:
    """Digest of the sources in these folders and files, by paths relative to the packages."""
    # Paths as text, since those of pathlib take twice as long as reading the files.
    root = str(Path(__file__).resolve().parents[2])
    digest = sha256()
    for name in places:
        for path in _files(os.path.join(root, name)):  # noqa: PTH118
            with open(path, "rb") as file:  # noqa: PTH123
                content = file.read()
            file_name = path[len(root) :].replace(os.sep, "/")
            digest.update(f"{file_name} {len(content)} ".encode())
            digest.update(content)
    return digest.hexdigest()


def _files(path: str) -> Iterator[str]:
    """Paths of a source file, or of the source files in a folder, in alphabetical order."""
    if path.endswith(_SOURCES):
        yield path
    for folder, folders, names in os.walk(path):
        folders[:] = sorted(set(folders) - {"__pycache__"})
        yield from (f"{folder}{os.sep}{name}" for name in sorted(names) if name.endswith(_SOURCES))


def _version(library: str) -> str:
    try:
        return version(library)
    except PackageNotFoundError:
        return ""
