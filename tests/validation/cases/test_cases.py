"""All comparisons of two robots: verdicts, and mistakes that each comparison must detect.

Every number that a comparison shows can change its verdict. The ingredients of a case are the
results that it reads from the memo of its context. The tests falsify one array of an ingredient at
a time. If the displayed value or reference then changes, the judged difference must change as well.
An allowance computed from the value and the reference that it explains would cancel the mistake.
Cases with common ingredients form a group, and each group has one test.
"""

import re
from collections import defaultdict
from contextlib import suppress
from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from support.oracles.changed_values import changed_leaves
from support.oracles.shifted_references import assert_agrees_and_can_disagree
from support.robots.pendulum import PENDULUM
from support.robots.robot_from_text import robot_of

from lumped.errors import ComputationError
from lumped.robot_file import load_robot
from validation.case import Allowance, Case, Relation, Skip
from validation.catalogue import catalogue
from validation.context import Context
from validation.run.outcome import judge
from validation.run.runner import execute
from validation.studies_and_figures import PlannedFigure


class Noted(dict):
    """A memo that records the keys that are read."""

    def __init__(self):
        super().__init__()
        self.keys_read = set()

    def __getitem__(self, key):
        self.keys_read.add(key)
        return super().__getitem__(key)


# The cheapest preset: what a case claims and how it judges is the same in all of them.
CONTEXTS = {name: Context(load_robot(name), "quick", _memo=Noted()) for name in ("ifw", "five-bar")}
TASKS = {name: catalogue(context.robot_file) for name, context in CONTEXTS.items()}
GROUPS = defaultdict(list)
for _robot, _tasks in TASKS.items():
    for _task in _tasks:
        if isinstance(_task, Case) and "quick" in _task.presets:
            GROUPS[_robot, _task.group].append(_task)
# The same cases of ifw, or of its other leg, are always run.
SLOW = {
    ("five-bar", "robot.solid.modes"),
    ("ifw", "leg1.solid"),
    ("ifw", "leg1.modes"),
    ("five-bar", "rod1.solid"),
}
# The slowest group: modes of a robot with legs as solids.
SLOWEST = ("five-bar", "robot.solid.modes")
# Groups of which the quick preset compares nothing, and the reasons.
BEYOND_QUICK = {
    ("ifw", "mechanism.exudyn"): "the EXUDYN comparison needs a section",
    (
        "five-bar",
        "rod1.modes",
    ): "preset fine allows them|: only solid rectangles are meshed with tetrahedra",
    ("five-bar", "crank1.modes"): "preset fine allows them|: only solid rectangles are meshed",
}
# Reasons for which some cases of the other groups are skipped.
SOME = {
    ("ifw", "leg2.modes"): "beam theory is not valid below 3",
    ("ifw", "mechanism.lumped"): "^model simplified",
    ("five-bar", "mechanism.lumped"): "^model simplified",
    # Of one section mesh; orders need two.
    ("five-bar", "crank1.solid"): "preset standard allows them",
    ("five-bar", "rod1.solid"): "preset standard allows them",
}
# The paper's statements are judged and turned where their numbers are tested, in test_claims.
OTHERS = [
    pytest.param(group, marks=pytest.mark.soak if group == SLOWEST else pytest.mark.exhaustive)
    if group in SLOW
    else group
    for group in GROUPS
    if group[1] != "paper" and group not in BEYOND_QUICK
]
# An ingredient is wrong by so much, more than any tolerance; a shown number that moves by fewer
# tolerances than these need not turn the verdict. Of many arrays that are alike few are tried.
WRONG, MOVED, FEW = 0.15, 3.0, 2
# What both sides of a comparison are about: the robot's data and its postures.
DATA = (
    "lumped.equivalent_leg.equivalent_leg ",
    "validation.references.robot_on_path._postures ",
    "validation.comparisons.robot_beam_vs_solid._constant_posture ",
)


