"""Provenance of the numbers of a run: input, program, libraries, machine and self-test.

Input: robot file, preset and options. Output: the header of results.json. The result of the last
self-test is one line in the user's cache; it is valid for the sources, libraries and processor of
that test only.
"""

import json
import platform
from collections.abc import Mapping
from contextlib import suppress
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from fem.calculix.run import calculix_version
from fem.machine import usable_cores
from fem.solvers.backends.choice import solver_name
from lumped.files import read_regular, write_whole
from lumped.robot_file import RobotFile
from lumped.text import counted
from validation.context import Preset
from validation.run.cache import cache_folder, source_digest

_LIBRARIES = (
    "flexproof",
    "numpy",
    "scipy",
    "scikit-fem",
    "gmsh",
    "rslab",
    "pyvista",
    "vtk",
    "matplotlib",
)


def header(robot_file: RobotFile, preset: Preset, options: Mapping[str, str]) -> dict[str, Any]:
    """Header of a run at its start, the object "run" of results.json."""
    return {
        "started": datetime.now(UTC).isoformat(timespec="seconds"),
        "robot": robot_file.name,
        "robot_file": robot_file.source,
        "robot_sha256": robot_file.sha256,
        "robot_tables": robot_file.tables,
        "preset": preset,
        "options": dict(options),
        "versions": versions(),
        "suite_sha256": source_digest(),
        "machine": machine(),
    }


def versions() -> dict[str, str]:
    """Versions of Python, of this program and of computing libraries, and the solver's name."""
    names = {"python": platform.python_version()}
    for library in _LIBRARIES:
        try:
            names[library] = version(library)
        except PackageNotFoundError:
            continue
    names |= {"CalculiX": found_version} if (found_version := calculix_version()) else {}
    return names | {"linear solver": solver_name()}


def machine() -> str:
    """System, number of cores and processor of this machine in one line, without its host name."""
    cores = counted(usable_cores(), "core")
    return f"{platform.system()} {platform.machine()}, {cores}, {processor()}"


def processor() -> str:
    """Name of the processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown processor"
    names = (line.partition(":")[2].strip() for line in lines if line.startswith("model name"))
    return next(names, platform.processor() or "unknown processor")


def keep_selftest(*, passed: bool) -> None:
    """Store the result of the self-test. Disk errors are ignored."""
    path = _selftest_file()
    if path is None:
        return
    sentence = f"{'passed' if passed else 'FAILED'} on {datetime.now(UTC).date().isoformat()}"
    record = {"result": sentence, **_installation(versions(), source_digest())}
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, f"{json.dumps(record)}\n".encode())


def last_selftest(header: Mapping[str, Any]) -> str:
    """Result of the last self-test, such as "passed on 2026-01-31".

    "not run" if no result is known for the program and the libraries in `header`.
    """
    path = _selftest_file()
    content = read_regular(path) if path else None
    try:
        record = json.loads(content or b"{}")
        sentence = str(record.pop("result"))
    except (ValueError, KeyError, AttributeError, TypeError):
        return "not run"
    installation = _installation(header["versions"], header["suite_sha256"])
    return sentence if record == installation else "not run"


def _selftest_file() -> Path | None:
    folder = cache_folder()
    return folder / "selftest.json" if folder else None


def _installation(libraries: Mapping[str, str], sources: str) -> dict[str, Any]:
    return {"versions": dict(libraries), "sources": sources, "processor": processor()}
