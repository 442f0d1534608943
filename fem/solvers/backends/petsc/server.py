"""Program that computes for the backend `petsc`, run by a Python that has petsc4py.

It imports nothing of this project, only numpy and petsc4py of the Python that runs it. It is
started as `server.py FOLDER`, once for each MPI rank. Each rank reads commands, one JSON object per
line, from the pipe `commands-RANK` in the folder. Arrays are numpy files in the same folder. Rank 0
writes the answers to standard output, one JSON object per line.
"""

import ctypes
import json
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

# Folders of petsc4py in Debian. The usual path exists only with the development package.
_DEBIAN = "usr/lib/petscdir/petsc*/*-real/lib/python3/dist-packages"
# Parameters of MUMPS for symmetric matrices: ordering by METIS, no ScaLAPACK at the root (which
# does not provide the inertia), and detection of null pivots.
_MUMPS = {7: 5, 13: 1, 24: 1}
# Parameter of MUMPS for working memory in excess of the prediction (per cent), and successive
# values.
_RELAXATION, _RELAXATIONS = 14, (30, 100, 400)
# Error numbers of MUMPS if the predicted working memory is insufficient.
_MORE_ROOM = {-8, -9, -14, -17, -20}
# Size (doubles) of the settings of a factorisation in PETSc, more than any version needs.
_SETTINGS = 64
# Length of the version text that MUMPS writes.
_VERSION = 30


class _MumpsError(Exception):
    """An error of MUMPS on all ranks, with its number and detail (INFOG(1) and INFOG(2))."""

    def __init__(self, number: int, detail: int) -> None:
        super().__init__(f"MUMPS error {number} ({detail})")
        self.number = number


class _Factor:
    """Matrix, symbolic and numeric factor of one pattern, distributed by rows over the ranks."""

    def __init__(self, petsc: Any, library: ctypes.CDLL, folder: Path, name: int) -> None:
        self._petsc, self._library, self._folder = petsc, library, folder
        communicator = petsc.COMM_WORLD
        offsets = np.load(folder / f"{name}-offsets.npy", mmap_mode="r")
        columns = np.load(folder / f"{name}-columns.npy", mmap_mode="r")
        values = np.load(folder / f"{name}-values.npy", mmap_mode="r")
        size = len(offsets) - 1
        layout = petsc.Vec().createMPI(size, comm=communicator)
        first, end = layout.getOwnershipRange()
        layout.destroy()
        self._rows, self._size = slice(first, end), size
        self._entries = slice(int(offsets[first]), int(offsets[end]))
        self._offsets = (offsets[first : end + 1] - offsets[first]).astype(petsc.IntType)
        self._columns = columns[self._entries].astype(petsc.IntType)
        shape = (end - first, size)
        pattern = self._offsets, self._columns, np.array(values[self._entries])
        self._matrix = petsc.Mat().createSBAIJ((shape, shape), 1, csr=pattern, comm=communicator)
        # The preconditioner of PETSc creates the empty factor.
        self._owner = petsc.PC().create(communicator)
        self._owner.setOperators(self._matrix)
        self._owner.setType("cholesky")
        self._owner.setFactorSolverType("mumps")
        self._owner.setFactorSetUpSolverType()
        self._factor = self._owner.getFactorMatrix()
        for parameter, setting in _MUMPS.items():
            self._factor.setMumpsIcntl(parameter, setting)
        self._factor.setMumpsIcntl(_RELAXATION, _RELAXATIONS[0])
        self._settings = (ctypes.c_double * _SETTINGS)()
        self._call("MatFactorInfoInitialize", self._settings)
        rows = petsc.IS().createStride(end - first, first=first, step=1, comm=communicator)
        self._call(
            "MatCholeskyFactorSymbolic",
            *(_handle(part) for part in (self._factor, self._matrix, rows)),
            self._settings,
        )
        rows.destroy()
        self._require_success()

    @property
    def peak_bytes(self) -> int:
        """Predicted memory (bytes) of the factorisation, for all ranks together."""
        return 1_000_000 * int(self._factor.getMumpsInfog(17))

    def factorise(self, name: int) -> "tuple[int, int]":
        """Numbers of negative and of zero eigenvalues of the matrix with the values in a file."""
        values = np.load(self._folder / f"{name}-values.npy", mmap_mode="r")
        rank_values = np.array(values[self._entries])
        self._matrix.setValuesCSR(self._offsets, self._columns, rank_values)
        self._matrix.assemble()
        for relaxation in _RELAXATIONS:
            self._factor.setMumpsIcntl(_RELAXATION, relaxation)
            self._call("MatFactorClearError", _handle(self._factor))
            parts = _handle(self._factor), _handle(self._matrix)
            self._call("MatCholeskyFactorNumeric", *parts, self._settings)
            last = relaxation == _RELAXATIONS[-1]
            if last or self._factor.getMumpsInfog(1) not in _MORE_ROOM:
                break
        self._require_success()
        negative, zero, _ = self._factor.getInertia()
        return int(negative), int(zero)

    def solve(self) -> None:
        """Write the solutions for the right-hand sides (n×k) in their file."""
        right = np.load(self._folder / "right.npy", mmap_mode="r")
        solution = np.load(self._folder / "solution.npy", mmap_mode="r+")
        right_side = self._dense(np.array(right[self._rows], order="F"))
        unknown = self._dense(
            np.zeros((self._rows.stop - self._rows.start, right.shape[1]), order="F")
        )
        self._factor.matSolve(right_side, unknown)
        solution[self._rows] = unknown.getDenseArray()
        right_side.destroy()
        unknown.destroy()
        self._petsc.COMM_WORLD.barrier()

    def _dense(self, rows: Any) -> Any:
        """Dense matrix of PETSc with the `rows` of this rank."""
        shape = (len(rows), self._size), (None, rows.shape[1])
        dense = self._petsc.Mat().createDense(shape, array=rows, comm=self._petsc.COMM_WORLD)
        dense.assemble()
        return dense

    def destroy(self) -> None:
        """Free the memory of matrix and factor."""
        self._owner.destroy()
        self._matrix.destroy()

    def _require_success(self) -> None:
        number = int(self._factor.getMumpsInfog(1))
        if number < 0:
            raise _MumpsError(number, int(self._factor.getMumpsInfog(2)))

    def _call(self, name: str, *arguments: Any) -> None:
        """Call a function of PETSc that petsc4py does not provide."""
        if code := getattr(self._library, name)(*arguments):
            raise RuntimeError(f"{name} of PETSc failed with code {code}")


