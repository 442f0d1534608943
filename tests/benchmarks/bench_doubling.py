"""Time of a leg condensed by doubling against its number of slices, from section to 6×6.

    python tests/benchmarks/bench_doubling.py

8 × 4 quadratic elements in the section, one thread: matrices of 459 rows gain little from more.
"""

# ruff: noqa: T201, E402  a script that prints its figures and sets its threads first

import os

THREADS = 1
os.environ.setdefault("OMP_NUM_THREADS", str(THREADS))

import resource
import sys
from pathlib import Path
from time import perf_counter

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import numpy as np

from fem.bodies.doubling import condensed_leg, tip_compliance
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle
from meshes.section.section_mesh import section_mesh

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
    first = seconds(TARGET_SLICES)
    face = 3 * len(section_mesh(LEG.section, DIVISIONS).nodes)
    print(f"{face} unknowns per face, {THREADS} thread; median of {REPEATS} runs")
    print(f"{'slices':>7} {'unknowns':>10} {'s':>7}")
    for slices in [*SLICES, ALL_ONES]:
        time = float(np.median([seconds(slices) for _ in range(REPEATS)]))
        print(f"{slices:>7} {face * (2 * slices + 1):>10} {time:>7.3f}")
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(
        f"{TARGET_SLICES} slices, first run (gmsh starts): {first:.2f} s "
        f"(target {TARGET_SECONDS:g} s); peak of the process {peak:.2f} GiB "
        f"(target {TARGET_GIB:g} GiB)"
    )


if __name__ == "__main__":
    main()
