"""Seconds and memory for the 6×6 compliance of solid legs by each solver, as one table.

    python tests/benchmarks/part_compliance.py [--meshes FOLDER] [ROW ...]

A row is a size, a solver and its threads or ranks. Each is a process of its own. Seconds, and CPU
seconds of all threads and ranks, are those of order and factor, or of the set-up of multigrid, of
the check of the support (two right-hand sides) and of six loads. GB are those of this process, of
the largest rank, and of all together. `difference` is that of the compliance from the first row of
the size, relative to the energies of the loads.
"""

# ruff: noqa: T201, E402  a script that prints its figures

import os
import subprocess
import sys
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).resolve().parents[2]
sys.path[:0] = [str(ROOT), str(Path(__file__).parent)]

import numpy as np
from graphics_card import LEGS, leg_of, mesh_of
from mumps import cpu_seconds, descendants, parsed_options, peak

from fem.bodies.solid import clamped_leg, solid_leg
from fem.solvers.backends.petsc import client
from fem.solvers.inverse import RenewableIteration
from lumped.solver_request import RANKS_VARIABLE, VARIABLE

LEGS["383k"] = (1.0, 0.0765, 0.12, 10)
SOLVERS = ("rslab 1", "rslab 2", "petsc 1", "petsc 2", "gamg 1", "gamg 2")
ROWS = [f"{size} {solver}" for size in ("46k", "134k", "383k") for solver in SOLVERS]
HEADINGS = "row", "unknowns", "seconds", "CPU s", "GB", "rank", "all", "load", "iterations"


def row(name: str, meshes: Path) -> str:
    """A line of the table."""
    size, solver, _ = name.split()
    load = os.getloadavg()[0]
    # `clamped_leg` releases the matrices of a leg to which nothing else refers.
    solids = [solid_leg(leg_of(size), mesh_of(size, meshes))]
    if solver != "rslab":
        client.server()
    cpu, begun = cpu_seconds(), perf_counter()
    body = clamped_leg(solids.pop())
    compliance = body.compliance
    seconds, cpu = perf_counter() - begun, cpu_seconds() - cpu
    iterations = 0
    if isinstance(body.factor, RenewableIteration):
        iterations = max(check.iterations for check in body.factor.checks)
    ranks = [peak(process) for process in descendants(os.getpid())]
    figures = [seconds, cpu, peak(os.getpid()), max(ranks, default=0.0)]
    figures += [figures[2] + sum(ranks), load]
    reference = meshes / f"{size}-compliance.npy"
    if not reference.exists():
        np.save(reference, compliance)
    expected = np.load(reference)
    sizes = np.sqrt(np.diag(expected))
    difference = np.abs((compliance - expected) / np.outer(sizes, sizes)).max()
    text = "  ".join(f"{figure:8.2f}" for figure in figures)
    return f"{name:13} {body.solid.size:8} {text} {iterations:4}  {difference:.1e}"


def main() -> None:
    """Measure rows."""
    options = parsed_options(__doc__)
    if options.here:
        print(row(options.rows[0], options.meshes), flush=True)
        return
    print(HEADINGS, flush=True)
    for name in options.rows or ROWS:
        _, solver, ranks = name.split()
        threads = ranks if solver == "rslab" else "1"
        environment = {VARIABLE: solver, RANKS_VARIABLE: ranks, "OMP_NUM_THREADS": threads}
        environment["OPENBLAS_NUM_THREADS"] = "1"
        command = [sys.executable, __file__, "--here", "--meshes", str(options.meshes), name]
        subprocess.run(command, env=os.environ | environment, check=False)


if __name__ == "__main__":
    main()
