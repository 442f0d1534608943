"""Factors by MUMPS through PETSc, in one separate process or in MPI ranks on one or more hosts.

MUMPS factorises PᵀAP = L D Lᵀ with pivots of one or two rows, in an order by nested dissection of
METIS (Amestoy, Duff, L'Excellent, Koster, SIAM J. Matrix Anal. Appl. 23 (2001) 15). It detects null
pivots, and the signs of D count eigenvalues. petsc4py belongs to another Python, of the system or
of conda, which runs `server`. Among the matrices with one sparsity pattern, only the factor of the
last one is stored. An earlier factor is computed again if it is needed.
"""

import json
import os
import re
import select
import shutil
import signal
import subprocess
import sys
import tempfile
from collections import deque
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from functools import cache
from itertools import count
from pathlib import Path
from threading import Lock
from time import monotonic
from typing import Any
from weakref import finalize

import numpy as np
from scipy.sparse import csr_array

from fem.solvers.backends.factor_checks import is_accurate, require_memory
from fem.solvers.backends.protocol import HOST
from lumped.arrays import Array, SparseMatrix
from lumped.errors import ComputationError, InputError
from lumped.solver_request import (
    PYTHON_VARIABLE,
    petsc_python,
    requested_hosts,
    requested_ranks,
)
from lumped.text import counted

# The reference BLAS of Debian takes three times as long as OpenBLAS.
PACKAGES = "python3-petsc4py, mpi-default-bin and libopenblas0-serial"
# Additional package for several hosts, which must be installed on each of them.
HOST_PACKAGES = ", and python3-mpi4py on each host"
# Environment of the server: one thread for each rank. Open MPI 4 and 5 may start more ranks than
# cores, also as root, and ranks that wait yield their core.
_ENVIRONMENT: Mapping[str, str] = {
    "OMP_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "PRTE_ALLOW_RUN_AS_ROOT": "1",
    "PRTE_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "PRTE_MCA_rmaps_default_mapping_policy": ":oversubscribe",
}
# Variables that mpiexec passes on to other hosts.
_THREADS = "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"
# Number of right-hand sides solved together.
_COLUMNS_AT_ONCE = 64
# Largest time (s) for a server to start. 1 to 5 s are usual.
_PATIENCE_AT_START = 120.0
# Largest time (s) for a server to end by itself.
_PATIENCE_AT_END = 3.0


# Line of a Python traceback with the error. Messages of mpiexec follow it.
_ERROR = re.compile(r"(\w+\.)*\w+Error\b")


class MissingPetscError(InputError):
    """Error: there is no Python with petsc4py, or no MPI although several ranks are requested."""


