"""All formulations of whole robots compared with solid legs: verdicts, explained differences."""

from dataclasses import replace
from functools import cache

import pytest
from support.robots.crane import write_crane

from lumped.acceptance.requirement import DEFAULT_LIMITS
from lumped.robot_file import load_robot
from validation.case import Skip
from validation.comparisons import robot_beam_vs_solid
from validation.comparisons.agreement_cases import DISTORTION, FORMULA, HELD_FACES
from validation.comparisons.robot_beam_vs_solid import cases, constant_posture
from validation.context import Context
from validation.models.options import ModelOptions
from validation.report.agreement import agreement_tables
from validation.run.outcome import judge
from validation.verdicts import Coordinate

BY_ID = {case.id: case for case in cases(limits=DEFAULT_LIMITS)}


@cache
def context_of(name):
    """Context of the built-in robot `name`. The tests share its solids."""
    return Context(load_robot(name), "quick")


def outcome_of(name, identifier):
    case = BY_ID[identifier]
    return judge(case, case.measure(context_of(name)), 0.0)


def shares(outcome):
    """Explained differences by cause, relative to the reference value."""
    measurement = outcome.measurement
    return {
        allowance.cause: allowance.amount / measurement.reference
        for allowance in measurement.allowances
    }


def test_robot_case_ids_are_stable():
    """Four models with six unit loads, two with four frequencies."""
    assert len(BY_ID) == 4 * 6 + 2 * 4
    assert "robot.agrees[beam-solid-f1]" in BY_ID
    assert "robot.agrees[vjm-solid-φz]" in BY_ID
    assert {case.kind for case in BY_ID.values()} == {"agreement"}


@pytest.mark.parametrize("model", ["segments", "beam"])
def test_biglide_f1_agrees_with_solids(model):
    """f1 = 112.396 Hz at x = 0.4975 m by beams, 0.5 % lower than with solid legs and rigid ends."""
    outcome = outcome_of("ifw", f"robot.agrees[{model}-solid-f1]")
    measurement = outcome.measurement
    assert outcome.verdict == "agree"
    assert measurement.pose == pytest.approx((0.4975,))
    (table,) = agreement_tables([outcome], [Coordinate("x", "m")])
    assert table.subject == "robot at x = 0.4975 m"
    assert agreement_tables([outcome])[0].subject == "robot"
    assert measurement.value == pytest.approx(112.396, abs=2e-3)
    assert measurement.difference / measurement.reference == pytest.approx(-0.0053, abs=5e-4)
    assert abs(measurement.unexplained) < 1e-4 * measurement.reference


@pytest.mark.parametrize("model", ["vjm", "links", "segments", "beam"])
@pytest.mark.parametrize("motion", ["x", "z", "φx", "φz"])
def test_biglide_differs_by_rigid_faces(model, motion):
    """Restrained warping of the legs makes the robot 2.9 % stiffer about x, and not along x."""
    outcome = outcome_of("ifw", f"robot.agrees[{model}-solid-{motion}]")
    measurement = outcome.measurement
    assert outcome.verdict == "agree"
    assert abs(measurement.unexplained) < 1e-6 * measurement.reference
    expected = {"x": 0.0, "z": 0.0118, "φx": 0.0288, "φz": 0.0}[motion]
    assert shares(outcome)[HELD_FACES] == pytest.approx(expected, abs=1e-4)
    assert shares(outcome)[FORMULA] == pytest.approx(0.0, abs=1e-4)


def test_thin_walled_frequencies_agree():
    """Boxes of the five-bar: textbook torsion constants explain 1.4 % of f3, rigid faces 0.6 %."""
    outcome = outcome_of("five-bar", "robot.agrees[beam-solid-f3]")
    assert outcome.verdict == "agree"
    assert shares(outcome)[FORMULA] == pytest.approx(-0.0141, abs=5e-4)
    assert shares(outcome)[HELD_FACES] == pytest.approx(-0.0058, abs=5e-4)
    assert abs(outcome.measurement.unexplained) < 1e-4 * outcome.measurement.reference
    fourth = outcome_of("five-bar", "robot.agrees[beam-solid-f4]")
    assert shares(fourth)[DISTORTION] == pytest.approx(0.0007, abs=1e-4)


