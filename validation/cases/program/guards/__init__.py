"""Guards: what the models must say whatever the robot, where comparisons elsewhere are blind.

Two models that share a mistake agree; each guard holds a part that several share against data put
in again from the beginning.
"""

from validation.case import Case
from validation.cases.program.guards import (
    ends,
    legs,
    modes,
    pairing,
    reduction,
    robot,
    solids,
    sweep,
    waves,
)


def cases() -> tuple[Case, ...]:
    """All of them."""
    return (
        *robot.cases(),
        *legs.cases(),
        *solids.cases(),
        *reduction.cases(),
        *modes.cases(),
        *waves.cases(),
        *ends.cases(),
        *sweep.cases(),
        *pairing.cases(),
    )
