"""Program that computes for the backend `petsc`, run by a Python that has petsc4py.

It imports nothing of this project, only numpy and petsc4py of the Python that runs it, and mpi4py
if there are several hosts. It is started as `server.py FOLDER HOSTS`, once for each MPI rank. On
one host, each rank reads commands, one JSON object per line, from the pipe `commands-RANK` in the
folder. Arrays are numpy files in the same folder. On several hosts, only rank 0 reads the pipe and
the files, and the other ranks receive from it. Rank 0 writes the answers to standard output, one
JSON object per line.
"""

import ctypes
import json
import os
import sys
import traceback
from pathlib import Path
from time import sleep
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Iterator

# Folders of petsc4py in Debian. The usual path exists only with the development package.
_DEBIAN = "usr/lib/petscdir/petsc*/*-real/lib/python3/dist-packages"
# Parameters of MUMPS for symmetric matrices: ordering by METIS, no ScaLAPACK at the root (which
# does not provide the inertia), and detection of null pivots.
_MUMPS = {7: 5, 13: 1, 24: 1}
# Number of the MUMPS parameter for working memory in excess of the prediction, and the values (per
# cent) that are tried in turn.
_RELAXATION, _RELAXATIONS = 14, (30, 100, 400)
# Error numbers of MUMPS if the predicted working memory is insufficient.
_MORE_ROOM = {-8, -9, -14, -17, -20}
# Size (doubles) of the settings of a factorisation in PETSc, more than any version needs.
_SETTINGS = 64
# Length of the version text that MUMPS writes.
_VERSION = 30
# Relative residual at which conjugate gradients stop, in the norm of the preconditioner, which is
# equivalent to the energy norm. The relative error of the energy is the square of this; that of
# products of the displacements with other loads, such as the 6×6 of a part, is about this.
_RESIDUAL = 1e-11
# Relative residual of the columns of the border in the preconditioner, which need not be exact.
_BORDER_RESIDUAL = 1e-2
# Largest number of iterations. 30 to 70 are usual, nearly incompressible parts need some hundreds.
_ITERATIONS = 2000
# Largest number of restarts of conjugate gradients, for a true residual that is larger than the one
# updated in the iteration.
_RESTARTS = 3
# Number of unknowns of a node, which the preconditioner keeps together.
_BLOCK = 3
# Time (s) between two checks by a waiting rank for a command from rank 0 on another host.
_PAUSE = 0.002
# Largest number of bytes of a message. MPI counts bytes with 32-bit integers.
_MESSAGE = 1 << 30


class _MumpsError(Exception):
    """An error of MUMPS on all ranks, with its number and detail (INFOG(1) and INFOG(2))."""

    def __init__(self, number: int, detail: int) -> None:
        super().__init__(f"MUMPS error {number} ({detail})")
        self.number = number


class _Files:
    """Arrays and commands that every rank reads by itself, in a folder of its own machine."""

    def __init__(self, folder: Path, petsc: Any) -> None:
        self._folder, self._petsc = folder, petsc
        self._rank = petsc.COMM_WORLD.rank

    def commands(self) -> "Iterator[dict[str, Any]]":
        """Yield commands from the pipe of this rank until it is closed."""
        with (self._folder / f"commands-{self._rank}").open(encoding="ascii") as lines:
            for line in lines:
                yield json.loads(line)

    def read(self, name: str, rows: slice) -> Any:
        """The `rows` of the array `name` in the folder, for this rank."""
        return np.array(self._array(name)[rows])

    def write(self, name: str, rows: slice, array: Any) -> None:
        """Write the `rows` of this rank to the existing array `name` in the folder.

        Returns when all ranks have written their rows.
        """
        self._array(name, "r+")[rows] = array
        self._petsc.COMM_WORLD.barrier()

    def _array(self, name: str, mode: "Literal['r', 'r+']" = "r") -> Any:
        return np.load(self._folder / f"{name}.npy", mmap_mode=mode)


