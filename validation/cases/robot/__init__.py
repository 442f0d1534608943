"""The whole biglide over its stroke: its models against each other.

In: the robot of a run. Out: cases whose subject is the robot.
"""

from validation.case import Case
from validation.cases.mechanism import calculix
from validation.cases.robot import (
    modes,
    reduction,
    sixty,
    solid,
    stroke,
)


def cases() -> tuple[Case, ...]:
    """All of them, in the order of the report."""
    return (
        *stroke.cases(),
        *solid.cases(),
        *modes.cases(),
        *reduction.cases(),
        *sixty.cases(),
        *calculix.cases_of_biglide(places=calculix.PLACES),
    )
