"""A robot over its path: its models against each other, Ritz, CalculiX, EXUDYN.

In: the mechanism of a run. Out: cases whose subject is the robot.
"""

from lumped.mechanism.mechanism import Mechanism
from validation.case import Case
from validation.cases.mechanism import calculix, exudyn, first_screen, parts, path, solids


def cases(described: Mechanism, modes: int) -> tuple[Case, ...]:
    """All of them, in the order of the report; `modes` frequencies are judged."""
    return (
        *path.cases(),
        *solids.cases(),
        *(parts.cases() if described.parts else ()),
        *calculix.cases(),
        *exudyn.cases(mechanism=described),
        *first_screen.cases(mechanism=described, modes=modes),
    )
