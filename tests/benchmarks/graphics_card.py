"""Seconds and memory of large solids on a graphics card, beside the processor, as one table.

    python tests/benchmarks/graphics_card.py [--meshes FOLDER] [--out FOLDER] [ROW ...]

Each row is a process of its own. A mesh is read from the folder of --meshes if it is there,
otherwise made by gmsh and kept there. Each finished row is written to rows.json in the folder of
--out.
"""

# ruff: noqa: T201, E402  a script that prints its figures

import argparse
import json
import os
import resource
import subprocess
import sys
from collections import defaultdict
from functools import wraps
from pathlib import Path
from time import perf_counter

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

import numpy as np

from fem.bodies.solid import clamped_leg, solid_leg
from fem.solvers.backends import cudss
from fem.solvers.backends.choice import solver_name
from fem.solvers.backends.cudss import CudssOrdering
from fem.solvers.backends.rslab import RslabNumeric, RslabOrdering
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle
from lumped.solver_request import VARIABLE
from meshes.prism import tetrahedra
from meshes.section.section_mesh import SectionMesh
from meshes.solid_mesh import EndFace, SolidMesh
from validation.run import provenance

MODES = 20
STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
# Length and sides (m), and second-order tetrahedra across the smaller side.
LEGS = {
    "9k": (0.85, 0.16, 0.26, 3),
    "18k": (0.85, 0.16, 0.26, 4),
    "30k": (0.85, 0.16, 0.26, 5),
    "134k": (0.85, 0.16, 0.26, 9),
    "841k": (1.0, 0.0765, 0.12, 13),
    "2.5M": (1.0, 0.0765, 0.12, 19),
}
ROWS = [
    *(f"{size} cudss" for size in ("134k", "841k", "2.5M")),
    "134k rslab",
    *(f"{size} {solver}" for size in ("9k", "18k", "30k") for solver in ("cudss", "rslab")),
]
Figures = dict[str, object]


def leg_of(size: str) -> ConstantLeg:
    """A steel leg of rectangular section."""
    length, width, height, _ = LEGS[size]
    return ConstantLeg(length, Rectangle(width=width, height=height), STEEL)


def mesh_of(size: str, folder: Path) -> SolidMesh:
    """The leg's mesh, from the folder or by gmsh."""
    path = folder / f"{size}.npz"
    if not path.exists():
        leg, divisions = leg_of(size), LEGS[size][3]
        write_mesh(path, tetrahedra(leg.section, leg.length, divisions))
    with np.load(path) as arrays:
        faces = (
            EndFace(
                arrays[f"{end}"],
                SectionMesh(arrays[f"{end}_nodes"], arrays[f"{end}_cells"], "tri6"),
            )
            for end in ("root", "tip")
        )
        return SolidMesh(arrays["nodes"], arrays["cells"], "tet10", *faces, slices=None)


def write_mesh(path: Path, mesh: SolidMesh) -> None:
    """Arrays of a mesh as .npz."""
    path.parent.mkdir(parents=True, exist_ok=True)
    ends = {
        f"{name}{suffix}": array
        for name, end in (("root", mesh.root), ("tip", mesh.tip))
        for suffix, array in (
            ("", end.nodes),
            ("_nodes", end.mesh.nodes),
            ("_cells", end.mesh.cells),
        )
    }
    np.savez(path, nodes=mesh.nodes, cells=mesh.cells, **ends)


class Phases:
    """Seconds of each phase of the solver library, by timing the calls of its functions."""

    def __init__(self) -> None:
        self.seconds: dict[str, list[float]] = defaultdict(list)
        self.used = 0
        self._time(CudssOrdering, "_execute", lambda _, phase, *__: f"cudss {int(phase)}")
        self._time(RslabOrdering, "__init__", lambda *_: "ordering")
        self._time(RslabOrdering, "factorise", lambda *_: "factor")
        self._time(RslabNumeric, "solve", lambda _, columns: f"solve {columns.shape[1]}")

    def _time(self, owner, name, label):
        function = getattr(owner, name)

        @wraps(function)
        def timed(*arguments):
            begun = perf_counter()
            value = function(*arguments)
            if owner is CudssOrdering:
                import cupy  # noqa: PLC0415

                cupy.cuda.Device().synchronize()
                free, total = cupy.cuda.runtime.memGetInfo()
                self.used = max(self.used, total - free)
            key = label(*arguments)
            if owner is CudssOrdering:
                names = {"3": "ordering", "4": "factor", "8": "refactor"}
                key = names.get(key.split()[1], f"solve {arguments[2].shape[1]}")
            self.seconds[key].append(perf_counter() - begun)
            return value

        setattr(owner, name, timed)


