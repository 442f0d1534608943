"""Each leg alone: lumped models and beams against closed forms, solids against beam theory.

In: the legs of a run's robot. Out: cases whose subject is a leg.
"""

from dataclasses import replace

from lumped.mechanism.mechanism import Mechanism
from validation.adequacy.mechanism.path import distinct_legs
from validation.case import Case
from validation.cases.legs import beams, end_restraint, solids


def cases(mechanism: Mechanism) -> tuple[Case, ...]:
    """All of them, in the order of the report; of legs that are alike of the first."""
    legs = distinct_legs(mechanism)
    found = (*beams.cases(legs=legs), *solids.cases(legs=legs), *end_restraint.cases(legs=legs))
    return tuple(replace(case, subject="leg") for case in found)
