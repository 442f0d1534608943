"""Seconds and memory of solid legs by MUMPS through PETSc, beside rslab and SuperLU, as one table.

    python tests/benchmarks/mumps.py [--meshes FOLDER] [ROW ...]

Each row is a process of its own. A mesh is read from FOLDER if it is there, otherwise made by gmsh
and kept there. CPU seconds are those of order, factor and count, of all ranks; GB are those of the
largest process. At the end of each row: number of modes below 1 kHz, first and last frequency (Hz).
"""

# ruff: noqa: T201, E402  a script that prints its figures

import argparse
import os
import resource
import subprocess
import sys
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(Path(__file__).parent)]

import numpy as np
from graphics_card import LEGS, leg_of, mesh_of

from fem.bodies.solid import clamped_leg, solid_leg
from fem.solvers.backends import rslab, superlu
from fem.solvers.backends.petsc import client
from fem.solvers.certificate import count_below, pencil
from lumped.solver_request import RANKS_VARIABLE, VARIABLE

MODES = 20
SIZES = ("9k", "18k", "46k", "134k")
LEGS["46k"] = (0.85, 0.16, 0.26, 6)
SOLVERS = ("rslab 1", "rslab 2", "petsc 1", "petsc 2")
ROWS = [*(f"{size} {solver}" for size in SIZES[2:] for solver in SOLVERS), "18k superlu 1"]
HEADINGS = (
    "row",
    "unknowns",
    "order",
    "factor",
    "count",
    "8 columns",
    "20 modes",
    "CPU s",
    "GB",
    "load",
)


def peak(process: int) -> float:
    """Largest memory (GB) that a process has had."""
    status = Path(f"/proc/{process}/status").read_text(encoding="ascii")
    fields = dict(line.split(":", 1) for line in status.splitlines())
    return 1e-6 * int(fields["VmHWM"].split()[0])


def descendants(process: int) -> list[int]:
    """Processes that a process has started, and theirs."""
    children = Path(f"/proc/{process}/task/{process}/children").read_text(encoding="ascii").split()
    return [process for child in map(int, children) for process in (child, *descendants(child))]


def cpu_seconds() -> float:
    """CPU time of this process and of those that it has started."""
    ticks = 0
    for process in (os.getpid(), *descendants(os.getpid())):
        fields = (
            Path(f"/proc/{process}/stat").read_text(encoding="ascii").rpartition(")")[2].split()
        )
        ticks += int(fields[11]) + int(fields[12])
    return ticks / os.sysconf("SC_CLK_TCK")


def row(name: str, meshes: Path) -> str:
    """A line of the table."""
    size, solver, _ = name.split()
    load = os.getloadavg()[0]
    solid = solid_leg(leg_of(size), mesh_of(size, meshes))
    fixed_unknowns = np.add.outer(3 * solid.mesh.root.nodes, range(3)).ravel()
    free = np.setdiff1d(np.arange(solid.stiffness.shape[0]), fixed_unknowns)
    K, M = solid.stiffness[free][:, free], solid.mass[free][:, free]
    if solver == "petsc":
        client.server()
    cpu = cpu_seconds()
    times = [perf_counter()]
    matrix_pencil = pencil(K, M)
    _ = matrix_pencil.symbolic.peak_bytes
    times.append(perf_counter())
    factor = matrix_pencil.symbolic.factorise()
    times.append(perf_counter())
    inertia = count_below(matrix_pencil, (2.0 * np.pi * 1000.0) ** 2)
    times.append(perf_counter())
    cpu = cpu_seconds() - cpu
    repeated = matrix_pencil.symbolic.factorise() if solver == "petsc" else factor
    block = np.random.default_rng(1).standard_normal((len(free), 8))
    repeated.solve(block)
    begun = perf_counter()
    repeated.solve(block)
    seconds = [*np.diff(times), perf_counter() - begun]
    del factor, repeated, matrix_pencil
    memory = [peak(process) for process in descendants(os.getpid())] if solver == "petsc" else [0.0]
    own_memory = 1e-6 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    body = clamped_leg(solid)
    begun = perf_counter()
    modes = body.modes(MODES)
    seconds.append(perf_counter() - begun)
    figures = "  ".join(
        f"{number:9.3f}" for number in (*seconds, cpu, max(own_memory, *memory), load)
    )
    return f"{name:15} {len(free):8} {figures}  {inertia.negative} {modes.frequencies[[0, -1]]}"


def parsed_options(description: str | None) -> argparse.Namespace:
    """Rows, folder of meshes, and `here` (true in the process that measures a row)."""
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("rows", nargs="*")
    parser.add_argument("--meshes", type=Path, default=ROOT / "build" / "meshes")
    parser.add_argument("--here", action="store_true", help=argparse.SUPPRESS)
    return parser.parse_args()


def main() -> None:
    """Measure rows."""
    options = parsed_options(__doc__)
    if options.here:
        if os.environ[VARIABLE] == "auto":
            rslab.load_error = lambda: "not wanted"
            superlu.LARGEST = 10**6
        print(row(options.rows[0], options.meshes), flush=True)
        return
    print(HEADINGS)
    for name in options.rows or ROWS:
        _, solver, ranks = name.split()
        request = {"superlu": "auto"}.get(solver, solver)
        threads = ranks if solver == "rslab" else "1"
        environment = {VARIABLE: request, RANKS_VARIABLE: ranks, "OMP_NUM_THREADS": threads}
        environment["OPENBLAS_NUM_THREADS"] = "1"
        command = [sys.executable, __file__, "--here", "--meshes", str(options.meshes), name]
        subprocess.run(command, env=os.environ | environment, check=False)


if __name__ == "__main__":
    main()
