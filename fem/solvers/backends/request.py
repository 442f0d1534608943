"""Request of a library by a command of the user, checked before anything is computed.

Commands import this module for their help. Numerical libraries are imported only if they are
requested.
"""

import os
from pathlib import Path

from lumped.errors import InputError
from lumped.solver_request import (
    HOSTS_VARIABLE,
    RANKS_VARIABLE,
    VARIABLE,
    Solver,
    rank_count,
    read_hosts,
    requested_hosts,
    requested_ranks,
    requested_solver,
)

REINSTALL = "install rslab again (pip install --force-reinstall rslab)"


def request_solver(name: str | None, ranks: int | None = None, hosts: Path | None = None) -> None:
    """Request the library `name` for this process and for the processes that it starts.

    If `name` is None, the request in the environment remains. `ranks` is the number of MPI ranks of
    PETSc, and `hosts` is a file with the names of the machines that run them. Raises InputError if
    the name is unknown, if ranks or hosts are given for another library than PETSc, or if the
    requested library cannot be used.
    """
    if name is not None:
        os.environ[VARIABLE] = name
    request = requested_solver()
    for option, value in (("--ranks", ranks), ("--hosts", hosts)):
        if value is not None and not request.is_petsc:
            raise InputError(f"{option} {value}: needs --solver petsc or gamg")
    if hosts is not None:
        read_hosts(hosts)
        os.environ[HOSTS_VARIABLE] = str(hosts.absolute())
    if ranks is not None:
        os.environ[RANKS_VARIABLE] = str(rank_count(str(ranks), "--ranks", len(requested_hosts())))
    requested_ranks()
    require_usable(request)


def require_usable(request: Solver) -> None:
    """Raise InputError if the requested library, one of its packages or a card is missing."""
    if request.is_petsc:
        from fem.solvers.backends.petsc import client  # noqa: PLC0415

        client.server()
    if request is Solver.RSLAB:
        from fem.solvers.backends import rslab  # noqa: PLC0415

        if reason := rslab.load_error():
            raise InputError(f"solver rslab: cannot be loaded ({reason}); {REINSTALL}")
    if request is not Solver.CUDSS:
        return
    from fem.solvers.backends import cudss  # noqa: PLC0415

    if reason := cudss.device_fault():
        raise InputError(f"solver cudss: {reason}; must be auto, rslab, petsc or gamg")
