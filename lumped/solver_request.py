"""Request for the library that factorises large sparse systems.

It is the value of a variable of the environment, which the option `--solver` sets and processes
inherit.
"""

import os
from enum import StrEnum

from lumped.errors import InputError

VARIABLE = "FLEXPROOF_SOLVER"


class Solver(StrEnum):
    """A library by its name, or the one that suits the size of a system and the machine."""

    AUTO = "auto"
    RSLAB = "rslab"
    CUDSS = "cudss"


def requested_solver() -> Solver:
    """Request of the environment. Raises InputError for an unknown name."""
    name = os.environ.get(VARIABLE, "").strip() or Solver.AUTO
    try:
        return Solver(name)
    except ValueError:
        raise InputError(f'{VARIABLE} = "{name}": must be auto, rslab or cudss') from None
