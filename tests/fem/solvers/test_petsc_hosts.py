"""Hosts of PETSc: faults of their file, and ranks that receive arrays and commands by messages."""

import numpy as np
import pytest
from scipy.sparse import diags_array
from support.fakes.petsc_installation import require_petsc

from fem.solvers.backends.choice import solver_name
from fem.solvers.backends.petsc import client
from fem.solvers.backends.request import request_solver
from fem.solvers.factor import analyse
from fem.solvers.inverse import RenewableIteration, inverse
from lumped.errors import InputError
from lumped.solver_request import (
    HOSTS_VARIABLE,
    RANKS_VARIABLE,
    VARIABLE,
    read_hosts,
    request_variables,
    requested_ranks,
)


@pytest.fixture
def hosts(tmp_path):
    """Function that writes a hostfile."""

    def written(text):
        path = tmp_path / "hosts"
        path.write_text(text)
        return path

    return written


@pytest.mark.parametrize(
    ("text", "fault"),
    [
        ("# none\n\n", "hosts: has no host; must have one name per line"),
        ("localhost\nnowhere.invalid\n", 'hosts, line 2: "nowhere.invalid" is unknown'),
        ("localhost\n\nlocalhost\n", 'hosts, line 3: "localhost" is there twice'),
        # Addresses reserved for documentation (RFC 5737) belong to no machine.
        ("192.0.2.1 slots=4\n", 'hosts, line 1: "192.0.2.1" is not this machine; the first'),
    ],
)
def test_invalid_host_file_is_refused(hosts, text, fault):
    """Empty file, unknown or repeated host, or another machine first: file and line are named."""
    with pytest.raises(InputError) as refused:
        read_hosts(hosts(text))
    assert len(refused.value.faults) == 1
    assert fault in str(refused.value)


def test_missing_host_file_is_refused(tmp_path, monkeypatch):
    """`--hosts` without `--solver petsc` or `gamg` is refused, too."""
    monkeypatch.setenv(VARIABLE, "petsc")
    missing = tmp_path / "hosts"
    with pytest.raises(InputError, match=r"hosts: No such file or directory; must be a hostfile"):
        request_solver(None, None, missing)
    with pytest.raises(InputError, match=f"--hosts {missing}: needs --solver petsc or gamg"):
        request_solver("rslab", None, missing)


def test_each_host_has_equally_many_ranks(hosts, monkeypatch):
    """By default one per host. Others must be multiples of the number of hosts."""
    monkeypatch.setenv(HOSTS_VARIABLE, str(hosts("127.0.0.1 slots=2 # this\n192.0.2.1\n")))
    monkeypatch.delenv(RANKS_VARIABLE, raising=False)
    assert requested_ranks() == 2
    monkeypatch.setenv(RANKS_VARIABLE, "4")
    assert requested_ranks() == 4
    for ranks in ("1", "3"):
        monkeypatch.setenv(RANKS_VARIABLE, ranks)
        with pytest.raises(InputError, match=r"must be a multiple of the number of hosts, 2"):
            requested_ranks()
    with pytest.raises(InputError, match=r"^--hosts: cannot be combined with --cluster"):
        request_variables()


@pytest.fixture
def local_agent(tmp_path, monkeypatch):
    """Make mpiexec start the ranks of other hosts on this machine, by the loopback device."""
    agent = tmp_path / "agent"
    agent.write_text('#!/bin/sh\nshift\neval "$*"\n')
    agent.chmod(0o700)
    monkeypatch.setenv("OMPI_MCA_plm_rsh_agent", str(agent))
    for layer in ("btl", "oob"):
        monkeypatch.setenv(f"OMPI_MCA_{layer}_tcp_if_include", "lo")


@pytest.mark.usefixtures("local_agent")
def test_ranks_of_two_hosts_solve_by_messages(hosts, monkeypatch):
    """Two addresses of this machine are two hosts. Only rank 0 reads files and commands."""
    monkeypatch.setenv(VARIABLE, "petsc")
    monkeypatch.setenv(HOSTS_VARIABLE, str(hosts("127.0.0.1\n127.0.0.2\n")))
    monkeypatch.delenv(RANKS_VARIABLE, raising=False)
    require_petsc()
    try:
        assert solver_name().endswith(" on 2 ranks on 127.0.0.1, 127.0.0.2")
        size = 300
        chain = diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(size, size), format="csr")
        nodes = np.arange(1, size + 1)
        # Displacements of the chain under unit forces at all nodes: a parabola.
        parabola = nodes * (size + 1 - nodes) / 2.0
        symbolic = analyse(chain)
        loads = np.column_stack([np.ones(size), -np.ones(size)])
        # Error of the solution: the condition number, 4e4, times 1e-16.
        expected = np.column_stack([parabola, -parabola])
        np.testing.assert_allclose(symbolic.factorise().solve(loads), expected, rtol=1e-10)
        monkeypatch.setenv(VARIABLE, "gamg")
        motions = np.tile(np.eye(6), (size // 6, 1))
        places = nodes[:, None] * np.array([1.0, 0.0, 0.0])
        iteration = inverse(symbolic, motions, places, "chain")
        assert type(iteration) is RenewableIteration
        np.testing.assert_allclose(iteration.solve(loads), expected, rtol=1e-8)
    finally:
        client.server().end()
