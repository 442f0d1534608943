"""Seconds and memory of long computations, beside other programs for the same, as one table.

    python tests/benchmarks/compare.py [--repeats N] [--list] [ROW ...]

Each measurement is a process of its own, on two threads, with an empty cache. The rows take turns,
N times (default three), and medians are printed. Rows of programs that are not installed, CalculiX
(`ccx`) or NGSolve, are omitted. A ROW is a name of the list, or its beginning.
"""

# ruff: noqa: T201, E402, PLC0415  a script that prints its figures; other programs may be missing

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
from functools import partial
from importlib.util import find_spec
from itertools import cycle, islice
from pathlib import Path
from shutil import which
from statistics import median
from time import perf_counter
from timeit import timeit

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT))

import numpy as np

from fem.bodies.doubling import condensed_leg, tip_compliance
from fem.bodies.solid import clamped_leg, solid_leg
from fem.calculix.deck import deck_text
from fem.calculix.leg import leg_deck
from fem.calculix.run import calculix_program
from fem.elasticity import on_three_components, stiffness_and_mass
from fem.solvers.certificate import count_below, pencil
from fem.solvers.modes import lowest_modes
from lumped.legs import ConstantLeg, Material
from lumped.mechanism.kinematics.postures import posture
from lumped.robot_file import load_robot
from lumped.sections import Rectangle
from lumped.system.assembly import assembly
from lumped.system.sweep import swept
from meshes.prism import tetrahedra
from meshes.section.section_mesh import section_mesh
from validation.models import reduced_parts
from validation.models.robot_bodies import dynamic_bodies
from validation.models.robot_models import highest_frequency
from validation.parts.identify import identify
from validation.run import provenance

MODES, FREQUENCIES, POSTURES, UNKNOWNS = 20, 10, 1000, 150_000
TAPERED = ROOT / "examples" / "tapered-biglide" / "robot.toml"
STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
# A leg's length and sides (m), and second-order tetrahedra across the smaller one. The factor grows
# with the section: the large leg is eight times as long as deep.
LEGS = {
    "134k": (0.85, 0.16, 0.26, 9),
    "400k": (1.0, 0.0765, 0.12, 10),
    "841k": (1.0, 0.0765, 0.12, 13),
}
# How the sentence on the models begins.
SENTENCES = ("You rely", "Within the accepted errors", "No model", "No verdict")
Figures = dict[str, float]


def _leg(size: str):
    length, width, height, divisions = LEGS[size]
    leg = ConstantLeg(length, Rectangle(width=width, height=height), STEEL)
    return leg, tetrahedra(leg.section, length, divisions)


def _matrices(size: str):
    """K and M (csr) of a leg without the nodes of its root."""
    leg, mesh = _leg(size)
    nodes = np.setdiff1d(np.arange(len(mesh.nodes)), mesh.root.nodes)
    free = np.add.outer(3 * nodes, range(3)).ravel()
    K, M = stiffness_and_mass(mesh, leg.material)
    return K[free][:, free].tocsr(), on_three_components(M)[free][:, free].tocsr()


def solid(size: str) -> Figures:
    """Six load cases and certified modes of a leg, from its mesh in memory."""
    leg, mesh = _leg(size)
    start, certifying = perf_counter(), 0.0
    clamped = clamped_leg(solid_leg(leg, mesh))
    factorised = perf_counter()
    assert np.isfinite(clamped.compliance).all()

    def timed(sigma: float):
        nonlocal certifying
        begun = perf_counter()
        clamped.factor.give_up()
        inertia = clamped.rooted_inertia(sigma)
        certifying += perf_counter() - begun
        return inertia

    lowest_modes(clamped.flexibility, clamped.solid.mass, MODES, timed, "leg")
    total = perf_counter() - start
    return {
        "s": total,
        "factor": factorised - start,
        "without certificate": total - certifying,
        "unknowns": 3 * len(mesh.nodes),
    }


def calculix(size: str) -> Figures:
    """Load cases and modes of a leg by CalculiX, with its deck written, without a certificate."""
    leg, mesh = _leg(size)
    start = perf_counter()
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "leg.inp").write_text(deck_text(leg_deck(mesh, leg.material, MODES)))
        command = [calculix_program(), "leg"]
        subprocess.run(command, cwd=folder, check=True, stdout=subprocess.DEVNULL)
    return {"s": perf_counter() - start}