def certified_leg(size: str, meshes: Path) -> Figures:
    """Six load cases and certified modes of a leg, from its mesh in memory."""
    mesh, leg, phases = mesh_of(size, meshes), leg_of(size), Phases()
    start = perf_counter()
    on_card = os.environ[VARIABLE] == "cudss"
    if on_card:
        cudss.device()
        cudss._handle()
    begun = perf_counter()
    solid = solid_leg(leg, mesh)
    assembled = perf_counter()
    clamped = clamped_leg(solid)
    del solid
    factorised = perf_counter()
    compliance = clamped.compliance
    solved = perf_counter()
    modes = clamped.modes(MODES)
    done = perf_counter()
    timed = {name: [round(seconds, 4) for seconds in all_] for name, all_ in phases.seconds.items()}
    repeated = clamped.modes(MODES) if size != "2.5M" and on_card else modes
    loads = np.random.default_rng(3).standard_normal((clamped.solid.size, 8))
    block = clamped.factor.solve(loads)
    triangle = clamped.pencil.symbolic.triangle
    product = triangle @ block + triangle.T @ block - triangle.diagonal()[:, None] * block
    size_of_sums = np.abs(triangle.data).max() * np.abs(block).max() + np.abs(loads).max()
    return {
        "unknowns": 3 * len(mesh.nodes),
        "start of card": begun - start,
        "total": done - begun,
        "assembly": assembled - begun,
        "coupling, ordering, factor": factorised - assembled,
        "six loads": solved - factorised,
        "modes and proof": done - solved,
        "backward error": float(np.abs(product - loads).max() / size_of_sums),
        "GB on card": phases.used / 1e9,
        "phases": timed,
        "repeated with equal bits": bool((repeated.shapes == modes.shapes).all()),
        "frequency errors": float(modes.frequency_errors.max()),
        "count": modes.count,
        "frequencies": modes.frequencies.tolist(),
        "compliance": compliance.ravel().tolist(),
        "solver": solver_name(),
    }


def measured(row: str, meshes: Path) -> Figures:
    """Figures of a row in a process of its own, with its largest memory (GiB)."""
    solver = row.split()[1]
    begun = perf_counter()
    completed = subprocess.run(
        [sys.executable, __file__, "--meshes", str(meshes), "--one", row],
        cwd=ROOT,
        env=os.environ | {VARIABLE: solver, "OPENBLAS_NUM_THREADS": "1"},
        capture_output=True,
        text=True,
        check=False,
    )
    if completed.returncode:
        return {
            "failed": (completed.stderr.strip().splitlines() or [str(completed.returncode)])[-12:]
        }
    figures = dict(json.loads(completed.stdout.splitlines()[-1]))
    return figures | {"process": perf_counter() - begun, "warnings": completed.stderr[-400:]}


def agreement(rows: dict[str, Figures]) -> dict[str, Figures]:
    """Differences in compliance, frequencies and counts between cuDSS and rslab, by mesh."""
    differences = {}
    for size in LEGS:
        pair = [rows.get(f"{size} {solver}", {}) for solver in ("cudss", "rslab")]
        if all("compliance" in figures for figures in pair):
            ours, theirs = (np.array(figures["compliance"]) for figures in pair)
            f, g = (np.array(figures["frequencies"]) for figures in pair)
            differences[size] = {
                "compliance": float(np.abs(ours - theirs).max() / np.abs(theirs).max()),
                "frequencies": float(np.abs(f / g - 1.0).max()),
                "equal counts": pair[0]["count"] == pair[1]["count"],
            }
    return differences


def main() -> None:
    """Measure the specified rows, by default all, and print the table."""
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("rows", nargs="*")
    reader.add_argument("--meshes", type=Path, default=Path("meshes-of-legs"))
    reader.add_argument("--out", type=Path, default=Path())
    reader.add_argument("--one")
    options = reader.parse_args()
    if options.one:
        figures = certified_leg(options.one.split()[0], options.meshes)
        figures["GiB"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
        print(json.dumps(figures))
        return
    card = cudss.device()
    print(f"{provenance.machine()}; {card.name if card else 'no graphics card'}")
    rows: dict[str, Figures] = {}
    for row in options.rows or ROWS:
        if row.endswith("cudss") and card is None:
            continue
        rows[row] = measured(row, options.meshes)
        summary = {
            key: round(value, 3) if isinstance(value, float) and value > 1e-3 else value
            for key, value in rows[row].items()
            if key not in {"frequencies", "compliance"}
        }
        print(f"\n{row}: {json.dumps(summary)}", flush=True)
        content = {"machine": provenance.machine(), "card": card.name if card else None}
        content |= {"rows": rows, "agreement": agreement(rows)}
        (options.out / "rows.json").write_text(json.dumps(content, indent=1))
    print(f"\ncuDSS beside rslab: {json.dumps(agreement(rows))}")


if __name__ == "__main__":
    main()