class Server:
    """Connection to the program `server` on a number of MPI ranks.

    It has a private folder for files. `hosts` are the names of the machines that run the ranks, the
    same number on each. Empty if all ranks run on this machine.
    """

    def __init__(self, interpreter: str, ranks: int, mpiexec: str, hosts: tuple[str, ...]) -> None:
        self._lock, self._names = Lock(), count()
        self._discarded: deque[int] = deque()
        self.hosts = hosts
        where = f" on {', '.join(hosts)}" if hosts else ""
        self.ranks = f"{counted(ranks, 'rank')}{where}"
        self._what = f"PETSc on {self.ranks}"
        self._folder = Path(tempfile.mkdtemp(prefix="flexproof-petsc-"))
        pipes: list[int] = []
        try:
            # Ranks on other machines receive commands from rank 0.
            for rank in range(1 if len(hosts) > 1 else ranks):
                pipe = self._folder / f"commands-{rank}"
                os.mkfifo(pipe, 0o600)
                # Opened for reading and writing, so that opening does not wait for the server.
                pipes.append(os.open(pipe, os.O_RDWR))
            self._keeper = self._started(interpreter, ranks, mpiexec)
        except BaseException:
            for descriptor in pipes:
                os.close(descriptor)
            shutil.rmtree(self._folder, ignore_errors=True)
            raise
        self._pipes = tuple(pipes)
        self.end = finalize(self, _end, self._keeper, self._pipes, self._folder)
        try:
            self.about = self._answer(_PATIENCE_AT_START)
        except BaseException:
            self.end()
            raise

    def _started(self, interpreter: str, ranks: int, mpiexec: str) -> "subprocess.Popen[bytes]":
        """Start the keeper, a program that starts the server. Return the keeper's process."""
        folder, hosts = Path(__file__).parent, self.hosts
        server = [interpreter, "-I", str(folder / "server.py")]
        command = [*server, str(self._folder), str(len(hosts))]
        if hosts:
            file = self._folder / "hosts"
            lines = [f"{host} slots={ranks // len(hosts)}\n" for host in hosts]
            file.write_text("".join(lines), encoding="utf-8")
            exported = [word for variable in _THREADS for word in ("-x", variable)]
            command = ["--hostfile", str(file), *exported, *command]
        if ranks > 1 or hosts:
            command = [mpiexec, "-n", str(ranks), *command]
        keeper = [sys.executable, "-I", str(folder / "keeper.py"), str(self._folder), *command]
        environment = {**os.environ, **_ENVIRONMENT}
        if not hosts:
            # Session files of Open MPI. The private folder exists on this machine alone.
            environment["OMPI_MCA_orte_tmpdir_base"] = str(self._folder)
        with (self._folder / "log").open("wb") as log:
            return subprocess.Popen(  # noqa: S603  this interpreter
                keeper,
                env=environment,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=log,
                # Without a buffer, `select` detects each line that has arrived.
                bufsize=0,
                start_new_session=True,
            )

    @property
    def alive(self) -> bool:
        """True if the server process runs and can answer."""
        return self.end.alive

    def new_name(self) -> int:
        """Unique name for an ordering on the server."""
        return next(self._names)

    def analyse(self, name: int, lower: SparseMatrix) -> int:
        """Order the unknowns of a lower triangle (csc n×n). Return the predicted memory (bytes).

        `name` is a new name for the ordering. With several hosts, the memory is that needed on one
        of them, otherwise that of all ranks together.
        """
        with self._command():
            self._store_triangle(name, lower)
            answer = self._execute("analyse", name, size=int(lower.shape[0]))
            if not self.hosts:
                return int(answer["peak_bytes"])
            ranks = int(self.about["ranks"]) // len(self.hosts)
            return ranks * int(answer["largest_bytes"])

    def precondition(
        self, name: int, lower: SparseMatrix, border: Array, motions: Array, part: str
    ) -> None:
        """Prepare conjugate gradients for the matrix [[A, B], [Bᵀ, C]].

        `name` is a new name for this iteration. `lower` is the lower triangle of A (csc n×n),
        `border` ((n+k)×k) contains B and C. `motions` (n×6) are orthonormal rigid motions of the
        unknowns of A. `part` is the name of the matrix in messages.
        """
        count = int(border.shape[1])
        with self._command(part):
            self._store_triangle(name, lower)
            self._store(f"{name}-motions", motions)
            if count:
                self._store(f"{name}-border", border)
            self._execute("precondition", name, part, size=int(lower.shape[0]), border=count)

    def _store_triangle(self, name: int, lower: SparseMatrix) -> None:
        for kind, array in (
            ("offsets", lower.indptr),
            ("columns", lower.indices),
            ("values", lower.data),
        ):
            self._store(f"{name}-{kind}", array)

    def factorise(self, name: int, values: Array, part: str) -> tuple[int, int]:
        """Factorise a matrix. Return its numbers of negative and of zero eigenvalues.

        `name` is the number of the ordering that `analyse` stored. `values` are the entries of the
        lower triangle, in the order of the triangle given to `analyse`. `part` is the name of the
        matrix in messages.
        """
        with self._command(part):
            self._store(f"{name}-values", values)
            answer = self._execute("factorise", name, part)
            return int(answer["negative"]), int(answer["zero"])

    def solve(self, name: int, right: Array, part: str = "") -> tuple[Array, dict[str, Any]]:
        """Solutions (n×k) for the right-hand sides `right` (n×k), and the answer of the server.

        `name` is the name of a factorised ordering or of an iteration. The answer of an iteration
        contains its checks, that of a factor is empty.
        """
        return self._columns("solve", name, right, part)

    def cycle(self, name: int, right: Array, part: str) -> Array:
        """Approximate solutions (n×k) for `right` (n×k), by one cycle of the iteration `name`."""
        return self._columns("cycle", name, right, part)[0]

    def _columns(
        self, verb: str, name: int, right: Array, part: str
    ) -> tuple[Array, dict[str, Any]]:
        with self._command(part):
            self._store("right", right)
            self._store("solution", np.zeros_like(right))
            answer = self._execute(verb, name, part)
            solution = np.load(self._folder / "solution.npy")
            return np.asarray(solution, dtype=np.float64), answer

    def discard(self, name: int) -> None:
        """Free the factor or iteration `name`.

        It is freed at once, or before the next command if the server is busy.
        """
        self._discarded.append(name)
        # A finaliser may run during a command, in any thread.
        if self._lock.acquire(blocking=False):
            try:
                if self.alive:
                    with suppress(ComputationError):
                        self._discard_all()
            finally:
                self._lock.release()

    def _discard_all(self) -> None:
        while self._discarded:
            name = self._discarded.popleft()
            self._exchange("discard", name)
            for file in self._folder.glob(f"{name}-*.npy"):
                file.unlink(missing_ok=True)

    @contextmanager
    def _command(self, part: str = "") -> Iterator[None]:
        """Context in which this thread alone writes files and sends commands to the server.

        Raises ComputationError if the server has ended or a file cannot be written.
        """
        with self._lock:
            if not self.alive:
                raise ComputationError(f"{self._what} has already ended", part)
            try:
                yield
            except OSError as error:
                self.end()
                reason = f"{self._what}: {self._folder}: {error.strerror}"
                raise ComputationError(reason, part) from error

    def _store(self, name: str, array: Any) -> None:
        """Write an array to a file in the folder of the server."""
        np.save(self._folder / f"{name}.npy", array)

    def _execute(self, verb: str, name: int, part: str = "", **sizes: int) -> dict[str, Any]:
        """Answer of the server to the command `verb` for the ordering or iteration `name`.

        `sizes` are numbers of unknowns, which only commands for a new matrix need. Raises
        ComputationError if the command fails.
        """
        self._discard_all()
        answer = self._exchange(verb, name, part, **sizes)
        if "error" in answer:
            raise ComputationError(f"{self._what}: {answer['error']}", part)
        return answer

    def _exchange(self, verb: str, name: int, part: str = "", **sizes: int) -> dict[str, Any]:
        line = f"{json.dumps({'verb': verb, 'name': name, **sizes})}\n".encode()
        try:
            for pipe in self._pipes:
                os.write(pipe, line)
            return self._answer(None, part)
        except BaseException:
            self.end()
            raise

    def _answer(self, patience: float | None, part: str = "") -> dict[str, Any]:
        """Next JSON object on the standard output of the server.

        `patience` (s) is the longest wait. If it is None, there is no limit. Raises
        ComputationError if there is no answer.
        """
        output = self._keeper.stdout
        if output is None:  # pragma: no cover
            raise AssertionError("standard output is a pipe")
        end = None if patience is None else monotonic() + patience
        while True:
            remaining = None if end is None else max(0.0, end - monotonic())
            if not select.select([output], [], [], remaining)[0]:
                raise ComputationError(f"{self._what} did not start in {patience:g} s", part)
            line = output.readline()
            if not line:
                raise ComputationError(f"{self._what} {self._how_it_ended()}", part)
            with suppress(ValueError):
                answer: object = json.loads(line)
                if isinstance(answer, dict):
                    return answer

    def _how_it_ended(self) -> str:
        code = self._keeper.wait()
        if code > 128 and code - 128 in set(signal.Signals):
            name = signal.Signals(code - 128).name
            why = ", probably because of lack of memory" if name == "SIGKILL" else ""
            return f"was ended by {name}{why}"
        log = (self._folder / "log").read_text(encoding="utf-8", errors="replace").splitlines()
        lines = [line.strip() for line in log if line.strip(" -")]
        errors = [line for line in lines if _ERROR.match(line)]
        return f"ended with code {code}: {[*errors[:1], *lines[-1:], 'no message'][0]}"


