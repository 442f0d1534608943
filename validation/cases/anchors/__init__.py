"""Numbers of the first screen and of the paper's table, each by a way that shares the data alone.

In: the robot of a run. Out: cases against geometry, polynomials along the legs, and CalculiX.
"""

from dataclasses import replace

from lumped.mechanism.mechanism import Mechanism
from validation.case import Case
from validation.cases.anchors import first_screen, legs, mechanism, reference, robot


def of_biglide(modes: int) -> tuple[Case, ...]:
    """Of the biglide and of its legs; `modes` frequencies are judged."""
    alone = (*legs.cases(), *reference.cases_of_legs())
    return (
        *(replace(case, subject="leg") for case in alone),
        *robot.cases(),
        *first_screen.cases(modes=modes),
        *reference.cases(),
        *reference.cases_of_masses(modes=modes),
    )


def of_mechanism(described: Mechanism, modes: int) -> tuple[Case, ...]:
    """Of any other mechanism."""
    return mechanism.cases(mechanism=described, modes=modes)


def paper_cases() -> tuple[Case, ...]:
    """Of the paper's robot alone."""
    return robot.paper_cases()
