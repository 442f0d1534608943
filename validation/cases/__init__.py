"""A robot against what shares nothing with its models: polynomials, waves, other programs.

In: the mechanism of a run. Out: cases whose subject is the robot, or one of its legs alone.
"""

from lumped.mechanism.mechanism import Mechanism
from validation.case import Case
from validation.cases import leg_theory, other_programs, part_reductions, polynomials
from validation.references.robot_on_path import distinct_legs


def cases(described: Mechanism, modes: int) -> tuple[Case, ...]:
    """All of them, in the order of the report: of legs that are alike of the first.

    `modes` frequencies of the robot are judged.
    """
    return (
        *leg_theory.cases(legs=distinct_legs(described)),
        *part_reductions.cases(mechanism=described),
        *other_programs.cases(mechanism=described),
        *polynomials.cases(mechanism=described, modes=modes),
    )