def _end(keeper: "subprocess.Popen[bytes]", pipes: tuple[int, ...], folder: Path) -> None:
    """End a server, close its command `pipes` and remove its `folder`."""
    for pipe in pipes:
        os.close(pipe)
    with suppress(subprocess.TimeoutExpired):
        keeper.wait(_PATIENCE_AT_END)
    for stream in (keeper.stdin, keeper.stdout):
        if stream is not None:
            stream.close()
    keeper.wait()
    shutil.rmtree(folder, ignore_errors=True)


def _mpiexec(interpreter: str) -> str:
    """Program that starts MPI ranks, next to the interpreter (conda) or on the search path.

    "" if there is none.
    """
    neighbour = Path(interpreter).parent / "mpiexec"
    return str(neighbour) if neighbour.exists() else shutil.which("mpiexec") or ""


def _started(interpreter: str, ranks: int, hosts: tuple[str, ...]) -> Server:
    """New server on a number of MPI `ranks`. Raises MissingPetscError if it cannot be started.

    `interpreter` is the path of a Python with petsc4py. `hosts` are the machines of the ranks, or
    () for this machine.
    """
    mpiexec = _mpiexec(interpreter)
    if not hasattr(os, "mkfifo"):
        reason = "runs on Linux and macOS alone"
    elif not Path(interpreter).exists():
        reason = f"{interpreter} does not exist"
    elif (ranks > 1 or hosts) and not mpiexec:
        reason = "several ranks need mpiexec, not found"
    else:
        try:
            server = Server(interpreter, ranks, mpiexec, hosts)
        except (ComputationError, OSError) as error:
            reason = str(error)
        else:
            if "missing" not in server.about:
                return server
            server.end()
            reason = f"{interpreter}: {server.about['missing']}"
    packages, check = PACKAGES, ""
    if len(hosts) > 1:
        packages = f"{PACKAGES}{HOST_PACKAGES}"
        check = "check that mpiexec reaches each host without a password (ssh), "
    raise MissingPetscError(
        f"solver petsc: {reason}; {check}install the Debian packages {packages}, or set "
        f"{PYTHON_VARIABLE} to a Python with petsc4py and MUMPS"
    )


