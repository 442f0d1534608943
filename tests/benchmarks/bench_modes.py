"""20 certified modes of a leg of about 130k unknowns: solves and count, tetrahedra and hexahedra.

python tests/benchmarks/bench_modes.py
"""

# ruff: noqa: T201  a script that prints its figures

import os

THREADS = 2
os.environ.setdefault("OMP_NUM_THREADS", str(THREADS))

import sys  # noqa: E402
from pathlib import Path  # noqa: E402
from time import perf_counter  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from fem.bodies.leg_modes import clamped_count, modes  # noqa: E402
from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh  # noqa: E402
from fem.solvers.modes import CertifiedModes  # noqa: E402
from lumped.legs import ConstantLeg, Material  # noqa: E402
from lumped.sections import Rectangle  # noqa: E402
from meshes.prism.tetrahedra import tetrahedra  # noqa: E402
from meshes.solid_mesh import SolidMesh  # noqa: E402

MODES = 20
LEG = ConstantLeg(
    0.85, Rectangle(width=0.16, height=0.26), Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
)


def measure(mesh: SolidMesh) -> CertifiedModes:
    start = perf_counter()
    clamped = clamped_leg(solid_leg(LEG, mesh))
    factorised = perf_counter()
    found = modes(clamped, MODES)
    solved = perf_counter()
    clamped_count(clamped)(found.shift)
    counted = perf_counter() - solved
    print(
        f"{mesh.element}, {3 * len(mesh.nodes)} unknowns: matrices and factor "
        f"{factorised - start:.1f} s; {MODES} modes {solved - factorised:.1f} s, of which the "
        f"count {counted:.1f} s ({found.certificate}); {found.solves} right-hand sides; largest "
        f"error of a frequency {found.frequency_errors.max():.1e}"
    )
    return found


def main() -> None:
    tetrahedral = measure(tetrahedra(LEG.section, LEG.length, 9)).frequencies
    hexahedral = measure(solid_mesh(LEG, 8)).frequencies
    print(f"largest difference of the two: {abs(tetrahedral / hexahedral - 1.0).max():.1e}")


if __name__ == "__main__":
    main()
