"""A robot against what shares nothing with its models: polynomials, waves, other programs.

In: the mechanism of a run. Out: cases whose subject is the robot, or one of its legs alone.
"""

from lumped.mechanism.mechanism import Mechanism
from validation.case import Case
from validation.cases import leg_theory, other_programs, part_reductions, polynomials
from validation.references.robot_on_path import distinct_legs


def cases(mechanism: Mechanism, mode_count: int) -> tuple[Case, ...]:
    """All cases in the order of the report. Equal legs have the cases of the first of them.

    `mode_count` frequencies of the robot are judged.
    """
    return (
        *leg_theory.cases(legs=distinct_legs(mechanism)),
        *part_reductions.cases(mechanism=mechanism),
        *other_programs.cases(mechanism=mechanism),
        *polynomials.cases(mechanism=mechanism, modes=mode_count),
    )