class _Messages(_Files):
    """Arrays and commands that rank 0 reads and sends to ranks on other machines."""

    def __init__(self, folder: Path, petsc: Any) -> None:
        super().__init__(folder, petsc)
        from mpi4py import MPI  # noqa: PLC0415

        self._byte, self._communicator = MPI.BYTE, MPI.COMM_WORLD
        self._others = range(1, self._communicator.size)

    def commands(self) -> "Iterator[dict[str, Any]]":
        """Yield commands, which rank 0 reads from its pipe, until the pipe is closed."""
        if self._rank == 0:
            for command in super().commands():
                self._send_object(command)
                yield command
            self._send_object(None)
            return
        while True:
            # A rank that waits in MPI would occupy its core.
            while not self._communicator.Iprobe(source=0):
                sleep(_PAUSE)
            command = self._communicator.recv(source=0)
            if command is None:
                return
            yield command

    def read(self, name: str, rows: slice) -> Any:
        """The `rows` of the array `name`, for this rank. Rank 0 reads and sends them."""
        ranges = self._communicator.gather((rows.start, rows.stop))
        if self._rank:
            return self._receive(0)
        array = self._array(name)
        for rank in self._others:
            self._send(np.ascontiguousarray(array[slice(*ranges[rank])]), rank)
        return np.array(array[rows])

    def write(self, name: str, rows: slice, array: Any) -> None:
        """Send the `rows` of this rank to rank 0, which writes them to the array `name`."""
        written = self._communicator.gather((rows.start, rows.stop))
        if self._rank:
            self._send(np.ascontiguousarray(array), 0)
            return
        file = self._array(name, "r+")
        file[rows] = array
        for rank in self._others:
            file[slice(*written[rank])] = self._receive(rank)

    def _send_object(self, content: Any) -> None:
        for rank in self._others:
            self._communicator.send(content, dest=rank)

    def _send(self, array: Any, rank: int) -> None:
        self._communicator.send((array.shape, array.dtype.str), dest=rank)
        for piece in _pieces(array):
            self._communicator.Send([piece, self._byte], dest=rank)

    def _receive(self, rank: int) -> Any:
        shape, kind = self._communicator.recv(source=rank)
        array = np.empty(shape, dtype=kind)
        for piece in _pieces(array):
            self._communicator.Recv([piece, self._byte], source=rank)
        return array


def _pieces(array: Any) -> "list[Any]":
    """The bytes of a contiguous array in pieces that fit into a message."""
    flat = array.reshape(-1).view(np.uint8)
    return [flat[start : start + _MESSAGE] for start in range(0, len(flat), _MESSAGE)]


class _Rows:
    """Rows of a symmetric matrix that belong to this rank.

    `block` is the number of unknowns that must stay together on one rank.
    """

    def __init__(self, petsc: Any, files: _Files, name: int, size: int, block: int) -> None:
        layout = petsc.Vec().create(petsc.COMM_WORLD)
        layout.setSizes(size, block)
        layout.setUp()
        first, end = layout.getOwnershipRange()
        layout.destroy()
        offsets = files.read(f"{name}-offsets", slice(first, end + 1))
        self.rows, self.size = slice(first, end), size
        self.entries = slice(int(offsets[0]), int(offsets[-1]))
        self.offsets = (offsets - offsets[0]).astype(petsc.IntType)
        self.columns = files.read(f"{name}-columns", self.entries).astype(petsc.IntType)
        shape = (end - first, size)
        pattern = self.offsets, self.columns, files.read(f"{name}-values", self.entries)
        self.matrix = petsc.Mat().createSBAIJ((shape, shape), 1, csr=pattern, comm=petsc.COMM_WORLD)


class _Factor:
    """Matrix and factor for one sparsity pattern, distributed by rows over the ranks."""

    def __init__(
        self, petsc: Any, library: ctypes.CDLL, files: _Files, name: int, size: int
    ) -> None:
        self._petsc, self._library, self._files = petsc, library, files
        self._share = _Rows(petsc, files, name, size, 1)
        self._rows, self._size, self._matrix = self._share.rows, size, self._share.matrix
        communicator = petsc.COMM_WORLD
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
        rows = petsc.IS().createStride(
            self._rows.stop - self._rows.start, first=self._rows.start, step=1, comm=communicator
        )
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

    @property
    def largest_bytes(self) -> int:
        """Predicted memory (bytes) of the rank that needs most."""
        return 1_000_000 * int(self._factor.getMumpsInfog(16))

    def factorise(self, name: int) -> "tuple[int, int]":
        """Numbers of negative and of zero eigenvalues of the matrix, which is factorised.

        Its values are read from the file of the ordering `name`.
        """
        values = self._files.read(f"{name}-values", self._share.entries)
        self._matrix.setValuesCSR(self._share.offsets, self._share.columns, values)
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

    def solve(self) -> "dict[str, Any]":
        """Solve for the right-hand sides (n×k) in the file `right`. Write the file `solution`."""
        right = np.asfortranarray(self._files.read("right", self._rows))
        right_side, unknown = self._dense(right), self._dense(np.zeros_like(right))
        self._factor.matSolve(right_side, unknown)
        self._files.write("solution", self._rows, unknown.getDenseArray())
        right_side.destroy()
        unknown.destroy()
        return {}

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


