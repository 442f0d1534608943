"""Time of a leg condensed by doubling against its number of slices, from section to 6×6.

    python tests/benchmarks/bench_doubling.py [PLOT]

8 × 4 quadratic elements in the section, one thread: matrices of 459 rows gain little from more.
PLOT is the file for the plot of time over slices, without it `doubling.svg` in the system's folder
for temporary files.
"""

# ruff: noqa: T201  a script that prints its figures

import os

THREADS = 1
os.environ.setdefault("OMP_NUM_THREADS", str(THREADS))

import resource  # noqa: E402
import sys  # noqa: E402
import tempfile  # noqa: E402
from pathlib import Path  # noqa: E402
from time import perf_counter  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import matplotlib as mpl  # noqa: E402

mpl.use("Agg")

import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402

from fem.bodies.doubling import condensed_leg, tip_compliance  # noqa: E402
from lumped.legs import ConstantLeg, Material  # noqa: E402
from lumped.sections import Rectangle  # noqa: E402
from meshes.section.section_mesh import section_mesh  # noqa: E402

LEG = ConstantLeg(0.8, Rectangle(0.16, 0.08), Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0))
DIVISIONS = (8, 4)
SLICES = [2**power for power in range(1, 13)]
REPEATS = 5
# The slowest count between two powers of two: a slice joined after every doubling.
ALL_ONES = 511
TARGET_SECONDS, TARGET_GIB, TARGET_SLICES = 2.0, 1.0, 512


def seconds(slices: int) -> float:
    """From the section's shape to the compliance with rigid ends."""
    start = perf_counter()
    tip_compliance(condensed_leg(LEG, section_mesh(LEG.section, DIVISIONS), slices))
    return perf_counter() - start


def main() -> None:
    plot = Path(sys.argv[1] if len(sys.argv) > 1 else Path(tempfile.gettempdir()) / "doubling.svg")
    first = seconds(TARGET_SLICES)
    face = 3 * len(section_mesh(LEG.section, DIVISIONS).nodes)
    print(f"{face} unknowns per face, {THREADS} thread; median of {REPEATS} runs")
    print(f"{'slices':>7} {'unknowns':>10} {'s':>7}")
    times = []
    for slices in [*SLICES, ALL_ONES]:
        times.append(float(np.median([seconds(slices) for _ in range(REPEATS)])))
        print(f"{slices:>7} {face * (2 * slices + 1):>10} {times[-1]:>7.3f}")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(
        f"{TARGET_SLICES} slices, first run (gmsh starts): {first:.2f} s "
        f"(target {TARGET_SECONDS:g} s); peak of the process {peak:.2f} GiB "
        f"(target {TARGET_GIB:g} GiB)"
    )

    figure, axes = plt.subplots(figsize=(6.0, 4.0), layout="constrained")
    axes.plot(SLICES, times[: len(SLICES)], "o-", label="powers of two")
    axes.plot([ALL_ONES], times[-1:], "s", label=f"{ALL_ONES}, a joint after every doubling")
    axes.set_xscale("log", base=2)
    axes.set_ylim(bottom=0.0)
    axes.set_xlabel("slices n")
    axes.set_ylabel("time (s), straight in log n")
    axes.set_title(f"Condensation by doubling, {face} unknowns per face")
    axes.legend()
    figure.savefig(plot)
    print(f"plot: {plot}")


if __name__ == "__main__":
    main()
