"""Choice of the library that factorises large sparse systems.

The choice is stored in environment variables, which the options `--solver` and `--ranks` set and
which child processes inherit.
"""

import os
from enum import StrEnum

from lumped.errors import InputError

VARIABLE, RANKS_VARIABLE = "FLEXPROOF_SOLVER", "FLEXPROOF_RANKS"
# Variable for the path of a Python with petsc4py, and the path if the variable is not set.
PYTHON_VARIABLE, SYSTEM_PYTHON = "FLEXPROOF_PETSC_PYTHON", "/usr/bin/python3"
# Largest number of MPI ranks, or the number of cores if that is larger.
_LARGEST_RANKS = 4


class Solver(StrEnum):
    """Library for sparse factorisation.

    AUTO selects it by the size of the system and the machine.
    """

    AUTO = "auto"
    RSLAB = "rslab"
    CUDSS = "cudss"
    PETSC = "petsc"


def requested_solver() -> Solver:
    """Library requested by the environment variable. Raises InputError for an unknown name."""
    name = os.environ.get(VARIABLE, "").strip() or Solver.AUTO
    try:
        return Solver(name)
    except ValueError:
        raise InputError(f'{VARIABLE} = "{name}": must be auto, rslab, cudss or petsc') from None


def requested_ranks() -> int:
    """Number of MPI ranks for petsc: 1 unless requested. Raises InputError for a wrong number."""
    return rank_count(os.environ.get(RANKS_VARIABLE, "").strip() or "1", RANKS_VARIABLE)


def rank_count(text: str, source: str) -> int:
    """Number of MPI ranks from a text. Raises InputError, with `source` in its message."""
    largest = max(_LARGEST_RANKS, os.cpu_count() or 1)
    if not text.isdecimal() or not 1 <= int(text) <= largest:
        raise InputError(
            f'{source} = "{text}": must be a whole number from 1 to {largest} (the number of '
            f"cores, at least {_LARGEST_RANKS})"
        )
    return int(text)


def petsc_python() -> str:
    """Path of the Python interpreter that has petsc4py."""
    return os.environ.get(PYTHON_VARIABLE, "").strip() or SYSTEM_PYTHON


def requested_library() -> str:
    """Text that identifies the requested library. For petsc it includes ranks and interpreter.

    Results of different libraries differ by round-off, so that the text is part of cache keys.
    """
    request = requested_solver()
    if request is not Solver.PETSC:
        return request.value
    return f"{request.value} {requested_ranks()} {petsc_python()}"


def request_variables() -> dict[str, str]:
    """Environment variables with which another process requests the same library."""
    return {VARIABLE: requested_solver().value, RANKS_VARIABLE: str(requested_ranks())}