class _BorderedCycle:
    """Preconditioner for the matrix K = [[A, B], [Bᵀ, C]] by a cycle G ≈ A⁻¹ of multigrid.

    With W ≈ A⁻¹B (n×k) it is [I −W; 0 I] diag(G, S⁻¹) [I 0; −Wᵀ I]. S = [−W; I]ᵀ K [−W; I] is
    positive definite for any W if K is. `product` contains A W − B, `corner` C. The k unknowns of
    the border belong to the last rank.
    """

    def __init__(self, cycle: Any, border: Any, product: Any, corner: Any, W: Any) -> None:
        self._cycle, self._W = cycle, W
        total, inner = W.createVecs()
        part = total.duplicate()
        self._vectors = inner, inner.duplicate(), total, part
        columns = []
        for index, column in enumerate(corner.T):
            border.multTranspose(W.getColumnVector(index, inner), part)
            W.multTranspose(product.getColumnVector(index, inner), total)
            total.axpy(-1.0, part)
            columns.append(total.getArray() + column)
        schur = np.array(columns)
        self._schur = (schur + schur.T) / 2.0 if schur.size else None

    def apply(self, _: Any, residual: Any, correction: Any) -> None:
        """Apply the preconditioner to a residual. PETSc calls this."""
        inner, inner_correction, last_correction, _ = self._vectors
        entries, count = residual.getArray(readonly=True), inner.getLocalSize()
        inner.setArray(entries[:count])
        self._cycle.apply(inner, inner_correction)
        self._W.multTranspose(inner, last_correction)
        if self._schur is not None:
            reaction = entries[count:] - last_correction.getArray()
            last_correction.setArray(np.linalg.solve(self._schur, reaction))
        self._W.mult(last_correction, inner)
        inner_correction.axpy(-1.0, inner)
        correction.setArray(
            np.concatenate([inner_correction.getArray(), last_correction.getArray()])
        )

    def destroy(self) -> None:
        """Free the memory of its vectors."""
        for vector in self._vectors:
            vector.destroy()


