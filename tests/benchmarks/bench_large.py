"""Leg 2 in about 850k unknowns, second-order tetrahedra: compliance and 20 modes, time and memory.

    python tests/benchmarks/bench_large.py [DIVISIONS]

Two threads, from the mesh in memory to the numbers. The peak is that of the whole process, the
mesh generator included. The factor gives its memory to the certificate; this takes PARDISO where
the extra `mkl` is installed.
"""

# ruff: noqa: T201  a script that prints its figures

import os

THREADS = 2
os.environ.setdefault("OMP_NUM_THREADS", str(THREADS))

import resource  # noqa: E402
import sys  # noqa: E402
from pathlib import Path  # noqa: E402
from time import perf_counter  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import numpy as np  # noqa: E402

from fem.solid import clamped_leg, modes, solid_leg, tip_compliance  # noqa: E402
from lumped.legs import constant_leg  # noqa: E402
from meshes.tetrahedra import tetrahedra  # noqa: E402

MODES = 20
# The equivalent leg 2 of the paper, §2.3.
LEG = constant_leg(0.775, EA=4.316e9, EIy=5.980e7, EIz=4.182e6, GJ=6.478e6, mass=49.366)
DIVISIONS = 12


def peak() -> str:
    return f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20:.1f} GiB"


def main() -> None:
    divisions = int(sys.argv[1]) if len(sys.argv) > 1 else DIVISIONS
    mesh = tetrahedra(LEG.section, LEG.length, divisions)
    print(
        f"{3 * len(mesh.nodes)} unknowns, {len(mesh.cells)} tet10, {THREADS} threads, "
        f"peak {peak()}, load {os.getloadavg()[0]:.1f}"
    )
    start = perf_counter()
    clamped = clamped_leg(solid_leg(LEG, mesh))
    needed = clamped.factor.symbolic.peak_bytes / 2**30
    print(
        f"matrices and factor {perf_counter() - start:.1f} s, peak {peak()}; foretold for the "
        f"factor and its matrix: {needed:.1f} GiB"
    )
    compliance = tip_compliance(clamped)
    print(f"and compliance {perf_counter() - start:.1f} s, diagonal {np.diag(compliance)}")
    found = modes(clamped, MODES)
    print(f"and {MODES} modes ({found.certificate}) {perf_counter() - start:.1f} s, peak {peak()}")
    print(f"{found.solves} right-hand sides; {found.frequencies} Hz")


if __name__ == "__main__":
    main()
