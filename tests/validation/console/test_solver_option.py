"""Option `--solver` and its environment variable: checked, passed to processes, then reset."""

import os
import warnings

import pytest
from fake_card import forget_card, insert_card

from fem.solvers.backends.choice import SolverFallbackWarning
from lumped.solver_request import VARIABLE, Solver, requested_solver
from meshes.processes import in_own_process
from validation import cli
from validation.run.executor import on_cores
from validation.run.provenance import versions
from validation.run.sources import program

SOLVE = ("solve", "five-bar", "--model", "beam")


@pytest.fixture(autouse=True)
def no_request(monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    yield
    forget_card()


def test_unknown_solver_is_refused_in_one_line(command, monkeypatch):
    for words in (SOLVE, ("run",), ("converge",), ("selftest",)):
        assert 'Invalid value "pardiso" for --solver' in command.refused(
            *words, "--solver", "pardiso"
        )
    monkeypatch.setenv(VARIABLE, "pardiso")
    message = command.refused(*SOLVE)
    assert message == 'flexproof: FLEXPROOF_SOLVER = "pardiso": must be auto, rslab or cudss'


def test_cudss_without_its_extra_is_refused(command, monkeypatch):
    monkeypatch.setattr("fem.extras.find_spec", lambda _: None)
    forget_card()
    message = command.refused(*SOLVE, "--solver", "cudss")
    assert "solver cudss: needs cupy and nvmath, not installed; ./flexproof extras gpu" in message
    monkeypatch.setenv(VARIABLE, "cudss")
    assert command.refused(*SOLVE) == message


def test_option_overrules_variable_for_one_command(command, monkeypatch):
    monkeypatch.setenv(VARIABLE, "pardiso")
    command.told(*SOLVE, "--solver", "rslab")
    assert os.environ[VARIABLE] == "pardiso"
    monkeypatch.delenv(VARIABLE)
    command.told(*SOLVE, "--solver", "rslab")
    assert VARIABLE not in os.environ


def test_request_reaches_processes(monkeypatch):
    monkeypatch.setenv(VARIABLE, "rslab")
    assert in_own_process(requested_solver) is Solver.RSLAB
    with on_cores(1) as cores:
        assert list(cores([requested_solver])) == [(0, Solver.RSLAB)]


def warn_of_fallback():
    warnings.warn("graphics card: lost", SolverFallbackWarning, stacklevel=1)
    warnings.warn("of no interest", RuntimeWarning, stacklevel=1)
    return 1


def test_solver_warning_of_process_is_repeated():
    with pytest.warns(SolverFallbackWarning, match="graphics card: lost") as caught:
        assert in_own_process(warn_of_fallback) == 1
    assert len(caught) == 1


def test_solver_warnings_are_one_line_of_command(command, monkeypatch, capsys):
    """Three equal warnings give one line. Results and exit code are unchanged."""
    plain = command.told(*SOLVE)
    monkeypatch.setattr(
        "validation.cli.require_room", lambda _: [warn_of_fallback() for _ in range(3)]
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)
        assert cli.main(SOLVE) == 0
    printed = capsys.readouterr()
    assert printed.out == plain
    assert printed.err == "flexproof: graphics card: lost\n"


def test_version_and_provenance_name_the_solver(command, monkeypatch):
    insert_card(monkeypatch)
    for request, expected in (("cudss", "cuDSS 0.8.0 on fake card"), ("rslab", "rslab")):
        monkeypatch.setenv(VARIABLE, request)
        assert f"linear solver: {expected}" in command.told("--version")
        assert versions()["linear solver"].startswith(expected)


def test_cache_keys_depend_on_request(monkeypatch):
    keys = set()
    for request in ("auto", "rslab", "cudss"):
        monkeypatch.setenv(VARIABLE, request)
        keys |= {program(), program("fem")}
    assert len(keys) == 6
    meshes = set()
    for request in ("auto", "rslab"):
        monkeypatch.setenv(VARIABLE, request)
        meshes.add(program("lumped", "meshes"))
    assert len(meshes) == 1