class _Iteration:
    """Conjugate gradients, preconditioned by the multigrid GAMG, for one positive definite matrix.

    The matrix is [[A, B], [Bᵀ, C]]. A has `size` rows, C has `border` rows, often none. GAMG
    constructs its coarse levels for A from the rigid motions (`size`×6, orthonormal), its near null
    space. They are set up once for all right-hand sides.
    """

    def __init__(self, petsc: Any, files: _Files, name: int, size: int, border: int) -> None:
        self._petsc, self._files = petsc, files
        communicator = petsc.COMM_WORLD
        block = _BLOCK if size % _BLOCK == 0 else 1
        share = _Rows(petsc, files, name, size, block)
        # GAMG needs both triangles.
        inner = petsc.Mat()
        share.matrix.convert("mpiaij" if communicator.size > 1 else "seqaij", inner)
        share.matrix.destroy()
        inner.setBlockSize(block)
        inner.setOption(petsc.Mat.Option.SPD, flag=True)
        motions = files.read(f"{name}-motions", share.rows)
        vectors = [self._vector(column, block) for column in motions.T]
        rigid = petsc.NullSpace().create(vectors=vectors, comm=communicator)
        inner.setNearNullSpace(rigid)
        solver = self._conjugate_gradients(inner)
        solver.getPC().setType("gamg")
        # Only this sets the coarsening of GAMG to its default, the square of the graph. Without it
        # the levels have four times the entries of the matrix, with it 1.2 times.
        solver.setFromOptions()
        solver.setUp()
        self._rows, self._matrix, self._solver = share.rows, inner, solver
        self._parts = [inner, solver]
        self._norm = inner.norm(petsc.NormType.INFINITY)
        if border:
            self._add_border(name, size, border)

    def _add_border(self, name: int, size: int, border: int) -> None:
        """Extend the matrix and the preconditioner by the unknowns of the border."""
        petsc, communicator = self._petsc, self._petsc.COMM_WORLD
        last = communicator.rank == communicator.size - 1
        inner, solver, count = self._matrix, self._solver, self._rows.stop - self._rows.start
        self._rows = slice(self._rows.start, size + border if last else self._rows.stop)
        rows = self._files.read(f"{name}-border", self._rows)
        shares = border if last else 0, border

        def dense(array: Any, sizes: Any) -> Any:
            entries = np.asfortranarray(array)
            matrix = petsc.Mat().createDense((sizes, shares), array=entries, comm=communicator)
            matrix.assemble()
            return matrix

        B = dense(rows[:count], (count, size))
        corner = rows[count:]
        C = dense(corner, shares)
        W, product = (dense(np.zeros_like(rows[:count]), (count, size)) for _ in range(2))
        solver.setTolerances(rtol=_BORDER_RESIDUAL)
        right, solution = inner.createVecs()
        image = right.duplicate()
        for index in range(border):
            B.getColumnVector(index, right)
            solver.solve(right, solution)
            W.getDenseArray()[:, index] = solution.getArray()
            inner.mult(solution, image)
            image.axpy(-1.0, right)
            product.getDenseArray()[:, index] = image.getArray()
        W.assemble()
        product.assemble()
        transpose = petsc.Mat().createTranspose(B)
        self._matrix = petsc.Mat().createNest([[inner, B], [transpose, C]], comm=communicator)
        self._matrix.setOption(petsc.Mat.Option.SPD, flag=True)
        self._solver = self._conjugate_gradients(self._matrix)
        preconditioner = self._solver.getPC()
        preconditioner.setType("python")
        context = _BorderedCycle(solver.getPC(), B, product, corner, W)
        preconditioner.setPythonContext(context)
        self._solver.setUp()
        one, infinity = petsc.NormType.NORM_1, petsc.NormType.INFINITY
        self._norm = max(self._norm + B.norm(infinity), B.norm(one) + C.norm(infinity))
        for part in (product, right, solution, image):
            part.destroy()
        self._parts += [B, C, W, transpose, context, self._matrix, self._solver]

    def _conjugate_gradients(self, matrix: Any) -> Any:
        solver = self._petsc.KSP().create(self._petsc.COMM_WORLD)
        solver.setOperators(matrix)
        solver.setType("cg")
        solver.setNormType(self._petsc.KSP.NormType.NATURAL)
        solver.setTolerances(rtol=_RESIDUAL, atol=0.0, max_it=_ITERATIONS)
        return solver

    def _vector(self, values: Any, block: int) -> Any:
        vector = self._petsc.Vec().create(self._petsc.COMM_WORLD)
        vector.setSizes((len(values), None), block)
        vector.setUp()
        vector.setArray(values)
        return vector

    def solve(self) -> "dict[str, Any]":
        """Solve for the right-hand sides (n×k) in the file `right`. Write the file `solution`.

        The result contains for each solution the number of iterations, `energy`, `backward`,
        `balance` and `reason`, as explained in `SolutionCheck` of the module `iteration`. `reason`
        is negative if the iteration does not converge.
        """
        columns = self._files.read("right", self._rows)
        solutions = np.zeros_like(columns)
        checks = []
        right, solution = self._matrix.createVecs()
        residual, preconditioned = right.duplicate(), right.duplicate()
        for column in range(columns.shape[1]):
            right.setArray(columns[:, column])
            solution.set(0.0)
            iterations = 0
            for restart in range(1 + _RESTARTS):
                self._solver.setInitialGuessNonzero(restart > 0)
                self._solver.solve(right, solution)
                iterations += self._solver.getIterationNumber()
                reason = self._solver.getConvergedReason()
                self._matrix.mult(solution, residual)
                twice_energy = solution.dot(residual)
                residual.aypx(-1.0, right)
                self._solver.getPC().apply(residual, preconditioned)
                work = max(abs(twice_energy), sys.float_info.min)
                energy = (abs(residual.dot(preconditioned)) / work) ** 0.5
                if reason < 0 or energy <= 2.0 * _RESIDUAL:
                    break
            infinity = self._petsc.NormType.INFINITY
            size = self._norm * solution.norm(infinity) + right.norm(infinity)
            backward = residual.norm(infinity) / max(size, sys.float_info.min)
            balance = abs(solution.dot(residual)) / work
            checks.append((iterations, energy, backward, balance, reason))
            solutions[:, column] = solution.getArray()
        self._files.write("solution", self._rows, solutions)
        for vector in (right, solution, residual, preconditioned):
            vector.destroy()
        return {"checks": checks}

    def cycle(self) -> "dict[str, Any]":
        """Apply one cycle of the multigrid to each column (n×k) of the file `right`.

        Write the results to the file `solution`.
        """
        columns = self._files.read("right", self._rows)
        images = np.zeros_like(columns)
        right, image = self._matrix.createVecs()
        for column in range(columns.shape[1]):
            right.setArray(columns[:, column])
            self._solver.getPC().apply(right, image)
            images[:, column] = image.getArray()
        self._files.write("solution", self._rows, images)
        right.destroy()
        image.destroy()
        return {}

    def destroy(self) -> None:
        """Free the memory of matrix and preconditioner."""
        for part in reversed(self._parts):
            part.destroy()


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
        raise ImportError("the PETSc of this Python has complex numbers, or no MUMPS")
    return PETSc


