"""Seconds and memory of what takes long, beside other programs that do the same, as one table.

    python tests/benchmarks/compare.py [--repeats N] [--list] [ROW ...]

Each measurement is a process of its own, on two threads, with nothing kept by an earlier one. The
rows take turns, N times (three unless told), and medians are printed. What is not installed is left
out: CalculiX (`ccx`), NGSolve, MKL (pypardiso). A ROW is a name of the list, or how it begins.
"""

# ruff: noqa: T201, E402, PLC0415  a script that prints its figures; each imports what it measures

import argparse
import json
import os
import platform
import resource
import subprocess
import sys
import tempfile
from collections import defaultdict
from collections.abc import Callable
from functools import partial
from importlib.util import find_spec
from itertools import cycle, islice
from pathlib import Path
from shutil import which
from statistics import median
from time import perf_counter
from typing import Any

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

import numpy as np
from scipy.sparse import csr_array, triu

MODES, FREQUENCIES, POSTURES, UNKNOWNS = 20, 10, 1000, 150_000
TAPERED = ROOT / "examples" / "tapered-biglide" / "robot.toml"
# A leg's length and sides (m), and second-order tetrahedra across the smaller one. The factor grows
# with the section: the large leg is eight times as long as deep.
LEGS = {
    "134k": (0.85, 0.16, 0.26, 9),
    "400k": (1.0, 0.0765, 0.12, 10),
    "841k": (1.0, 0.0765, 0.12, 13),
}
# How the sentence on the models begins.
SENTENCES = ("You rely", "For your limits", "No model")
Figures = dict[str, float]


def _leg(size: str) -> tuple[Any, Any]:
    from lumped.legs import ConstantLeg, Material
    from lumped.sections import Rectangle
    from meshes.prism.tetrahedra import tetrahedra

    length, width, height, divisions = LEGS[size]
    steel = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
    leg = ConstantLeg(length, Rectangle(width=width, height=height), steel)
    return leg, tetrahedra(leg.section, length, divisions)


def _matrices(size: str) -> tuple[Any, Any, Any]:
    """K and M (csr 3n×3n) of a leg whose root is held, and its free nodes (n×3, m)."""
    from fem.elements.elasticity import on_three_components, stiffness_and_mass

    leg, mesh = _leg(size)
    nodes = np.setdiff1d(np.arange(len(mesh.nodes)), mesh.root.nodes)
    free = np.add.outer(3 * nodes, range(3)).ravel()
    K, M = stiffness_and_mass(mesh, leg.material)
    M = on_three_components(M)
    return K[free][:, free].tocsr(), M[free][:, free].tocsr(), mesh.nodes[nodes]


def solid(size: str) -> Figures:
    """Six load cases and certified modes of a leg, from its mesh in memory."""
    from fem.bodies.solid import clamped_leg, solid_leg
    from fem.solvers.factor import Inertia
    from fem.solvers.modes import lowest_modes

    leg, mesh = _leg(size)
    start, certifying = perf_counter(), 0.0
    clamped = clamped_leg(solid_leg(leg, mesh))
    factorised = perf_counter()
    assert np.isfinite(clamped.compliance).all()
    count = clamped.rooted_inertia

    def timed(sigma: float) -> Inertia:
        nonlocal certifying
        begun = perf_counter()
        inertia = count(sigma)
        certifying += perf_counter() - begun
        return inertia

    lowest_modes(clamped.factor, clamped.rooted_mass(), MODES, timed, "leg")
    whole = perf_counter() - start
    return {
        "s": whole,
        "factor": factorised - start,
        "without certificate": whole - certifying,
        "unknowns": 3 * len(mesh.nodes),
    }


def calculix(size: str) -> Figures:
    """The same by CalculiX, which certifies nothing; writing its deck counts."""
    from fem.calculix.deck import deck_text
    from fem.calculix.leg import leg_deck
    from fem.calculix.run import calculix_program

    leg, mesh = _leg(size)
    start = perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "leg.inp").write_text(deck_text(leg_deck(mesh, leg.material, MODES)))
        subprocess.run(
            [calculix_program(), "leg"], cwd=folder, check=True, stdout=subprocess.DEVNULL
        )
    return {"s": perf_counter() - start}


def own(size: str) -> Figures:
    """Analysis, factor and six solutions with K, and the count of K − σM, by our own way."""
    from fem.solvers.certificate import count_below
    from fem.solvers.factor import analyse

    K, M, _ = _matrices(size)
    start = perf_counter()
    symbolic = analyse(K)
    analysed = perf_counter()
    factor = symbolic.factorise("leg")
    return _times(
        start, analysed, factor.solve, K, lambda: count_below(K, M, _sigma(size)).negative
    )