def flexproof_solver(size: str) -> Figures:
    """Analysis, factor and six solutions with K, and the count of K − σM, by this program."""
    K, M = _matrices(size)
    start = perf_counter()
    matrix_pencil = pencil(K, M)
    analysed = perf_counter()
    figures = _times(start, analysed, matrix_pencil.symbolic.factorise("leg").solve, K)
    # Above the first bending modes: (rad/s)², from the beam of the leg's sides.
    length, width, _, _ = LEGS[size]
    sigma = float((3.0 * 3.516 / length**2 * np.sqrt(2.1e11 / 7850.0 / 12.0) * width) ** 2)
    begun = perf_counter()
    below = count_below(matrix_pencil, sigma).negative
    return figures | {"below": below, "count": perf_counter() - begun}


def ngsolve(size: str) -> Figures:
    """Factor and six solutions with K by NGSolve's sparse Cholesky, which counts no eigenvalues."""
    from ngsolve import SetNumThreads, TaskManager
    from ngsolve.la import BaseVector, SparseMatrixd

    K, _ = _matrices(size)
    entries = K.tocoo()
    SetNumThreads(int(os.environ["OMP_NUM_THREADS"]))
    with TaskManager():
        matrix = SparseMatrixd.CreateFromCOO(
            entries.row.tolist(), entries.col.tolist(), entries.data.tolist(), *K.shape
        )
        del entries
        start = perf_counter()
        inverse = matrix.Inverse(inverse="sparsecholesky")

        def solve(loads):
            columns = []
            for load in loads.T:
                right = BaseVector(len(load))
                right.FV().NumPy()[:] = load
                columns.append((inverse * right).Evaluate().FV().NumPy().copy())
            return np.array(columns).T

        return _times(start, start, solve, K)


def _times(start: float, analysed: float, solve, K) -> Figures:
    factorised = perf_counter()
    loads = np.random.default_rng(0).normal(size=(K.shape[0], 6))
    solutions = solve(loads)
    solved = perf_counter()
    residual = np.abs(K @ solutions - loads).max()
    assert residual < 1e-3, f"residual {residual:.1e}"
    return {
        "s": factorised - start,
        "analysis": analysed - start,
        "six loads": solved - factorised,
        "unknowns": K.shape[0],
    }


def doubled() -> Figures:
    """Condensation by doubling of a leg of 512 quadratic slices with 8 × 4 elements each."""
    leg = ConstantLeg(0.8, Rectangle(0.16, 0.08), STEEL)
    section = section_mesh(leg.section, (8, 4))
    start = perf_counter()
    tip_compliance(condensed_leg(leg, section, 512))
    return {"s": perf_counter() - start}


def postures() -> Figures:
    """Statics and frequencies of the hexapod of beams in 1000 postures, on one thread."""
    mechanism = load_robot("hexapod").mechanism
    poses = [posture(mechanism, pose) for pose in mechanism.poses]
    start = perf_counter()
    bodies = dynamic_bodies("beam", mechanism, highest_frequency(poses, FREQUENCIES))
    swept(assembly(mechanism, bodies), list(islice(cycle(poses), POSTURES)), FREQUENCIES)
    return {"s": perf_counter() - start}


def identified() -> Figures:
    """Identification of a CAD part: compliances, mass, clamped frequencies, and half-widths."""
    body = load_robot(TAPERED).mechanism.bodies["leg1"]
    start = perf_counter()
    result = identify(
        *reduced_parts.found_in(body), reduced_parts.shape_of(body).material, UNKNOWNS
    )
    return {"s": perf_counter() - start, "unknowns": result.unknowns[-1]}


def command(*words: str) -> Figures:
    """Time of a command and, for `run`, until its first line about the models is printed."""
    program = [str(ROOT / "flexproof"), *words]
    with tempfile.TemporaryDirectory() as folder:
        out = ["--out", f"{folder}/out"] if words[0] == "run" else []
        start = perf_counter()
        with subprocess.Popen(
            [*program, *out], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        ) as process:
            seconds_to_verdict = None
            for line in process.stdout or ():
                if seconds_to_verdict is None and any(begun in line for begun in SENTENCES):
                    seconds_to_verdict = perf_counter() - start
        seconds = perf_counter() - start
    assert process.returncode in {0, 1}, process.returncode
    return {"s": seconds} | (
        {"verdict": seconds_to_verdict} if seconds_to_verdict is not None else {}
    )


