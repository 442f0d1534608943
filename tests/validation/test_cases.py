"""All cases on the paper's robot: verdicts, that each of them can fail, and for any mistake.

Every number that a comparison shows can turn its verdict: nothing cancels what it explains. What a
case takes from the memo of its context are its ingredients. Each array in them is made wrong by
itself; where the value or the reference that is shown then moves, the difference that is judged
must move as well. An allowance made of the two numbers that it explains would take the mistake off
again.
"""

from contextlib import suppress
from dataclasses import replace
from itertools import islice
from math import isfinite

import pytest

from lumped.errors import ComputationError
from lumped.robot_file import load_robot
from validation.case import Allowance, Case, Measurement, Relation, Skip
from validation.catalogue import catalogue
from validation.context import Context
from validation.independence.trace import DATA, Asked, disturbed
from validation.results.outcome import judge, perturbed

ROBOT_FILE = load_robot("ifw")
# The cheapest preset: what a case claims and how it judges is the same in all of them.
CONTEXT = Asked(ROBOT_FILE, "quick")
LISTED = [task for task in catalogue(ROBOT_FILE) if isinstance(task, Case)]
# That every number has an independent comparison is the business of test_trace.
CASES = [
    case
    for case in LISTED
    if "quick" in case.presets and not case.id.startswith("guard.independence")
]
# What verifies the program is the same whatever the robot.
MECHANISM = Asked(load_robot("five-bar"), "quick")
OF_MECHANISM = [
    task
    for task in catalogue(MECHANISM.robot_file)
    if isinstance(task, Case) and "quick" in task.presets and task.subject == "robot"
]
# Of ten seconds each time they are computed.
LONG = ("program.parts.fork.calculix.",)
# A part is condensed again, the paper's segments are refined again for each wrong ingredient.
DEAR = ("program.parts.fork.forces.", "program.parts.fork.means", "paper.refined.order-of-")
# An ingredient is wrong by so much, more than any tolerance; a shown number that moves by fewer
# tolerances than these need not turn the verdict.
WRONG, MOVED = 0.15, 3.0
# What both sides are about; that postures close has cases of its own.
GIVEN = (*DATA, "validation.cases.program.guards.solids.block ")
# Arrays of one ingredient that are tried: the first legs, meshes, postures of many alike.
FEW, MOST = 2, 8
# Exact though solids: an identity of energies, of which no mesh leaves anything uncertain.
EXACT_SOLIDS = {"robot.solid.sixty.energy"}


@pytest.fixture(scope="module")
def case(request):
    """The tests of one case stand together, so that it is computed once."""
    return request.param


@pytest.fixture(scope="module")
def computed(case):
    """What the case finds, and the entries of the memo that it asks for."""
    CONTEXT.asked.clear()
    try:
        found = case.measure(CONTEXT)
    except Skip as reason:
        pytest.skip(str(reason))
    return found, frozenset(CONTEXT.asked)


def each(cases, long, dear=()):
    """Cases by id, the long ones with a mark."""

    def marks(case):
        if case.id.startswith(LONG):
            return long
        return dear if case.id.startswith(DEAR) else ()

    return [pytest.param(case, id=case.id, marks=marks(case)) for case in cases]


def test_ids_are_unique_and_every_case_names_its_source():
    ids = [task.id for task in catalogue(ROBOT_FILE)]
    assert len(set(ids)) == len(ids)
    assert all(case.citation and case.tolerance_reason for case in LISTED)


@pytest.mark.parametrize("case", each(CASES, pytest.mark.exhaustive), indirect=True, scope="module")
def test_case_agrees_and_turns_when_its_reference_moves_by_three_tolerances(case, computed):
    sound, _ = computed
    outcome = judge(case, sound, 0.0)
    assert outcome.verdict == "agree", (outcome.measurement, outcome.message)
    # Where one side alone is claimed, from where the claim would just hold.
    margin = max(0.0, -outcome.share)
    assert perturbed(outcome, margin + 3.0) == "disagree"
    if not sound.exact:
        assert isfinite(sound.numerical_uncertainty)
    elif "solid" in case.id and "reduction" not in case.id and "element" not in case.id:
        assert case.id in EXACT_SOLIDS


@pytest.mark.parametrize(
    "case",
    each(CASES, pytest.mark.soak, pytest.mark.exhaustive),
    indirect=True,
    scope="module",
)
def test_no_ingredient_cancels_from_what_is_judged(case, computed):
    assert cancelled(case, *computed) == []


@pytest.mark.soak
@pytest.mark.parametrize("case", each(CASES, ()), indirect=True, scope="module")
def test_none_of_more_arrays_of_an_ingredient_cancels(case, computed):
    assert cancelled(case, *computed, most=MOST) == []


def test_an_allowance_of_the_two_numbers_that_it_explains_is_found():
    """The allowances of earlier versions: what rigid faces change, from the value itself."""
    case = next(case for case in CASES if case.id == "leg1.compliance.solid[c44]")

    def circular(context: Context) -> Measurement:
        measured = case.measure(context)
        return replace(
            measured, allowances=(Allowance("all of it", measured.value - measured.reference),)
        )

    CONTEXT.asked.clear()
    sound = circular(CONTEXT)
    assert cancelled(replace(case, compute=circular), sound, frozenset(CONTEXT.asked))


@pytest.mark.exhaustive
@pytest.mark.parametrize("listed", [pytest.param(case, id=case.id) for case in OF_MECHANISM])
def test_no_ingredient_of_a_mechanism_cancels_either(listed):
    """The five-bar's."""
    MECHANISM.asked.clear()
    try:
        sound = listed.measure(MECHANISM)
    except Skip as reason:
        pytest.skip(str(reason))
    asked = frozenset(MECHANISM.asked)
    assert cancelled(listed, sound, asked, MECHANISM) == []


def cancelled(
    case: Case,
    sound: Measurement,
    asked: frozenset[str],
    context: Asked = CONTEXT,
    most: int = FEW,
) -> list[str]:
    """Ingredients that move what the case shows and not what it judges."""
    found = []
    for key in sorted(key for key in asked if not key.startswith(GIVEN)):
        for number, other in enumerate(islice(disturbed(context.entry(key), WRONG), most)):
            with suppress(Skip, ComputationError, ValueError):
                wrong = case.measure(context.with_other(key, other))
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