def _mumps_version(library: ctypes.CDLL) -> str:
    version = ctypes.create_string_buffer(_VERSION)
    try:
        library.mumps_set_version_(version, _VERSION)
    except AttributeError:
        return ""
    return version.raw.decode("ascii", "replace").strip(" \0")


def serve(folder: Path, hosts: int) -> None:
    """Answer commands until the pipe from which they are read is closed.

    `folder` contains the pipes and arrays, `hosts` is the number of machines that run ranks.
    """
    answers = os.fdopen(os.dup(1), "w", encoding="ascii")
    # Messages that libraries print are written to the log.
    os.dup2(2, 1)

    def answer(content: "dict[str, Any]") -> None:
        answers.write(json.dumps(content) + "\n")
        answers.flush()

    try:
        petsc = _petsc()
        files = (_Messages if hosts > 1 else _Files)(folder, petsc)
    except ImportError as error:
        answer({"missing": " ".join(str(error).split())})
        return
    library = ctypes.CDLL(petsc.__file__)
    rank = petsc.COMM_WORLD.rank
    version = ".".join(map(str, petsc.Sys.getVersion()))
    if rank == 0:
        ranks = petsc.COMM_WORLD.size
        answer({"petsc": version, "mumps": _mumps_version(library), "ranks": ranks})
    systems: dict[int, Any] = {}
    for command in files.commands():
        content = _executed(command, systems, petsc, library, files)
        if rank == 0:
            answer(content)


def _executed(
    command: "dict[str, Any]",
    systems: "dict[int, Any]",
    petsc: Any,
    library: ctypes.CDLL,
    files: _Files,
) -> "dict[str, Any]":
    """Answer to a command.

    If MUMPS fails, the answer contains its error. Other errors end the process. `systems` contains
    the factor or iteration of each name.
    """
    verb, name = command["verb"], command["name"]
    try:
        if verb == "analyse":
            systems[name] = factor = _Factor(petsc, library, files, name, command["size"])
            return {"peak_bytes": factor.peak_bytes, "largest_bytes": factor.largest_bytes}
        if verb == "factorise":
            negative, zero = systems[name].factorise(name)
            return {"negative": negative, "zero": zero}
        if verb == "precondition":
            systems[name] = _Iteration(petsc, files, name, command["size"], command["border"])
        elif verb == "solve":
            return dict(systems[name].solve())
        elif verb == "cycle":
            return dict(systems[name].cycle())
        elif name in systems:
            systems.pop(name).destroy()
    except _MumpsError as error:
        return {"error": str(error)}
    return {}


if __name__ == "__main__":
    try:
        serve(Path(sys.argv[1]), int(sys.argv[2]))
    except BaseException:  # noqa: BLE001  all of them end the process
        # An ordinary exit would wait for the other ranks, which may wait for this one.
        traceback.print_exc()
        sys.stderr.flush()
        os._exit(1)