# What is measured by name, and what its program is found by where it may be missing.
ROWS = {
    "doubling 512 slices": doubled,
    "solid 134k": partial(solid, "134k"),
    "solid 134k, CalculiX": partial(calculix, "134k"),
    "solid 841k": partial(solid, "841k"),
    "postures": postures,
    "identify 150k": identified,
}
for _size in LEGS:
    ROWS[f"factor {_size}"] = partial(flexproof_solver, _size)
    ROWS[f"factor {_size}, NGSolve"] = partial(ngsolve, _size)
for _typed in (
    "--help",
    "solve five-bar --model beam",
    "solve hexapod --model solid --modes 10",
    "run ifw --preset quick",
    "run ifw --preset standard",
    f"run {TAPERED.relative_to(ROOT)} --preset standard",
):
    ROWS[f"flexproof {_typed}"] = partial(command, *_typed.split())
INSTALLED = {
    "CalculiX": which("ccx"),
    "NGSolve": find_spec("ngsolve"),
}


def measured(name: str) -> Figures:
    """Figures of a row in a process of its own, with its memory (GiB). Empty if it fails."""
    with tempfile.TemporaryDirectory() as home:
        threads = "1" if name == "postures" else "2"
        completed = subprocess.run(
            [sys.executable, __file__, "--one", name],
            cwd=ROOT,
            env=os.environ | {"OMP_NUM_THREADS": threads, "XDG_CACHE_HOME": home},
            capture_output=True,
            text=True,
            check=False,
        )
    if completed.returncode:
        last = (completed.stderr.strip().splitlines() or ["nothing"])[-1]
        print(f"{name}: failed, exit code {completed.returncode}: {last}", file=sys.stderr)
        return {}
    return dict(json.loads(completed.stdout.splitlines()[-1]))


def machine() -> str:
    """Machine, speed (GFLOP/s) of a matrix product by numpy on it, and linear solver."""
    n = 1500
    dense = np.random.default_rng(0).normal(size=(n, n))
    _ = dense @ dense
    speed = 10.0 * n**3 / timeit(lambda: dense @ dense, number=5) / 1e9
    used = provenance.versions()
    return (
        f"{provenance.machine()}, Python {used['python']}; dgemm {speed:.0f} GFLOP/s by numpy; "
        f"{used['linear solver']}"
    )


def main() -> None:
    """Measure the specified rows, by default all, and print the table."""
    reader = argparse.ArgumentParser(description=__doc__)
    reader.add_argument("rows", nargs="*", default=[""])
    reader.add_argument("--repeats", type=int, default=3)
    reader.add_argument("--list", action="store_true")
    reader.add_argument("--one")
    options = reader.parse_args()
    if options.one:
        figures = ROWS[options.one]()
        processes = (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
        peak = max(resource.getrusage(who).ru_maxrss for who in processes) / 2**20
        print(json.dumps(figures | {"GiB": peak}))
        return
    available = [name for name in ROWS if INSTALLED.get(name.partition(", ")[2], True)]
    selected = [name for name in available if name.startswith(tuple(options.rows))]
    if options.list:
        print("\n".join(selected))
        return
    print(machine(), end="\n\n")
    turns = [{name: measured(name) for name in selected} for _ in range(options.repeats)]
    print("| what | s | GiB | of it |\n|---|---|---|---|")
    for name in selected:
        if not (finished := [turn[name] for turn in turns if turn[name]]):
            continue
        middle = {key: median(figures[key] for figures in finished) for key in finished[0]}
        seconds, memory = (middle.pop(key) for key in ("s", "GiB"))
        of_it = ", ".join(f"{key} {value:.4g}" for key, value in middle.items())
        print(f"| {name} | {seconds:.2f} | {memory:.2f} | {of_it} |", flush=True)


if __name__ == "__main__":
    main()
