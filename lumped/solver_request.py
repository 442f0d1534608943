"""Request for the library that factorises large sparse systems.

It is the value of variables of the environment, which the options `--solver` and `--ranks` set and
processes inherit.
"""

import os
from enum import StrEnum

from lumped.errors import InputError

VARIABLE, RANKS_VARIABLE = "FLEXPROOF_SOLVER", "FLEXPROOF_RANKS"
# Path of a Python that has petsc4py, and the path if it is not set.
PYTHON_VARIABLE, SYSTEM_PYTHON = "FLEXPROOF_PETSC_PYTHON", "/usr/bin/python3"
# Largest number of ranks on a machine with few cores; with more cores, their number.
_LARGEST_RANKS = 4


class Solver(StrEnum):
    """A library by its name, or the one that suits the size of a system and the machine."""

    AUTO = "auto"
    RSLAB = "rslab"
    CUDSS = "cudss"
    PETSC = "petsc"


def requested_solver() -> Solver:
    """Request of the environment. Raises InputError for an unknown name."""
    name = os.environ.get(VARIABLE, "").strip() or Solver.AUTO
    try:
        return Solver(name)
    except ValueError:
        raise InputError(f'{VARIABLE} = "{name}": must be auto, rslab, cudss or petsc') from None


def requested_ranks() -> int:
    """Ranks of MPI for the solver petsc: one unless requested. Raises InputError."""
    return rank_count(os.environ.get(RANKS_VARIABLE, "").strip() or "1", RANKS_VARIABLE)


def rank_count(text: str, source: str) -> int:
    """Number of ranks in a text. Raises InputError, naming the text's source."""
    largest = max(_LARGEST_RANKS, os.cpu_count() or 1)
    if not text.isdecimal() or not 1 <= int(text) <= largest:
        raise InputError(
            f'{source} = "{text}": must be a whole number from 1 to {largest} (the number of '
            f"cores, at least {_LARGEST_RANKS})"
        )
    return int(text)


def petsc_python() -> str:
    """Path of the Python that has petsc4py."""
    return os.environ.get(PYTHON_VARIABLE, "").strip() or SYSTEM_PYTHON


def requested_library() -> str:
    """The request, with ranks and Python of petsc: results differ by rounding between them."""
    request = requested_solver()
    if request is not Solver.PETSC:
        return request.value
    return f"{request.value} {requested_ranks()} {petsc_python()}"


def request_variables() -> dict[str, str]:
    """Variables of the environment that repeat this process's request elsewhere."""
    return {VARIABLE: requested_solver().value, RANKS_VARIABLE: str(requested_ranks())}
