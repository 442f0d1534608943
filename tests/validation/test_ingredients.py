"""Every number that a comparison shows can turn its verdict: nothing cancels what it explains.

What a case takes from the memo of its context are its ingredients. Each array in them is made
wrong by itself; where the value or the reference that is shown then moves, the difference that is
judged must move as well. An allowance made of the two numbers that it explains would take the
mistake off again.
"""

from contextlib import suppress
from dataclasses import replace
from itertools import islice

import pytest

from lumped.errors import ComputationError
from lumped.robot_file import load_robot
from validation.case import Allowance, Case, Measurement, Relation, Skip, judge
from validation.catalogue import catalogue
from validation.context import Context
from validation.independence.trace import DATA, Watched, disturbed

ROBOT_FILE = load_robot("ifw")
CASES = [
    task
    for task in catalogue(ROBOT_FILE)
    if isinstance(task, Case) and "quick" in task.presets and "decision." not in task.id
]
CONTEXT = Watched(ROBOT_FILE, "quick")
# An ingredient is wrong by so much, more than any tolerance; a shown number that moves by fewer
# tolerances than these need not turn the verdict.
WRONG, MOVED = 0.15, 3.0
# What both sides are about; that postures close has cases of its own.
GIVEN = (*DATA, "validation.cases.program.guards.solids.block ")
# Cases that take ten seconds each time they are computed, with every ingredient.
LONG = ("program.parts.fork.calculix.", "guard.independence")
# Arrays of one ingredient that are tried: the first legs, meshes, postures of many alike.
MOST = 8


def cancelled(case: Case) -> list[str]:
    """Ingredients that move what the case shows and not what it judges."""
    CONTEXT.asked.clear()
    sound = case.compute(CONTEXT)
    found = []
    for key in sorted(key for key in CONTEXT.asked if not key.startswith(GIVEN)):
        for number, other in enumerate(islice(disturbed(CONTEXT.entry(key), WRONG), MOST)):
            with suppress(Skip, ComputationError, ValueError):
                wrong = case.compute(CONTEXT.with_other(key, other))
                shown = max(
                    abs(wrong.value - sound.value),
                    abs(wrong.reference - sound.reference),
                )
                tolerance = case.tolerance.at(sound.reference)
                stays = judge(case, wrong, 0.0).verdict == "agree"
                if case.relation is not Relation.EQUAL:
                    # A bound may be kept better: what is judged must move with what is shown.
                    stays = abs(wrong.unexplained - sound.unexplained) < 0.2 * shown
                if shown > MOVED * tolerance and stays:
                    found.append(f"{key.split()[0]}, part {number}: {shown:.3g} {case.unit} shown")
    return found


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(
            case,
            id=case.id,
            marks=[pytest.mark.soak] if case.id.startswith(LONG) else [],
        )
        for case in CASES
    ],
)
def test_no_ingredient_cancels_from_what_is_judged(case):
    try:
        assert cancelled(case) == []
    except Skip as reason:
        pytest.skip(str(reason))


def test_an_allowance_of_the_two_numbers_that_it_explains_is_found():
    """The allowances of earlier versions: what rigid faces change, from the value itself."""
    case = next(case for case in CASES if case.id == "leg1.compliance.solid[c44]")

    def circular(context: Context) -> Measurement:
        measured = case.compute(context)
        return replace(
            measured, allowances=(Allowance("all of it", measured.value - measured.reference),)
        )

    assert cancelled(replace(case, compute=circular))
