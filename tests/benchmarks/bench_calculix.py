"""One leg of about 130k unknowns, six load cases and 20 modes: this package beside CalculiX.

    python tests/benchmarks/bench_calculix.py

From the mesh in memory to the numbers, CalculiX with two threads, this package with two unless
OMP_NUM_THREADS says otherwise. CalculiX gets its deck, a step
per load case and a frequency step; writing the deck counts, since that is how one gets to its
numbers. It does not prove that no mode was missed, so the ratio is given without and with our
certificate.
"""

# ruff: noqa: T201  a script that prints its figures

import os

THREADS = 2
os.environ.setdefault("OMP_NUM_THREADS", str(THREADS))

import sys  # noqa: E402
from pathlib import Path  # noqa: E402
from time import perf_counter  # noqa: E402

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

import numpy as np  # noqa: E402

from fem.bodies.leg_modes import clamped_count  # noqa: E402
from fem.bodies.solid import clamped_leg, solid_leg, tip_compliance  # noqa: E402
from fem.calculix.leg import compliance_and_frequencies  # noqa: E402
from fem.calculix.run import CalculixMissing, calculix_program  # noqa: E402
from fem.solvers.certificate.count import count_name  # noqa: E402
from fem.solvers.certificate.sturm import Inertia  # noqa: E402
from fem.solvers.cholesky import default_backend  # noqa: E402
from fem.solvers.modes import lowest_modes  # noqa: E402
from lumped.legs import ConstantLeg, Material  # noqa: E402
from lumped.sections import Rectangle  # noqa: E402
from meshes.prism.tetrahedra import tetrahedra  # noqa: E402

MODES = 20
TARGET = 10.0
LEG = ConstantLeg(
    0.85, Rectangle(width=0.16, height=0.26), Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
)
DIVISIONS = 9


def main() -> None:
    try:
        calculix_program()
    except CalculixMissing as missing:
        sys.exit(str(missing))
    mesh = tetrahedra(LEG.section, LEG.length, DIVISIONS)
    print(
        f"{3 * len(mesh.nodes)} unknowns, {len(mesh.cells)} tet10; threads: CalculiX {THREADS}, "
        f"flexproof {os.environ['OMP_NUM_THREADS']}; load {os.getloadavg()[0]:.1f}"
    )

    start = perf_counter()
    solid = solid_leg(LEG, mesh)
    assembled = perf_counter()
    clamped = clamped_leg(solid)
    factorised = perf_counter()
    compliance = tip_compliance(clamped)
    solved = perf_counter()
    certifying = 0.0
    count = clamped_count(clamped)

    def timed(sigma: float) -> Inertia:
        nonlocal certifying
        begun = perf_counter()
        inertia = count(sigma)
        certifying += perf_counter() - begun
        return inertia

    found = lowest_modes(clamped.factor, clamped.mass, MODES, timed, "leg")
    frequencies = found.frequencies
    whole = perf_counter() - start
    ours = whole - certifying
    print(
        f"flexproof ({default_backend()}): {ours:.1f} s = assembly {assembled - start:.1f}, "
        f"ends and factor {factorised - assembled:.1f}, six load cases {solved - factorised:.1f}, "
        f"{MODES} modes {start + ours - solved:.1f}; certificate {certifying:.1f} s beside it "
        f"({count_name(default_backend())})"
    )

    start = perf_counter()
    theirs, their_frequencies = compliance_and_frequencies(
        mesh, LEG.material, MODES, threads=THREADS, timeout=1200.0
    )
    calculix = perf_counter() - start
    print(f"CalculiX: {calculix:.1f} s; load {os.getloadavg()[0]:.1f}")

    scale = np.sqrt(np.diag(compliance))
    off = np.abs((theirs - compliance) / np.outer(scale, scale)).max()
    detuned = np.abs(their_frequencies / frequencies - 1.0).max()
    print(
        f"largest difference: compliance {off:.1e}, frequencies {detuned:.1e} "
        "(CalculiX sums the mass over four points, ours is exact)"
    )
    print(
        f"ratio {calculix / ours:.1f} (target {TARGET:g}), with the certificate "
        f"{calculix / whole:.1f}"
    )


if __name__ == "__main__":
    main()
