"""What verifies the program, not the robot of a run: benchmarks, parts.

They are computed on the built-in robot, whatever robot the run is about.
"""

from dataclasses import replace

from validation.case import Case
from validation.cases.program import (
    benchmarks,
    parts,
)


def cases() -> tuple[Case, ...]:
    """All of them, in the order of the report."""
    found = (
        *benchmarks.cases(),
        *parts.cases(),
    )
    return tuple(replace(case, subject="program") for case in found)
