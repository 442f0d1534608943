"""Installation of packages and their dependencies in the versions of the lock files.

Input: names of extras. Output: installed packages. Rule: a package is installed if it, or a
dependency, is missing or has a version that differs from the lock. Hashes are checked.
"""

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

# Lock files that together contain all extras, and the file that lists the requirements of each.
LOCKS, PROJECT = ("requirements-dev.lock", "requirements-gpu.lock"), "pyproject.toml"
# Requirement and lock-file lines of each package, by name.
Locked: TypeAlias = Mapping[str, tuple[Requirement, str]]


def add(root: Path, names: Iterable[str]) -> list[str]:
    """Install the packages of extras that are missing or differ from the locked version.

    `root` is the folder of the sources. Returns the names of the installed packages. Raises
    ComputationError if a lock lacks a package or if pip fails.
    """
    optional = loads((root / PROJECT).read_text("utf-8"))["project"]["optional-dependencies"]
    texts = [text for name in dict.fromkeys(names) for text in optional.get(name, ())]
    requirements = [
        requirement for requirement in map(Requirement, texts) if _applies(requirement, ("",))
    ]
    locked: dict[str, tuple[Requirement, str]] = {}
    for lock in LOCKS:
        locked |= locked_packages((root / lock).read_text("utf-8"))
    added: list[str] = []
    # The dependencies of a package are known only after its installation.
    while missing := missing_packages(requirements, locked):
        if set(missing) & set(added):
            raise ComputationError(f"pip did not install {', '.join(missing)}")
        _install([locked[name][1] for name in missing])
        added += missing
    return added


def locked_packages(lock: str) -> Locked:
    """Requirement and lines of each package, by name, from the text `lock` of a lock file."""
    packages: dict[str, tuple[Requirement, str]] = {}
    for lines in re.split(r"\n(?=[A-Za-z0-9])", lock):
        if re.match(r"[A-Za-z0-9]", lines):
            requirement = Requirement(lines.partition(" \\\n")[0])
            packages[canonicalize_name(requirement.name)] = requirement, f"{lines.rstrip()}\n"
    return packages


def missing_packages(requirements: Iterable[Requirement], locked: Locked) -> list[str]:
    """Names of required packages and dependencies that are not installed in the locked version.

    Raises ComputationError for a package that no lock contains for this machine.
    """
    queue, seen, missing = list(requirements), set(), []
    while queue:
        requirement = queue.pop()
        name = canonicalize_name(requirement.name)
        if (name, *sorted(requirement.extras)) in seen:
            continue
        seen.add((name, *sorted(requirement.extras)))
        if name not in locked or not _applies(locked[name][0], ("",)):
            raise ComputationError(
                f"no version of {name} for this machine in {' and '.join(LOCKS)}"
            )
        try:
            installed = distribution(name)
        except PackageNotFoundError:
            missing.append(name)
            continue
        if not locked[name][0].specifier.contains(installed.version, prereleases=True):
            missing.append(name)
            continue
        dependencies = map(Requirement, installed.requires or ())
        extras = ("", *requirement.extras)
        queue += [dependency for dependency in dependencies if _applies(dependency, extras)]
    return sorted(set(missing))


def _applies(requirement: Requirement, extras: Iterable[str]) -> bool:
    marker = requirement.marker
    return marker is None or any(marker.evaluate({"extra": extra}) for extra in extras)


def _install(blocks: Iterable[str]) -> None:
    with TemporaryDirectory(prefix="flexproof-extras-") as folder:
        file = Path(folder) / "requirements.txt"
        file.write_text("".join(blocks), encoding="utf-8")
        command = [sys.executable, "-m", "pip", "install", "--disable-pip-version-check"]
        # Wheels only: a build from source would download and run packages that are not locked.
        command += ["--quiet", "--no-deps", "--only-binary", ":all:", "--require-hashes"]
        done = subprocess.run(  # noqa: S603  our own command
            [*command, "--requirement", str(file)],
            env=os.environ | {"PIP_USER": "0"},
            stdout=sys.stderr,
            check=False,
        )
    if done.returncode:
        raise ComputationError("extras: pip failed to install the packages (see above)")


if __name__ == "__main__":
    try:
        add(Path(sys.argv[1]), sys.argv[2:])
    except ComputationError as error:
        sys.exit(f"flexproof: {error}")
