"""All cases on the paper's robot: their verdicts, and that each of them can fail."""

from dataclasses import replace

import pytest

from lumped.robot_file import load_robot
from validation.case import Case, Skip, judge, perturbed
from validation.catalogue import catalogue
from validation.context import Context
from validation.sweeps.studies import PLANS

ROBOT_FILE = load_robot("ifw")
# The cheapest preset: what a case claims and how it judges is the same in all of them.
CONTEXT = Context(ROBOT_FILE, "quick")
# The decision is left to larger presets for its time and its second mesh alone.
DECIDING = Context(ROBOT_FILE, "standard")
CASES = [
    task
    for task in catalogue(ROBOT_FILE)
    if isinstance(task, Case) and ("quick" in task.presets or "decision." in task.id)
]


@pytest.fixture(autouse=True, scope="module")
def few_designs():
    """The standard preset decides among the designs of the quick one."""
    plan = replace(PLANS["quick"], divisions=2, coarse=1)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(PLANS, "standard", plan)
        yield


def test_ids_are_unique_and_every_case_names_its_source():
    ids = [task.id for task in catalogue(ROBOT_FILE)]
    assert len(set(ids)) == len(ids)
    assert all(case.citation and case.tolerance_reason for case in CASES)


# Comparisons of ten seconds each.
LONG = ("program.parts.fork.calculix.", "guard.independence")


def long_ones_apart(cases):
    """Each robot of the decision is made of solids: half a minute for a handful of comparisons."""
    for case in cases:
        short = "quick" in case.presets and not case.id.startswith(LONG)
        marks = () if short else pytest.mark.exhaustive
        yield pytest.param(case, marks=marks, id=case.id)


@pytest.mark.parametrize("case", list(long_ones_apart(CASES)))
def test_case_agrees_and_turns_when_its_reference_moves_by_three_tolerances(case):
    try:
        measurement = case.compute(CONTEXT if "quick" in case.presets else DECIDING)
    except Skip as reason:
        pytest.skip(str(reason))
    outcome = judge(case, measurement, 0.0)
    assert outcome.verdict == "agree", (outcome.measurement, outcome.message)
    # Where one side alone is claimed, from where the claim would just hold.
    margin = max(0.0, -outcome.share)
    assert perturbed(outcome, margin + 3.0) == "disagree"