def mkl(size: str) -> Figures:
    """The same by MKL PARDISO's LLᵀ, without the count."""
    from pypardiso import PyPardisoSolver  # type: ignore[import-not-found]

    K, *_ = _matrices(size)
    triangle = csr_array(triu(K))
    solver = PyPardisoSolver(mtype=2)

    def call(phase: int, loads: Any) -> Any:
        solver.set_phase(phase)
        return np.asarray(solver._call_pardiso(triangle, np.asfortranarray(loads)))

    start = perf_counter()
    call(11, np.zeros((K.shape[0], 1)))
    analysed = perf_counter()
    call(22, np.zeros((K.shape[0], 1)))
    return _times(start, analysed, lambda loads: call(33, loads), K, None)


def ngsolve(size: str) -> Figures:
    """The same by NGSolve's sparse Cholesky, which has no count."""
    from ngsolve import SetNumThreads, TaskManager  # type: ignore[import-not-found]
    from ngsolve.la import BaseVector, SparseMatrixd  # type: ignore[import-not-found]

    K, *_ = _matrices(size)
    entries = K.tocoo()
    SetNumThreads(int(os.environ["OMP_NUM_THREADS"]))
    with TaskManager():
        matrix = SparseMatrixd.CreateFromCOO(
            entries.row.tolist(), entries.col.tolist(), entries.data.tolist(), *K.shape
        )
        del entries
        start = perf_counter()
        inverse = matrix.Inverse(inverse="sparsecholesky")

        def solve(loads: Any) -> Any:
            columns = []
            for load in loads.T:
                right = BaseVector(len(load))
                right.FV().NumPy()[:] = load
                columns.append((inverse * right).Evaluate().FV().NumPy().copy())
            return np.array(columns).T

        return _times(start, start, solve, K, None)


def _sigma(size: str) -> float:
    """Above the first bending modes: (rad/s)², from the beam of the leg's sides."""
    length, width, _, _ = LEGS[size]
    return float((3.0 * 3.516 / length**2 * np.sqrt(2.1e11 / 7850.0 / 12.0) * width) ** 2)


def _times(
    start: float, analysed: float, solve: Any, K: Any, count: Callable[[], int] | None
) -> Figures:
    factorised = perf_counter()
    loads = np.random.default_rng(0).normal(size=(K.shape[0], 6))
    found = solve(loads)
    solved = perf_counter()
    off = np.abs(K @ found - loads).max()
    assert off < 1e-3, f"residual {off:.1e}"
    figures = {
        "s": factorised - start,
        "analysis": analysed - start,
        "six loads": solved - factorised,
    }
    if count is not None:
        begun = perf_counter()
        figures["below"] = count()
        figures["count"] = perf_counter() - begun
    return figures | {"unknowns": K.shape[0]}


def doubled() -> Figures:
    """A leg of 512 quadratic slices, 8 × 4 elements in the section, condensed by doubling."""
    from fem.bodies.doubling import condensed_leg, tip_compliance
    from lumped.legs import ConstantLeg, Material
    from lumped.sections import Rectangle
    from meshes.section.section_mesh import section_mesh

    steel = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
    leg = ConstantLeg(0.8, Rectangle(0.16, 0.08), steel)
    section = section_mesh(leg.section, (8, 4))
    start = perf_counter()
    tip_compliance(condensed_leg(leg, section, 512))
    return {"s": perf_counter() - start}


def postures() -> Figures:
    """Statics and frequencies of the hexapod of beams in so many postures, on one thread."""
    from lumped.mechanism.kinematics.postures import posture
    from lumped.robot_file import load_robot
    from lumped.system.assembly import assembly
    from lumped.system.sweep import swept
    from validation.models.mechanism import dynamic_bodies, highest_frequency

    mechanism = load_robot("hexapod").mechanism
    poses = [posture(mechanism, pose) for pose in mechanism.poses]
    start = perf_counter()
    bodies = dynamic_bodies("beam", mechanism, highest_frequency(poses, FREQUENCIES))
    swept(assembly(mechanism, bodies), list(islice(cycle(poses), POSTURES)), FREQUENCIES)
    return {"s": perf_counter() - start}


def identified() -> Figures:
    """A CAD part identified: six compliances, mass, clamped frequencies, with their intervals."""
    from lumped.robot_file import load_robot
    from validation.models import parts
    from validation.parts.identify import identify

    body = load_robot(TAPERED).mechanism.bodies["leg1"]
    start = perf_counter()
    found = identify(*parts.found_in(body), parts.shape_of(body).material, UNKNOWNS)
    return {"s": perf_counter() - start, "unknowns": found.unknowns}


