"""A leg of about 850k unknowns, second-order tetrahedra: compliance and 20 modes, time and memory.

    python tests/benchmarks/bench_large.py [DIVISIONS]

Two threads, from the mesh in memory to the numbers, with the certificate of the modes and without
extras. The peak is that of the whole process, the mesh generator included.
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

from fem.bodies.leg_modes import modes  # noqa: E402
from fem.bodies.solid import clamped_leg, solid_leg, tip_compliance  # noqa: E402
from lumped.legs import ConstantLeg, Material  # noqa: E402
from lumped.sections import Rectangle  # noqa: E402
from meshes.prism.tetrahedra import tetrahedra  # noqa: E402

MODES = 20
TARGET_SECONDS, TARGET_GIB = 240.0, 13.0
# Eight times as long as deep. The factor grows with the section: as many unknowns in the paper's
# equivalent leg 2, which is not twice as long as deep, take 15 GiB.
LEG = ConstantLeg(
    1.0, Rectangle(width=0.0765, height=0.12), Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
)
DIVISIONS = 13


def peak() -> str:
    return f"{resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20:.2f} GiB"


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
    print(
        f"and {MODES} modes ({found.certificate}) {perf_counter() - start:.1f} s, peak {peak()} "
        f"(targets {TARGET_SECONDS:g} s, {TARGET_GIB:g} GiB)"
    )
    print(f"{found.solves} right-hand sides; {found.frequencies} Hz")


if __name__ == "__main__":
    main()
