"""Request of a library by a command, checked before anything is computed.

Commands import it for their help: libraries of numbers are imported only if they are requested.
"""

import os

from fem.extras import missing_message
from lumped.errors import InputError
from lumped.solver_request import VARIABLE, Solver, requested_solver


def request_solver(name: str | None) -> None:
    """Request a library for this process and those that it starts; None leaves the environment's.

    Raises InputError for an unknown name, and if cuDSS is requested and cannot be used.
    """
    if name is not None:
        os.environ[VARIABLE] = name
    require_usable(requested_solver())


def require_usable(request: Solver) -> None:
    """Raise InputError if cuDSS is requested and its packages or a card are missing."""
    if request is not Solver.CUDSS:
        return
    if message := missing_message("gpu"):
        raise InputError(f"solver cudss: {message}")
    from fem.solvers.backends import cudss  # noqa: PLC0415

    if cudss.device() is None:
        raise InputError("solver cudss: CUDA finds no graphics card; must be auto or rslab")
