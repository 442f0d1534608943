"""MUMPS through PETSc: server processes, their end, and the number of ranks."""

import os
import shutil
import signal
import subprocess
import sys
import time
from errno import ENOSPC
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.sparse import diags_array, tril
from support.fakes.petsc_installation import require_petsc

from fem.solvers.backends.choice import solver_name
from fem.solvers.backends.petsc import client
from fem.solvers.backends.request import request_solver
from fem.solvers.factor import analyse
from lumped.errors import ComputationError, InputError
from lumped.solver_request import PYTHON_VARIABLE, RANKS_VARIABLE, VARIABLE, requested_ranks

CHAIN = diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(300, 300), format="csr")
# Displacements of the chain under unit forces at all nodes: a parabola.
PARABOLA = np.arange(1, 301) * (301 - np.arange(1, 301)) / 2.0
# Time limit (s) for processes to end; killing takes up to five seconds.
PATIENCE = 30.0


@pytest.fixture(params=["1", "2"])
def ranks(request, monkeypatch, tmp_path):
    """Start a PETSc server for one test with its folder in `tmp_path`; yield the ranks."""
    monkeypatch.setenv(VARIABLE, "petsc")
    monkeypatch.setenv(RANKS_VARIABLE, request.param)
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    client._kept.cache_clear()
    require_petsc()
    yield int(request.param)
    client.server().end()
    client._kept.cache_clear()


def processes(word: str) -> dict[int, list[str]]:
    """Return the command lines of living processes that contain a word, by process number."""
    matching = {}
    for folder in Path("/proc").glob("[0-9]*"):
        try:
            words = (folder / "cmdline").read_bytes().decode().split("\0")
        except OSError:
            continue
        if any(word in argument for argument in words):
            matching[int(folder.name)] = words
    return matching


def assert_nothing_left(folder: Path) -> None:
    end = time.monotonic() + PATIENCE
    while (remaining := (processes(str(folder)), list(folder.iterdir()))) != ({}, []):
        assert time.monotonic() < end, remaining
        time.sleep(0.05)


def test_killed_server_is_replaced(ranks, tmp_path):
    """The current factor fails with the reason, and the next one starts new processes."""
    factor = analyse(CHAIN).factorise()
    servers = [
        number
        for number, words in processes(str(tmp_path)).items()
        if words[1:3] == ["-I", str(Path(client.__file__).with_name("server.py"))]
    ]
    assert len(servers) == ranks
    os.kill(servers[-1], signal.SIGKILL)
    plural = "" if ranks == 1 else "s"
    message = (
        f"PETSc on {ranks} rank{plural} was ended by SIGKILL, probably because of lack of memory"
    )
    with pytest.raises(ComputationError, match=f"^{message}$"):
        factor.solve(np.ones(300))
    assert_nothing_left(tmp_path)
    with pytest.raises(ComputationError, match=r"has already ended$"):
        factor.solve(np.ones(300))
    # Error of the solution: the condition number, 4e4, times 1e-16.
    np.testing.assert_allclose(analyse(CHAIN).factorise().solve(np.ones(300)), PARABOLA, rtol=1e-10)


@pytest.mark.parametrize("ranks", ["2"], indirect=True)
def test_failure_of_one_rank_ends_all(ranks, tmp_path):
    """The first rank would wait forever for the second, whose offsets are missing."""
    assert ranks == 2
    lower = tril(CHAIN, format="csc")
    petsc = client.server()
    damaged = SimpleNamespace(
        shape=lower.shape, indptr=lower.indptr[:151], indices=lower.indices, data=lower.data
    )
    message = r"^PETSc on 2 ranks ended with code 1: ValueError: "
    with pytest.raises(ComputationError, match=message):
        petsc.analyse(petsc.new_name(), damaged)
    assert_nothing_left(tmp_path)


SCRIPT = """
import sys
import numpy as np
from scipy.sparse import diags_array
from fem.solvers.factor import analyse
chain = diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(300, 300), format="csr")
factor = analyse(chain).factorise()
print(factor.solve(np.ones(300))[0], flush=True)
sys.stdin.read()
"""


@pytest.mark.parametrize("end", ["exit", "SIGKILL", "SIGINT"])
def test_ended_client_ends_petsc_processes(ranks, tmp_path, end):
    """After exit, SIGKILL or SIGINT of the main process no process and no file remains."""
    folder = tmp_path / "of client"
    folder.mkdir()
    environment = os.environ | {"TMPDIR": str(folder)}
    with subprocess.Popen(
        [sys.executable, "-c", SCRIPT],
        env=environment,
        cwd=Path(__file__).parents[3],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
    ) as script:
        assert float(script.stdout.readline()) == pytest.approx(150.0, rel=1e-10)
        assert len(processes(str(folder))) >= ranks
        if end == "exit":
            script.stdin.close()
        else:
            script.send_signal(getattr(signal, end))
        script.wait()
    assert_nothing_left(folder)


