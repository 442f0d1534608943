"""Each leg alone: lumped models and beams against closed forms, solids against beam theory.

In: the legs of a run's robot. Out: cases whose subject is a leg.
"""

from dataclasses import replace

from validation.case import Case
from validation.cases.legs import beams, end_restraint, solids


def cases() -> tuple[Case, ...]:
    """All of them, in the order of the report."""
    found = (*beams.cases(), *solids.cases(), *end_restraint.cases())
    return tuple(replace(case, subject="leg") for case in found)
