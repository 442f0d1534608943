"""What verifies the program, not the robot of a run: guards, benchmarks, shapes, meshes, elements.

They are computed on the built-in robot, whatever robot the run is about.
"""

from dataclasses import replace

from validation.case import Case
from validation.cases.program import (
    benchmarks,
    calculix,
    guards,
    mesh_families,
    parts,
    refinement,
    shapes,
)


def cases() -> tuple[Case, ...]:
    """All of them, in the order of the report."""
    found = (
        *refinement.cases(),
        *mesh_families.cases(),
        *shapes.cases(),
        *calculix.cases(),
        *benchmarks.cases(),
        *guards.cases(),
        *parts.cases(),
    )
    return tuple(replace(case, subject="program") for case in found)