@cache
def _kept(interpreter: str, ranks: int, hosts: tuple[str, ...]) -> Server:
    return _started(interpreter, ranks, hosts)


def server() -> Server:
    """Server that this process uses, for the requested Python, ranks and hosts.

    It is started when it is first needed, and again after it has ended.
    """
    request = petsc_python(), requested_ranks(), requested_hosts()
    if not _kept(*request).alive:
        _kept.cache_clear()
    return _kept(*request)


def installed() -> bool:
    """True if there is a Python with petsc4py, PETSc and MUMPS."""
    try:
        server()
    except MissingPetscError:
        return False
    return True


def title(gamg: str = "") -> str:
    """Names and versions of the libraries, and the ranks and hosts, as a text.

    `gamg` describes the systems of equations that GAMG solves. `gamg` is "" if GAMG solves none.
    Raises MissingPetscError.
    """
    about = server().about
    mumps = f"MUMPS {about['mumps']}".rstrip()
    iteration = f", GAMG ({gamg})" if gamg else ""
    return f"PETSc {about['petsc']}, {mumps} (sparse LDLᵀ){iteration} on {server().ranks}"


class PetscNumeric:
    """Factor of a matrix that the PETSc server stores, see `Numeric`."""

    def __init__(self, ordering: "PetscOrdering", values: Array, negative: int, zero: int) -> None:
        self._ordering, self._values = ordering, values
        self.negative, self.zero = negative, zero

    def solve(self, columns: Array) -> Array:
        """Solutions (n×k) for the right-hand sides `columns` (n×k)."""
        self._ordering.load(self._values, "")
        return self._ordering.solved(columns)


class PetscOrdering:
    """Order of elimination for a lower triangle (csc n×n), see `Ordering`.

    PETSc receives the upper triangle (csr), which has the same three arrays. Raises
    MissingPetscError.
    """

    space = HOST

    def __init__(self, lower: SparseMatrix) -> None:
        self._server = server()
        self._name = self._server.new_name()
        self._size = int(lower.shape[0])
        self._upper = lower.indices, lower.indptr
        self._loaded: Array | None = None
        self._signs = 0, 0
        finalize(self, self._server.discard, self._name).atexit = False
        self.peak_bytes = self._server.analyse(self._name, lower)

    def factorise(self, values: Array, part: str) -> PetscNumeric:
        """Factor of the matrix whose lower triangle has the entries `values`.

        `part` is the name of the matrix in messages. If the factor is not accurate, its `zero` is
        at least 1. Raises ComputationError if the factorisation fails.
        """
        if self._loaded is None:
            require_memory(self.peak_bytes, self._size, part)
        self.load(values, part)
        negative, zero = self._signs
        upper = csr_array((values, *self._upper), shape=(self._size, self._size))
        if not zero and not is_accurate(upper, self.solved):
            zero = 1
        return PetscNumeric(self, values, negative, zero)

    def load(self, values: Array, part: str) -> None:
        """Factorise the matrix with these `values`, unless its factor is on the server already."""
        if self._loaded is values:
            return
        self._loaded = None
        self._signs = self._server.factorise(self._name, values, part)
        self._loaded = values

    def solved(self, columns: Array) -> Array:
        """Solutions (n×k) with the factor that is on the server."""
        solution = np.zeros(columns.shape)
        for start in range(0, columns.shape[1], _COLUMNS_AT_ONCE):
            some = slice(start, start + _COLUMNS_AT_ONCE)
            solution[:, some], _ = self._server.solve(self._name, columns[:, some])
        return solution