def _handle(part: Any) -> ctypes.c_void_p:
    return ctypes.c_void_p(part.handle)


def _petsc() -> Any:
    """Module PETSc of petsc4py, initialised. Raises ImportError."""
    if sys.prefix == "/usr":
        sys.path.extend(str(folder) for folder in sorted(Path("/").glob(_DEBIAN)))
    import petsc4py  # noqa: PLC0415

    petsc4py.init(["flexproof", "-options_left", "no", "-no_signal_handler"])
    from petsc4py import PETSc  # noqa: PLC0415

    if PETSc.ScalarType is not np.float64 or not PETSc.Sys.hasExternalPackage("mumps"):
        raise ImportError("its PETSc has complex numbers, or no MUMPS")
    return PETSc


def _mumps_version(library: ctypes.CDLL) -> str:
    version = ctypes.create_string_buffer(_VERSION)
    try:
        library.mumps_set_version_(version, _VERSION)
    except AttributeError:
        return ""
    return version.raw.decode("ascii", "replace").strip(" \0")


def serve(folder: Path) -> None:
    """Answer commands until the pipe from which they are read is closed."""
    answers = os.fdopen(os.dup(1), "w", encoding="ascii")
    # Messages that libraries print are written to the log.
    os.dup2(2, 1)

    def answer(content: "dict[str, Any]") -> None:
        answers.write(json.dumps(content) + "\n")
        answers.flush()

    try:
        petsc = _petsc()
    except ImportError as error:
        answer({"missing": " ".join(str(error).split())})
        return
    library = ctypes.CDLL(petsc.__file__)
    rank = petsc.COMM_WORLD.rank
    version = ".".join(map(str, petsc.Sys.getVersion()))
    if rank == 0:
        ranks = petsc.COMM_WORLD.size
        answer({"petsc": version, "mumps": _mumps_version(library), "ranks": ranks})
    factors: dict[int, _Factor] = {}
    with (folder / f"commands-{rank}").open(encoding="ascii") as commands:
        for line in commands:
            command = json.loads(line)
            content = _executed(command["verb"], command["name"], factors, petsc, library, folder)
            if rank == 0:
                answer(content)


def _executed(
    verb: str,
    name: int,
    factors: "dict[int, _Factor]",
    petsc: Any,
    library: ctypes.CDLL,
    folder: Path,
) -> "dict[str, Any]":
    """Answer to a command. Errors of MUMPS are part of the answer, others end the process."""
    try:
        if verb == "analyse":
            factors[name] = _Factor(petsc, library, folder, name)
            return {"peak_bytes": factors[name].peak_bytes}
        if verb == "factorise":
            negative, zero = factors[name].factorise(name)
            return {"negative": negative, "zero": zero}
        if verb == "solve":
            factors[name].solve()
        elif name in factors:
            factors.pop(name).destroy()
    except _MumpsError as error:
        return {"error": str(error)}
    return {}


if __name__ == "__main__":
    serve(Path(sys.argv[1]))
