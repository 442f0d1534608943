"""Packages of an environment brought to what a lock says, with all that they depend on."""

import os
import re
import subprocess
import sys
from collections.abc import Iterable, Mapping
from importlib.metadata import PackageNotFoundError, distribution
from pathlib import Path
from tempfile import TemporaryDirectory
from tomllib import loads
from typing import TypeAlias

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

from lumped.errors import ComputationError

# The files of the sources: the locks that hold all extras together, and the extras by name.
LOCKS, PROJECT = ("requirements-dev.lock", "requirements-gpu.lock"), "pyproject.toml"
# By name: a package as it is locked, and the lines that say so.
Locked: TypeAlias = Mapping[str, tuple[Requirement, str]]


def add(root: Path, names: Iterable[str]) -> list[str]:
    """Install what extras lack or have in another version than the lock, and return its names.

    `root` is the folder of the sources.

    Raises ComputationError if the lock or pip fails.
    """
    optional = loads((root / PROJECT).read_text("utf-8"))["project"]["optional-dependencies"]
    texts = [text for name in dict.fromkeys(names) for text in optional.get(name, ())]
    wanted = [one for one in map(Requirement, texts) if _applies(one, ("",))]
    locked: dict[str, tuple[Requirement, str]] = {}
    for lock in LOCKS:
        locked |= locked_packages((root / lock).read_text("utf-8"))
    added: list[str] = []
    # What a package depends on is known when it is installed.
    while missing := missing_packages(wanted, locked):
        if set(missing) & set(added):
            raise ComputationError(f"pip did not install {', '.join(missing)}")
        _install([locked[name][1] for name in missing])
        added += missing
    return added


def locked_packages(lock: str) -> Locked:
    """Requirement and lines of each package of a lock, by its name."""
    found: dict[str, tuple[Requirement, str]] = {}
    for lines in re.split(r"\n(?=[A-Za-z0-9])", lock):
        if re.match(r"[A-Za-z0-9]", lines):
            one = Requirement(lines.partition(" \\\n")[0])
            found[canonicalize_name(one.name)] = one, f"{lines.rstrip()}\n"
    return found


def missing_packages(wanted: Iterable[Requirement], locked: Locked) -> list[str]:
    """Packages that requirements need, directly or not, and that are not there as locked.

    Raises ComputationError for a package that no lock has for this machine.
    """
    queue, seen, missing = list(wanted), set(), []
    while queue:
        one = queue.pop()
        name = canonicalize_name(one.name)
        if (name, *sorted(one.extras)) in seen:
            continue
        seen.add((name, *sorted(one.extras)))
        if name not in locked or not _applies(locked[name][0], ("",)):
            raise ComputationError(f"no {name} for this machine in {' and '.join(LOCKS)}")
        try:
            there = distribution(name)
        except PackageNotFoundError:
            missing.append(name)
            continue
        if not locked[name][0].specifier.contains(there.version, prereleases=True):
            missing.append(name)
            continue
        needed = map(Requirement, there.requires or ())
        queue += [other for other in needed if _applies(other, ("", *one.extras))]
    return sorted(set(missing))


def _applies(requirement: Requirement, extras_of_it: Iterable[str]) -> bool:
    marker = requirement.marker
    return marker is None or any(marker.evaluate({"extra": extra}) for extra in extras_of_it)


def _install(blocks: Iterable[str]) -> None:
    with TemporaryDirectory(prefix="flexproof-extras-") as folder:
        file = Path(folder) / "requirements.txt"
        file.write_text("".join(blocks), encoding="utf-8")
        command = [sys.executable, "-m", "pip", "install", "--disable-pip-version-check"]
        # Wheels only: building from source would fetch and run what the lock does not name.
        command += ["--quiet", "--no-deps", "--only-binary", ":all:", "--require-hashes"]
        done = subprocess.run(  # noqa: S603  our own command
            [*command, "--requirement", str(file)],
            env=os.environ | {"PIP_USER": "0"},
            stdout=sys.stderr,
            check=False,
        )
    if done.returncode:
        raise ComputationError("extras: pip could not install them (see above)")


if __name__ == "__main__":
    try:
        add(Path(sys.argv[1]), sys.argv[2:])
    except ComputationError as error:
        sys.exit(f"flexproof: {error}")
