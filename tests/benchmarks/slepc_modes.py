"""CPU seconds for 20 modes of a clamped solid leg: block Lanczos over MUMPS, and SLEPc.

    python tests/benchmarks/slepc_modes.py [--meshes FOLDER] [SIZE ...]

Both order and factorise K by MUMPS on one rank. SLEPc (Krylov–Schur, shift-and-invert at zero) runs
in the Python of `--solver petsc`, which needs Debian's python3-slepc4py. No modes are counted. The
seconds of block Lanczos contain the checks of the factor.
"""

# ruff: noqa: T201, PLC0415  a script that prints its figures, in two Pythons

import argparse
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import process_time

import numpy as np

ROOT = Path(__file__).resolve().parents[2]
MODES, TOLERANCE = 20, 1e-9
_DEBIAN = "usr/lib/{0}dir/{0}*/*-real/lib/python3/dist-packages"


def by_slepc(path: Path) -> None:
    """Print the CPU seconds and the first and last frequency of SLEPc."""
    for library in ("petsc", "slepc"):
        sys.path.extend(map(str, Path("/").glob(_DEBIAN.format(library))))
    import slepc4py

    slepc4py.init(["benchmark", "-st_mat_mumps_icntl_7", "5"])
    from petsc4py import PETSc
    from slepc4py import SLEPc

    arrays = np.load(path)
    matrices = []
    for name in "KM":
        offsets, columns, values = (arrays[f"{name}{kind}"] for kind in ("p", "i", "x"))
        size = len(offsets) - 1
        matrix = PETSc.Mat().createSBAIJ((size, size), 1, csr=(offsets, columns, values))
        matrices.append(matrix)
    begun = process_time()
    problem = SLEPc.EPS().create()
    problem.setOperators(*matrices)
    problem.setProblemType(SLEPc.EPS.ProblemType.GHEP)
    problem.setDimensions(MODES)
    problem.setTolerances(TOLERANCE)
    problem.setWhichEigenpairs(SLEPc.EPS.Which.TARGET_MAGNITUDE)
    problem.setTarget(0.0)
    transformation = problem.getST()
    transformation.setType("sinvert")
    transformation.getKSP().setType("preonly")
    transformation.getKSP().getPC().setType("cholesky")
    transformation.getKSP().getPC().setFactorSolverType("mumps")
    transformation.setFromOptions()
    problem.solve()
    seconds = process_time() - begun
    values = np.array([problem.getEigenvalue(k).real for k in (0, MODES - 1)])
    print(f"SLEPc          {seconds:8.2f}  {np.sqrt(values) / (2.0 * np.pi)}")


def compare(size: str, meshes: Path) -> None:
    """Print the lines of block Lanczos and of SLEPc for a leg."""
    sys.path[:0] = [str(ROOT), str(Path(__file__).parent)]
    import mumps

    from fem.bodies.solid import solid_leg
    from fem.solvers.backends.petsc import client
    from fem.solvers.factor import analyse, upper_triangle
    from fem.solvers.modes import searched_modes
    from lumped.solver_request import VARIABLE, petsc_python

    os.environ[VARIABLE] = "petsc"
    solid = solid_leg(mumps.leg_of(size), mumps.mesh_of(size, meshes))
    fixed = np.add.outer(3 * solid.mesh.root.nodes, range(3)).ravel()
    free = np.setdiff1d(np.arange(solid.stiffness.shape[0]), fixed)
    K, M = solid.stiffness[free][:, free], solid.mass[free][:, free]
    client.server()
    begun = mumps.cpu_seconds()
    factor = analyse(K).factorise()
    modes = searched_modes(factor.solve, M, MODES, size)
    seconds = mumps.cpu_seconds() - begun
    print(f"{size}, {len(free)} unknowns")
    print(f"block Lanczos  {seconds:8.2f}  {modes.frequencies[[0, -1]]}", flush=True)
    with TemporaryDirectory() as folder:
        path, arrays = Path(folder) / "pencil.npz", {}
        for name, matrix in (("K", K), ("M", M)):
            upper = upper_triangle(matrix)
            arrays |= {f"{name}p": upper.indptr, f"{name}i": upper.indices, f"{name}x": upper.data}
        np.savez(path, **arrays)
        command = [petsc_python(), __file__, "--slepc", str(path)]
        one_thread = {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
        subprocess.run(command, env=os.environ | one_thread, check=False)


def main() -> None:
    """Compare, or compute by SLEPc in the other Python."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sizes", nargs="*", default=["46k"])
    parser.add_argument("--meshes", type=Path, default=ROOT / "build" / "meshes")
    parser.add_argument("--slepc", type=Path, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.slepc:
        by_slepc(options.slepc)
        return
    for size in options.sizes:
        compare(size, options.meshes)


if __name__ == "__main__":
    main()