def test_one_mode_robot_has_reasoned_skips(tmp_path):
    """Comparisons of modes or compliances that a robot does not have are skipped, not failed."""
    bob = robot_of(f"{PENDULUM}[path]\nposes = [[0.0], [0.3]]\n", tmp_path)
    context = Context(bob, "quick")
    cases = [task for task in catalogue(context.robot_file) if isinstance(task, Case)]
    compared = {execute(case, context).verdict for case in cases if "quick" in case.presets}
    assert compared == {"agree", "skipped"}


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("ifw", {"mechanism.deflections", "deflection.stroke"}),
        ("five-bar", {f"mechanism.{n}" for n in ("deflections", "frequencies", "mode-shapes")}),
    ],
)
def test_cases_have_ids_sources_and_figures(name, expected):
    """Unique ids, a source and a reason for each tolerance, and figures that exist."""
    ids = {task.id for task in TASKS[name]}
    assert len(ids) == len(TASKS[name])
    cases = [task for task in TASKS[name] if isinstance(task, Case)]
    assert all(case.citation and case.tolerance_reason for case in cases)
    figures = {task.id for task in TASKS[name] if isinstance(task, PlannedFigure)}
    assert expected <= {case.figure for case in cases} <= figures | {""}


def measured(group):
    """List of (case, measurement) of the group `group`, and the reasons of its skipped cases."""
    measurements, reasons = [], []
    for case in GROUPS[group]:
        try:
            measurements.append((case, case.measure(CONTEXTS[group[0]])))
        except Skip as skip:
            reasons.append(str(skip))
    return measurements, reasons


@pytest.mark.parametrize("group", OTHERS, ids=" ".join)
def test_shifted_reference_makes_case_disagree(group):
    """Each case agrees, and with a reference moved beyond its tolerance it disagrees."""
    measurements, reasons = measured(group)
    if any("not installed" in reason for reason in reasons):
        pytest.skip(reasons[0])
    assert measurements
    assert not reasons or group in SOME
    assert all(re.search(SOME[group], reason) for reason in reasons)
    for case, measurement in measurements:
        assert_agrees_and_can_disagree(judge(case, measurement, 0.0))


@pytest.mark.parametrize("group", BEYOND_QUICK, ids=" ".join)
def test_quick_run_skips_large_groups(group):
    """Groups that are too large for preset quick, each with its reason."""
    measurements, reasons = measured(group)
    assert not measurements
    assert reasons
    assert all(re.search(BEYOND_QUICK[group], reason) for reason in reasons)


@pytest.mark.soak
@pytest.mark.parametrize("group", GROUPS, ids=" ".join)
def test_shared_input_does_not_cancel(group):
    """An error in an input that value and reference share must change their difference."""
    assert [line for case in GROUPS[group] for line in cancelled(case, CONTEXTS[group[0]])] == []


def test_allowance_from_own_value_is_detected():
    """Earlier versions computed the effect of rigid end faces from the compared value itself."""
    case = next(case for case in TASKS["ifw"] if case.id == "leg2.compliance.solid[c44]")

    def circular(context):
        measurement = case.measure(context)
        return replace(
            measurement,
            allowances=(Allowance("all of it", measurement.value - measurement.reference),),
        )

    assert cancelled(replace(case, compute=circular), CONTEXTS["ifw"])


def larger(value):
    """Yield ("", value times 1 + WRONG) for a float or an array of floats, otherwise nothing."""
    if isinstance(value, float | np.floating | np.ndarray) and np.asarray(value).dtype.kind == "f":
        yield "", value * (1.0 + WRONG)


def cancelled(case, context):
    """Ingredients whose mistake changes the displayed numbers of a case but not its judgement."""
    memo, ingredients = context._memo, []
    memo.keys_read.clear()
    try:
        sound = case.measure(context)
    except Skip:
        return []
    for key in sorted(key for key in memo.keys_read if not key.startswith(DATA)):
        for leaf, other in islice(changed_leaves(memo[key], larger), FEW):
            with suppress(Skip, ComputationError, ValueError):
                wrong = case.measure(replace(context, _memo={**memo, key: other}))
                change = max(abs(wrong.value - sound.value), abs(wrong.reference - sound.reference))
                stays = judge(case, wrong, 0.0).verdict == "agree"
                if case.relation is not Relation.EQUAL:
                    # A bound may be kept better: what is judged must move with what is shown.
                    stays = abs(wrong.unexplained - sound.unexplained) < 0.2 * change
                if change > MOVED * case.tolerance.at(sound.reference) and stays:
                    ingredients.append(f"{key.split()[0]}{leaf}: {change:.3g} {case.unit} shown")
    return ingredients