def command(*words: str) -> Figures:
    """A command as it is typed, and for `run` when its first line about the models is printed."""
    program = [str(ROOT / "flexproof"), *words]
    with tempfile.TemporaryDirectory() as folder:
        out = ["--out", f"{folder}/out"] if words[0] == "run" else []
        start = perf_counter()
        with subprocess.Popen(
            [*program, *out], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        ) as process:
            told = None
            for line in process.stdout or ():
                if told is None and any(begun in line for begun in SENTENCES):
                    told = perf_counter() - start
        seconds = perf_counter() - start
    assert process.returncode in {0, 1}, process.returncode
    return {"s": seconds} | ({"verdict": told} if told is not None else {})


def rows() -> dict[str, tuple[Callable[[], Figures], bool]]:
    """What is measured by name, and whether its program is installed."""
    table: dict[str, tuple[Callable[[], Figures], bool]] = {
        "doubling 512 slices": (doubled, True),
        "solid 134k": (partial(solid, "134k"), True),
        "solid 134k, CalculiX": (partial(calculix, "134k"), which("ccx") is not None),
        "solid 841k": (partial(solid, "841k"), True),
        "postures": (postures, True),
        "identify 150k": (identified, True),
    }
    for size in LEGS:
        table |= {
            f"factor {size}": (partial(own, size), True),
            f"factor {size}, MKL": (partial(mkl, size), find_spec("pypardiso") is not None),
            f"factor {size}, NGSolve": (partial(ngsolve, size), find_spec("ngsolve") is not None),
        }
    for words in (
        ("--help",),
        ("solve", "five-bar", "--model", "beam"),
        ("solve", "hexapod", "--model", "solid", "--modes", "10"),
        ("run", "ifw", "--preset", "quick"),
        ("run", "ifw", "--preset", "standard"),
        ("run", str(TAPERED.relative_to(ROOT)), "--preset", "standard"),
    ):
        table["flexproof " + " ".join(words)] = (partial(command, *words), True)
    return table


def measured(name: str) -> Figures:
    """The figures of one measurement in a process of its own, and its largest memory (GiB)."""
    with tempfile.TemporaryDirectory() as home:
        environment = os.environ | {
            "OMP_NUM_THREADS": "1" if name == "postures" else "2",
            "XDG_CACHE_HOME": home,
        }
        done = subprocess.run(
            [sys.executable, __file__, "--one", name],
            cwd=ROOT,
            env=environment,
            capture_output=True,
            text=True,
            check=False,
        )
    if done.returncode:
        last = (done.stderr.strip().splitlines() or ["nothing"])[-1]
        print(f"{name}: failed, exit code {done.returncode}: {last}", file=sys.stderr)
        return {}
    return dict(json.loads(done.stdout.splitlines()[-1]))


def machine() -> str:
    """Processor, cores, GFLOP/s of a product by numpy, and the solver."""
    from fem.machine import usable_cores
    from fem.solvers.factor import solver_name

    n = 1500
    dense = np.random.default_rng(0).normal(size=(n, n))
    _ = dense @ dense
    start = perf_counter()
    for _ in range(5):
        _ = dense @ dense
    speed = 10.0 * n**3 / (perf_counter() - start) / 1e9
    names = [
        line for line in Path("/proc/cpuinfo").read_text().splitlines() if "model name" in line
    ]
    return (
        f"{names[0].partition(':')[2].strip() if names else platform.machine()}, {usable_cores()} "
        f"cores, Python {platform.python_version()}; dgemm {speed:.0f} GFLOP/s by numpy; "
        f"{solver_name()}"
    )


def main() -> None:
    """Measure the rows asked for, all of them unless told, and print the table."""
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("rows", nargs="*")
    reader.add_argument("--repeats", type=int, default=3)
    reader.add_argument("--list", action="store_true")
    reader.add_argument("--one")
    told = reader.parse_args()
    table = rows()
    if told.one:
        figures = table[told.one][0]()
        processes = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        peak = max(resource.getrusage(who).ru_maxrss for who in processes) / 2**20
        print(json.dumps(figures | {"GiB": peak}))
        return
    chosen = [
        name
        for name, (_, installed) in table.items()
        if installed and (not told.rows or any(name.startswith(row) for row in told.rows))
    ]
    if told.list:
        print("\n".join(chosen))
        return
    print(machine(), end="\n\n")
    found: dict[str, list[Figures]] = defaultdict(list)
    for _ in range(told.repeats):
        for name in chosen:
            found[name].append(measured(name))
    print("| what | s | GiB | of it |\n|---|---|---|---|")
    for name, runs in found.items():
        whole = [figures for figures in runs if figures]
        if not whole:
            continue
        middle = {key: median(figures[key] for figures in whole) for key in whole[0]}
        parts = ", ".join(
            f"{key} {value:.4g}" for key, value in middle.items() if key not in {"s", "GiB"}
        )
        print(f"| {name} | {middle['s']:.2f} | {middle['GiB']:.2f} | {parts} |", flush=True)


if __name__ == "__main__":
    main()
