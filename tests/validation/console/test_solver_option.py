"""Option `--solver` and its environment variable: checked, passed to processes, then reset."""

import json
import os
import warnings
from types import SimpleNamespace

import numpy as np
import pytest
from support.fakes.graphics_card import discard_card, insert_card
from support.fakes.petsc_installation import require_petsc

from fem.solvers.backends.choice import SolverFallbackWarning
from lumped.errors import InputError
from lumped.solver_request import (
    RANKS_VARIABLE,
    VARIABLE,
    Solver,
    request_variables,
    requested_ranks,
    requested_solver,
)
from meshes.processes import in_own_process
from validation import cli
from validation.run import cluster
from validation.run.cache import program
from validation.run.executor import on_cores
from validation.run.provenance import versions

SOLVE = ("solve", "five-bar", "--model", "beam")


@pytest.fixture(autouse=True)
def no_request(monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.delenv(RANKS_VARIABLE, raising=False)
    yield
    discard_card()


def test_unknown_solver_is_refused(command, monkeypatch):
    """By option in four commands, and by FLEXPROOF_SOLVER."""
    for words in (SOLVE, ("run",), ("converge",), ("selftest",)):
        assert 'Invalid value "pardiso" for --solver' in command.error_line(
            *words, "--solver", "pardiso"
        )
    monkeypatch.setenv(VARIABLE, "pardiso")
    message = command.error_line(*SOLVE)
    allowed = "must be auto, rslab, cudss, petsc or gamg"
    assert message == f'flexproof: FLEXPROOF_SOLVER = "pardiso": {allowed}'


def test_cudss_without_extra_is_refused(command, monkeypatch):
    """The message has the missing packages and the command that adds them."""
    monkeypatch.setattr("fem.extras.find_spec", lambda _: None)
    discard_card()
    message = command.error_line(*SOLVE, "--solver", "cudss")
    assert "solver cudss: needs cupy and nvmath, not installed; ./flexproof extras gpu" in message
    monkeypatch.setenv(VARIABLE, "cudss")
    assert command.error_line(*SOLVE) == message


def test_invalid_ranks_are_refused(command, monkeypatch):
    """--ranks 0, and --ranks without --solver petsc or gamg."""
    for words in (SOLVE, ("run",), ("converge",), ("selftest",)):
        message = command.error_line(*words, "--solver", "petsc", "--ranks", "0")
        assert message.startswith('flexproof: --ranks = "0": must be a whole number from 1 to ')
        message = command.error_line(*words, "--solver", "rslab", "--ranks", "2")
        assert message == "flexproof: --ranks 2: needs --solver petsc or gamg"
    assert "--ranks" in command.error_line(*SOLVE, "--ranks", "two")
    monkeypatch.setenv(RANKS_VARIABLE, "two")
    assert 'FLEXPROOF_RANKS = "two": must be a whole number' in command.error_line(*SOLVE)


def test_missing_petsc_is_refused(command, monkeypatch):
    """Reason, Debian packages and the environment variable, in one line."""
    monkeypatch.setenv("FLEXPROOF_PETSC_PYTHON", "/nowhere/python")
    assert command.error_line(*SOLVE, "--solver", "petsc") == (
        "flexproof: solver petsc: /nowhere/python does not exist; install the Debian packages "
        "python3-petsc4py, mpi-default-bin and libopenblas0-serial, or set FLEXPROOF_PETSC_PYTHON "
        "to a Python with petsc4py and MUMPS"
    )


@pytest.mark.soak
def test_petsc_equals_rslab(command, monkeypatch):
    """Solid five-bar on two ranks: compliances to 1e-10, frequencies to 1e-9."""
    require_petsc()
    words = ("solve", "five-bar", "--model", "solid", "--modes", "3", "--json")
    expected = json.loads(command.output(*words, "--solver", "rslab"))
    by_petsc = json.loads(command.output(*words, "--solver", "petsc", "--ranks", "2"))
    for pose, other in zip(by_petsc["results"], expected["results"], strict=True):
        compliance = np.array(other["compliance"])
        # Those of the contract in test_backends.py.
        size = np.abs(compliance).max()
        np.testing.assert_allclose(pose["compliance"], compliance, rtol=0.0, atol=1e-10 * size)
        np.testing.assert_allclose(pose["frequencies"], other["frequencies"], rtol=1e-9)
    assert RANKS_VARIABLE not in os.environ
    monkeypatch.setenv(VARIABLE, "petsc")
    assert "linear solver: PETSc 3." in command.output("--version")
    assert versions()["linear solver"].startswith("PETSc 3.")


def test_solver_option_overrides_variable(command, monkeypatch):
    """An invalid FLEXPROOF_SOLVER is ignored beside --solver, and unchanged afterwards."""
    monkeypatch.setenv(VARIABLE, "pardiso")
    command.output(*SOLVE, "--solver", "rslab")
    assert os.environ[VARIABLE] == "pardiso"
    monkeypatch.delenv(VARIABLE)
    command.output(*SOLVE, "--solver", "rslab")
    assert VARIABLE not in os.environ


def test_solver_request_reaches_workers(monkeypatch):
    """Child processes and worker processes use the requested solver."""
    monkeypatch.setenv(VARIABLE, "rslab")
    assert in_own_process(requested_solver) is Solver.RSLAB
    with on_cores(1) as cores:
        assert list(cores([requested_solver])) == [(0, Solver.RSLAB)]


class OneWorker:
    """Stand-in for the client of a cluster whose only worker is this process."""

    def run(self, function, request, **_):
        try:
            return {"tcp://worker:1": function(SimpleNamespace(name="worker"), request)}
        except InputError as error:
            return {"tcp://worker:1": error}


def test_solver_request_reaches_cluster(monkeypatch):
    """A worker uses the solver and the ranks of the requesting machine, not its own."""
    monkeypatch.setenv(VARIABLE, "petsc")
    monkeypatch.setenv(RANKS_VARIABLE, "2")
    request = request_variables()
    monkeypatch.setattr(cluster, "request_variables", lambda: request)
    monkeypatch.setenv(VARIABLE, "auto")
    monkeypatch.setenv(RANKS_VARIABLE, "1")
    monkeypatch.setenv("FLEXPROOF_PETSC_PYTHON", "/nowhere/python")
    expected = "--cluster tcp://s: worker tcp://worker:1: solver petsc: /nowhere/python does not"
    with pytest.raises(InputError, match=expected):
        cluster._require_same_program(OneWorker(), "tcp://s")
    assert requested_solver() is Solver.PETSC
    assert requested_ranks() == 2


def warn_of_fallback():
    warnings.warn("graphics card: lost", SolverFallbackWarning, stacklevel=1)
    warnings.warn("of no interest", RuntimeWarning, stacklevel=1)
    return 1


def test_worker_warning_is_repeated():
    """A fallback in a child process gives one warning in this process."""
    with pytest.warns(SolverFallbackWarning, match="graphics card: lost") as caught:
        assert in_own_process(warn_of_fallback) == 1
    assert len(caught) == 1


def test_equal_warnings_give_one_line(command, monkeypatch, capsys):
    """Three equal warnings give one line. Results and exit code are unchanged."""
    plain = command.output(*SOLVE)
    monkeypatch.setattr(
        "validation.cli.require_room", lambda _: [warn_of_fallback() for _ in range(3)]
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        assert cli.main(SOLVE) == 0
    printed = capsys.readouterr()
    assert printed.out == plain
    assert printed.err == "flexproof: graphics card: lost\n"


def test_version_names_the_solver(command, monkeypatch):
    """`flexproof --version` and the versions in results.json."""
    insert_card(monkeypatch)
    for request, expected in (("cudss", "cuDSS 0.8.0 on fake card"), ("rslab", "rslab")):
        monkeypatch.setenv(VARIABLE, request)
        assert f"linear solver: {expected}" in command.output("--version")
        assert versions()["linear solver"].startswith(expected)


def test_cache_keys_depend_on_solver(monkeypatch):
    """Keys of results depend on solver and number of ranks, keys of meshes on neither."""
    keys = set()
    for request, ranks in (("auto", 1), ("rslab", 1), ("cudss", 1), ("petsc", 1), ("petsc", 2)):
        monkeypatch.setenv(VARIABLE, request)
        monkeypatch.setenv(RANKS_VARIABLE, str(ranks))
        keys |= {program(), program("fem")}
    assert len(keys) == 10
    meshes = set()
    for request in ("auto", "rslab"):
        monkeypatch.setenv(VARIABLE, request)
        meshes.add(program("lumped", "meshes"))
    assert len(meshes) == 1