def test_branching_robot_skips_only_vjm():
    """The virtual joint method needs legs that are serial chains."""
    with pytest.raises(Skip, match="serial chains"):
        BY_ID["robot.agrees[vjm-solid-x]"].measure(context_of("delta"))
    assert outcome_of("delta", "robot.agrees[links-solid-x]").verdict == "agree"


# Options of the judged model that are mistakes, and what they change beyond the limit.
MISTAKES = {
    "shear left out": (ModelOptions(theory="euler-bernoulli"), "beam-solid-z"),
    "literal layout": (ModelOptions(layout="literal"), "segments-solid-φz"),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_wrong_leg_model_disagrees(monkeypatch, mistake):
    """Beams without shear in z, and the literal layout of segments in φz."""
    options, name = MISTAKES[mistake]
    monkeypatch.setattr(robot_beam_vs_solid, "DEFAULT_OPTIONS", options)
    context = Context(load_robot("ifw"), "quick")
    case = BY_ID[f"robot.agrees[{name}]"]
    assert judge(case, case.measure(context), 0.0).verdict == "disagree"


def test_too_few_elements_disagree():
    """With two segments per leg, f4 is too far from that of the solid."""
    by_id = {case.id: case for case in cases(limits=replace(DEFAULT_LIMITS, elements=2))}
    case = by_id["robot.agrees[segments-solid-f4]"]
    assert judge(case, case.measure(context_of("ifw")), 0.0).verdict == "disagree"


def changed(context, function, change):
    """Copy of the context with `change` applied to the stored results of `function`."""
    name = f"{function.__module__}.{function.__qualname__} "
    memo = {
        key: change(value) if key.startswith(name) else value
        for key, value in context._memo.items()
    }
    return replace(context, _memo=memo)


@pytest.mark.parametrize("field", ["specified_ends", "computed"])
def test_wrong_input_is_unexplained(field):
    """One of the frequencies from which the allowances are computed is 3 % off."""
    outcome_of("ifw", "robot.agrees[beam-solid-f2]")

    def change(modes):
        return replace(modes, **{field: 1.03 * getattr(modes, field)})

    context = changed(context_of("ifw"), robot_beam_vs_solid.robot_modes, change)
    case = BY_ID["robot.agrees[beam-solid-f2]"]
    assert judge(case, case.measure(context), 0.0).verdict == "disagree"


def test_model_at_other_pose_disagrees(monkeypatch):
    """The solid legs are in the middle of the path, the judged model at its end."""
    robot_file = load_robot("ifw")
    end = replace(robot_file.mechanism, poses=robot_file.mechanism.poses[:1])
    other = constant_posture(Context(replace(robot_file, mechanism=end), "quick"))
    right = robot_beam_vs_solid.answers

    def elsewhere(model, _postures, count, options):
        return right(model, (other,), count, options)

    # The context finds what it keeps by the function's name.
    monkeypatch.setattr(robot_beam_vs_solid, "answers", elsewhere_named(elsewhere))
    case = BY_ID["robot.agrees[links-solid-x]"]
    assert judge(case, case.measure(Context(robot_file, "quick")), 0.0).verdict == "disagree"


def elsewhere_named(function):
    function.__qualname__ = "elsewhere"
    return function


def test_robot_of_cad_parts_is_skipped(tmp_path):
    """The comparison is for legs of constant section."""
    write_crane(tmp_path)
    context = Context(load_robot(tmp_path / "robot.toml"), "quick")
    for case in BY_ID.values():
        with pytest.raises(Skip, match="arm: this comparison is for legs of constant section"):
            case.measure(context)
