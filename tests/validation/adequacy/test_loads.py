"""Verdicts on the robot's own loads: the plain error of a plain displacement, shares and µm."""

from dataclasses import replace

import numpy as np
import pytest
from one_arm import LOADS, ONE_ARM

from lumped.acceptance.requirement import Requirement
from lumped.robot_file import load_robot
from validation.adequacy.judgement import judged
from validation.adequacy.mechanism.path import robot_on_path
from validation.adequacy.models import judged_models
from validation.adequacy.response import OPEN_LINEAR, OPEN_MASSES, SAY_LINEAR, Subject
from validation.adequacy.robot import static_subject
from validation.context import Context
from validation.models.loads.displacements import displacements
from validation.models.loads.stability import stabilities
from validation.models.loads.stability_notes import stability_notes
from validation.models.options import ModelOptions

pytestmark = pytest.mark.usefixtures("coarse_legs")

PATH = """
[path]
from = [-0.1]
to = [0.2]
count = 3
"""


@pytest.fixture(scope="module")
def arm(tmp_path_factory):
    path = tmp_path_factory.mktemp("loads") / "arm.toml"
    path.write_text(ONE_ARM + PATH + LOADS, encoding="utf-8")
    return load_robot(str(path))


@pytest.fixture(scope="module")
def subject(arm) -> Subject:
    robot = robot_on_path(Context(arm, "quick"))
    return static_subject(robot, judged_models(arm.mechanism))


def test_the_error_under_a_load_is_that_of_the_whole_displacement(arm, subject):
    """By the solid model of `solve` as the truth, which differs from the reference by its mesh."""
    matrix = judged(subject, arm.requirement)
    postures = robot_on_path(Context(arm, "quick")).postures
    truth = displacements("solid", postures, ModelOptions(divisions=3, ends="rigid"))[:, :, :3]
    for model in ("simplified", "vjm", "segments", "beam-euler-bernoulli"):
        kind, _, options = judged_models(arm.mechanism)[model]
        found = displacements(kind, postures, options)[:, :, :3]
        errors = np.linalg.norm(found - truth, axis=2) / np.linalg.norm(truth, axis=2)
        for column, name in enumerate(("weight", "cutting", "stop")):
            entry = matrix.entry(model, f"load:{name}")
            assert entry is not None
            told, left = np.array(entry.errors), np.array(entry.spreads)
            assert (np.abs(told - errors[:, column]) <= left + 2e-3).all(), (model, name)
    strict = Requirement(deflection=1e-4, loads=arm.requirement.loads)
    entry = judged(subject, strict).entry("beam-euler-bernoulli", "load:weight")
    (first, *_) = entry.causes
    assert (entry.verdict, first.cause) == ("undecided", "shear deformation neglected")
    assert first.share == pytest.approx(1.0, abs=0.05)


def test_a_limit_in_metres_takes_the_place_of_a_share(arm, subject):
    wanted = arm.requirement
    entry = judged(subject, wanted).entry("simplified", "load:cutting")
    missed = entry.error * entry.expected
    for limit, verdict in ((2.0 * missed, "adequate"), (0.5 * missed, "inadequate")):
        own = Requirement(loads=wanted.loads, deflection=1e-6, displacement=limit)
        found = judged(subject, own).entry("simplified", "load:cutting")
        assert found.verdict == verdict
        assert found.limit == pytest.approx(limit / found.expected, rel=0.02)
        assert judged(subject, own).entry("simplified", "x").limit == 1e-6


def test_where_masses_of_given_legs_lie_is_an_interval_of_weight_alone(tmp_path):
    text = load_robot("ifw").text + (
        '\n[[loads]]\nname = "weight"\ngravity = [0.0, 0.0, -9.81]\n'
        '[[loads]]\nname = "push"\nwrench = [0.0, 0.0, 100.0, 0.0, 0.0, 0.0]\n'
        '[[loads]]\nname = "stop"\nacceleration = [1.0, 0.0, 0.0]\n'
    )
    path = tmp_path / "ifw.toml"
    path.write_text(text, encoding="utf-8")
    file = load_robot(str(path))
    file = replace(file, mechanism=replace(file.mechanism, poses=file.mechanism.poses[::4]))
    robot = robot_on_path(Context(file, "quick"))
    wanted = Requirement(deflection=0.005, loads=file.requirement.loads)
    links = {"links": judged_models(file.mechanism)["links"]}
    matrix = judged(static_subject(robot, links), wanted)
    weight, push, stop = (matrix.entry("links", f"load:{n}") for n in ("weight", "push", "stop"))
    # From nothing to what other places of the mass make of it.
    assert weight.error == pytest.approx(weight.uncertainty, rel=0.01)
    assert weight.uncertainties[OPEN_MASSES] > 0.01 > 10.0 * push.uncertainty
    assert OPEN_MASSES not in push.uncertainties
    assert weight.verdict == "undecided"
    assert "mass_centre" in weight.reason
    # At both ends of its stroke nothing can stop: there is nothing to be wrong about.
    assert stop.errors[0] == 0.0 == stop.errors[-1]
    assert stop.uncertainty > 0.0


def test_a_load_that_softens_what_it_meets_is_judged_by_no_linear_model(tmp_path):
    """Pressed with a fifth of k/L, which turns the drive over, the arm yields 1/(5 − 1) more."""
    press = '[[loads]]\nname = "press"\nwrench = [10.0, -2.0e4, 0.0, 0.0, 0.0, 0.0]\n'
    path = tmp_path / "arm.toml"
    path.write_text(ONE_ARM + PATH.replace("-0.1", "-0.001").replace("0.2", "0.001") + press)
    robot = robot_on_path(Context(load_robot(str(path)), "quick"))
    found = stabilities("links", robot.postures)
    requirement = robot.context.robot_file.requirement
    middle = found[1][0]
    assert middle.factor == pytest.approx(5.0, rel=0.1)
    assert middle.farther == pytest.approx(1.0 / (middle.factor - 1.0), rel=0.1)
    assert middle.lost[0] == pytest.approx(1.0 / middle.factor, rel=0.1)
    (note,) = stability_notes(robot.postures, found, requirement)
    assert note.startswith("Load press: buckles the robot at 4.")
    assert note.endswith(
        "no linear model sees: more than the 5\N{NO-BREAK SPACE}% that are accepted"
    )
    matrix = judged(static_subject(robot, judged_models(robot.mechanism)), requirement)
    pressed, free = (matrix.entry("vjm", one) for one in ("load:press", "x"))
    assert (pressed.verdict, free.verdict) == ("undecided", "adequate")
    assert pressed.reason == SAY_LINEAR
    assert pressed.uncertainties[OPEN_LINEAR] == pytest.approx(middle.farther, rel=0.1)
    assert OPEN_LINEAR not in free.uncertainties
