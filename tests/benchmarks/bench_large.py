"""Leg 1 in about 850k unknowns, second-order tetrahedra: compliance and 20 modes, time and memory.

    python tests/benchmarks/bench_large.py [DIVISIONS]

Two threads, from the mesh in memory to the numbers. Needs about 13 GB; the certificate needs the
extra `mkl` at this size.
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
# The equivalent leg 1 of the paper, §2.3.
LEG = constant_leg(0.85, EA=8.613e8, EIy=4.771e6, EIz=1.832e6, GJ=9.212e6, mass=69.705)
DIVISIONS = 17


def peak() -> str:
    return f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20:.1f} GiB"


def main() -> None:
    divisions = int(sys.argv[1]) if len(sys.argv) > 1 else DIVISIONS
    mesh = tetrahedra(LEG.section, LEG.length, divisions)
    print(f"{3 * len(mesh.nodes)} unknowns, {len(mesh.cells)} tet10, {THREADS} threads")
    start = perf_counter()
    clamped = clamped_leg(solid_leg(LEG, mesh))
    print(f"matrices and factor {perf_counter() - start:.1f} s, peak {peak()}")
    compliance = tip_compliance(clamped)
    print(f"and compliance {perf_counter() - start:.1f} s, diagonal {np.diag(compliance)}")
    found = modes(clamped, MODES)
    print(f"and {MODES} modes ({found.certificate}) {perf_counter() - start:.1f} s, peak {peak()}")
    print(f"{found.solves} right-hand sides; {found.frequencies} Hz")


if __name__ == "__main__":
    main()
