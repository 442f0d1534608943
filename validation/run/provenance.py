"""Where the numbers of a run come from: input, program, libraries, machine."""

import platform
from collections.abc import Mapping
from datetime import UTC, datetime
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from fem.calculix.run import calculix_version
from fem.machine import usable_cores
from fem.solvers.cholesky import solver_name
from lumped.robot_file import RobotFile
from validation.context import Preset

_LIBRARIES = (
    "flexproof",
    "numpy",
    "scipy",
    "scikit-fem",
    "gmsh",
    "cvxopt",
    "pymetis",
    "pyvista",
    "vtk",
    "matplotlib",
)
_PACKAGES = ("lumped", "meshes", "fem", "validation")
_SOURCES = frozenset({".py", ".toml", ".j2", ".css", ".js"})


def header(robot_file: RobotFile, preset: Preset, options: Mapping[str, str]) -> dict[str, Any]:
    """The "run" of results.json as far as it is known at the start."""
    return {
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "robot": robot_file.name,
        "robot_file": robot_file.source,
        "robot_sha256": robot_file.sha256,
        "robot_tables": robot_file.tables,
        "preset": preset,
        "options": dict(options),
        "versions": versions(),
        "suite_sha256": suite_digest(),
        "machine": machine(),
    }


def versions() -> dict[str, str]:
    """Versions of Python, of this program and of the libraries that compute; the solver's name."""
    found = {"python": platform.python_version()}
    for library in _LIBRARIES:
        try:
            found[library] = version(library)
        except PackageNotFoundError:
            continue
    found |= {"CalculiX": found_version} if (found_version := calculix_version()) else {}
    return found | {"linear solver": solver_name()}


def machine() -> str:
    """The machine in one line, without its name."""
    return f"{platform.system()} {platform.machine()}, {usable_cores()} cores, {processor()}"


def suite_digest() -> str:
    """Digest of this program's own sources: results of different sources are not to be mixed."""
    root = Path(__file__).resolve().parents[2]
    digest = sha256()
    for package in _PACKAGES:
        for path in sorted((root / package).rglob("*")):
            if path.suffix in _SOURCES:
                digest.update(str(path.relative_to(root)).encode())
                digest.update(path.read_bytes())
    return digest.hexdigest()


def processor() -> str:
    """The processor's name."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown processor"
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor() or "unknown processor")