def test_deleted_petsc_factor_leaves_no_files(ranks, tmp_path):
    assert ranks
    symbolic = analyse(CHAIN)
    symbolic.factorise()
    folder = next(tmp_path.iterdir())
    assert len(list(folder.glob("*-values.npy"))) == 1
    del symbolic
    assert not list(folder.glob("*-*.npy"))


def test_petsc_name_has_versions_and_ranks(ranks):
    """The name in results has the versions of PETSc and MUMPS and the number of ranks."""
    plural = "" if ranks == 1 else "s"
    name = solver_name()
    assert name.startswith("PETSc 3.")
    assert ", MUMPS 5." in name
    gamg = "GAMG (statics of solids beyond the memory)"
    assert name.endswith(f"(sparse LDLᵀ), {gamg} on {ranks} rank{plural}")


def test_petsc_memory_is_checked_before_factoring(ranks, monkeypatch):
    """One byte less of free memory than the estimate is refused."""
    assert ranks
    symbolic = analyse(diags_array([np.full(20_000, 2.0)], offsets=[0], format="csr"))
    assert 20_000 * 16 < symbolic.peak_bytes < 1e9
    function_name = "fem.solvers.backends.factor_checks.available_memory"
    monkeypatch.setattr(function_name, lambda: symbolic.peak_bytes - 1)
    with pytest.raises(ComputationError, match="leg 2: factorising 20000 unknowns needs about"):
        symbolic.factorise("leg 2")


@pytest.mark.parametrize("text", ["0", "-1", "two", "1.5", "100000"])
def test_invalid_rank_count_is_refused(monkeypatch, text):
    """FLEXPROOF_RANKS is a whole number from 1 on, also if another solver is requested."""
    monkeypatch.setenv(RANKS_VARIABLE, text)
    message = f'FLEXPROOF_RANKS = "{text}": must be a whole number from 1 to'
    with pytest.raises(InputError, match=message):
        requested_ranks()
    with pytest.raises(InputError, match=message):
        request_solver("rslab")


@pytest.mark.parametrize(
    ("interpreter", "reason"),
    [
        ("/nowhere/python", "/nowhere/python does not exist"),
        (sys.executable, "No module named 'petsc4py'"),
        (shutil.which("false"), "ended with code 1: no message"),
    ],
)
def test_missing_petsc_names_packages(monkeypatch, interpreter, reason):
    """No interpreter, no petsc4py, or a failing one: reason and Debian packages in one line."""
    monkeypatch.setenv(VARIABLE, "petsc")
    monkeypatch.setenv(PYTHON_VARIABLE, interpreter)
    with pytest.raises(InputError) as refused:
        analyse(CHAIN)
    assert len(refused.value.faults) == 1
    for words in ("solver petsc: ", reason, "install the Debian packages python3-petsc4py, mpi-"):
        assert words in str(refused.value)


def test_full_temporary_folder_is_reported(ranks, monkeypatch, tmp_path):
    """One line during a factorisation or before the start, with the reason; no files remain."""
    assert ranks
    symbolic = analyse(CHAIN)

    def full(*_, **__):
        raise OSError(ENOSPC, os.strerror(ENOSPC))

    with monkeypatch.context() as patched:
        patched.setattr("numpy.save", full)
        message = r"^leg 2: PETSc on .*flexproof-petsc-\w+: No space left on device$"
        with pytest.raises(ComputationError, match=message):
            symbolic.factorise("leg 2")
        assert_nothing_left(tmp_path)
        patched.setattr("tempfile.mkdtemp", full)
        client._kept.cache_clear()
        with pytest.raises(InputError, match=r"solver petsc: .* No space left on device; install"):
            analyse(CHAIN)


def test_missing_mpiexec_names_package(monkeypatch):
    """One rank needs no mpiexec; three do."""
    monkeypatch.setenv(VARIABLE, "petsc")
    monkeypatch.setenv(PYTHON_VARIABLE, sys.executable)
    monkeypatch.setenv(RANKS_VARIABLE, "3")
    monkeypatch.setattr("fem.solvers.backends.petsc.client._mpiexec", lambda _: "")
    with pytest.raises(InputError, match="several ranks need mpiexec, not found; install"):
        analyse(CHAIN)
