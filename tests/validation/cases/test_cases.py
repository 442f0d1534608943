"""All comparisons of two robots: verdicts, that each of them can fail, and for any mistake.

Every number that a comparison shows can turn its verdict: nothing cancels what it explains. What a
case takes from the memo of its context are its ingredients. Each array in them is made wrong by
itself; where the value or the reference that is shown then moves, the difference that is judged
must move as well. An allowance made of the two numbers that it explains would take the mistake off
again. One test for each group of cases, which share what they are computed from.
"""

from contextlib import suppress
from dataclasses import replace
from itertools import islice

import pytest
from ingredients import DATA, Asked, disturbed, quick_context
from perturbed import assert_agrees_and_can_turn

from lumped.errors import ComputationError
from lumped.robot_file import load_robot
from validation.case import Allowance, Case, Measurement, Relation, Skip
from validation.catalogue import catalogue
from validation.context import Context
from validation.results.outcome import judge
from validation.session.runner import execute

RIGID = """
schema = 2
name = "slide"
[points]
O = [0.0, 0.0, 0.0]
P = [0.0, 0.0, 0.2]
[bodies.slide]
points = ["O", "P"]
mass = 5.0
centre = "P"
inertia = [[0.1, 0.0, 0.0], [0.0, 0.1, 0.0], [0.0, 0.0, 0.1]]
[joints.a]
type = "prismatic"
between = ["ground", "slide"]
at = "O"
axis = [1.0, 0.0, 0.0]
drive = { stiffness = 1e7 }
[tool]
body = "slide"
point = "P"
moves = ["x"]
[path]
from = [0.0]
to = [0.3]
count = 2
"""
# The cheapest preset: what a case claims and how it judges is the same in all of them.
CONTEXTS = {name: quick_context(name) for name in ("ifw", "five-bar")}
LISTED = {
    name: [task for task in catalogue(context.robot_file) if isinstance(task, Case)]
    for name, context in CONTEXTS.items()
}
# An ingredient is wrong by so much, more than any tolerance; a shown number that moves by fewer
# tolerances than these need not turn the verdict.
WRONG, MOVED = 0.15, 3.0
# Arrays of one ingredient that are tried: the first legs, meshes, postures of many alike.
FEW = 2


def groups():
    """Robot and group of the cases of preset quick."""
    found = {}
    for name, cases in LISTED.items():
        for case in cases:
            if "quick" in case.presets:
                found.setdefault((name, case.group), []).append(case)
    return found


GROUPS = groups()
# A quarter of a minute; the same cases of ifw are always run.
SLOW = {("five-bar", "robot.solid.modes")}
# The paper's statements are judged and turned where their numbers are tested, in test_claims.
OTHERS = [
    pytest.param(of, marks=pytest.mark.exhaustive) if of in SLOW else of
    for of in GROUPS
    if of[1] != "paper"
]


def test_a_robot_of_one_mode_and_no_give_is_told_what_cannot_be_compared(tmp_path):
    """Fewer modes than are judged, and a chain without any compliance: not a failed run."""
    (tmp_path / "robot.toml").write_text(RIGID)
    robot_file = load_robot(tmp_path / "robot.toml")
    context = Context(robot_file, "quick")
    compared = [
        execute(case, context).verdict
        for case in catalogue(robot_file)
        if isinstance(case, Case) and "quick" in case.presets
    ]
    assert set(compared) == {"agree", "skipped"}


def measured(case, context):
    context.asked.clear()
    try:
        return case.measure(context)
    except Skip:
        return None


@pytest.mark.parametrize("name", LISTED)
def test_ids_are_unique_and_every_case_names_its_source(name):
    ids = [task.id for task in catalogue(CONTEXTS[name].robot_file)]
    assert len(set(ids)) == len(ids)
    assert all(case.citation and case.tolerance_reason for case in LISTED[name])


@pytest.mark.parametrize("of", OTHERS, ids=" ".join)
def test_cases_agree_and_turn_when_their_references_move_by_three_tolerances(of):
    for case in GROUPS[of]:
        sound = measured(case, CONTEXTS[of[0]])
        if sound is None:
            continue
        assert_agrees_and_can_turn(judge(case, sound, 0.0))


@pytest.mark.soak
@pytest.mark.parametrize("of", GROUPS, ids=" ".join)
def test_no_ingredient_cancels_from_what_is_judged(of):
    assert [line for case in GROUPS[of] for line in cancelled(case, CONTEXTS[of[0]])] == []


def test_an_allowance_of_the_two_numbers_that_it_explains_is_found():
    """The allowances of earlier versions: what rigid faces change, from the value itself."""
    case = next(case for case in LISTED["ifw"] if case.id == "leg1.compliance.solid[c44]")

    def circular(context: Context) -> Measurement:
        found = case.measure(context)
        return replace(found, allowances=(Allowance("all of it", found.value - found.reference),))

    assert cancelled(replace(case, compute=circular), CONTEXTS["ifw"])


def cancelled(case: Case, context: Asked) -> list[str]:
    """Ingredients that move what the case shows and not what it judges."""
    found: list[str] = []
    sound, asked = measured(case, context), frozenset(context.asked)
    for key in sorted(key for key in asked if sound and not key.startswith(DATA)):
        for number, other in enumerate(islice(disturbed(context.entry(key), WRONG), FEW)):
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
