"""Parts of the program: drawn and meshed by gmsh, written to files, and read as a user's are.

What is made of them stands beside integrals over the drawing, beside counted forces and beside
another program.
"""

from validation.case import Case
from validation.cases.program.parts import bar, fork, reduced, shaft, wedge


def cases() -> tuple[Case, ...]:
    """A shaft in closed form and in a robot, a fork whole and reduced, a wedge, a bar."""
    return (
        *shaft.cases(),
        *fork.cases(),
        *reduced.cases(),
        *wedge.cases(),
        *bar.cases(),
    )
