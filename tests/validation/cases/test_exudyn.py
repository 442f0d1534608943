"""EXUDYN as a case of a mechanism's run: it agrees, it can disagree, and it may be missing."""

from dataclasses import replace
from importlib.util import find_spec

import numpy as np
import pytest
from written_robot import robot_of

from fem import multibody
from lumped.errors import InputError
from lumped.mechanism.joint import Drive
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from validation.case import Skip
from validation.cases import other_programs
from validation.cases.other_programs import BEAM_MODES, by_both
from validation.context import Context
from validation.results.outcome import judge

needs_exudyn = pytest.mark.skipif(
    find_spec("exudyn") is None, reason="EXUDYN (extra exudyn) is not installed"
)


def of_exudyn(mechanism):
    listed = other_programs.cases(mechanism=mechanism)
    return [case for case in listed if case.group == "mechanism.exudyn"]


@needs_exudyn
@pytest.mark.slow
def test_first_six_frequencies():
    """Within 1e-4, and what is left open is said to be more than that."""
    own, theirs, uncertain = by_both(reference_posture(load_robot("delta").mechanism))
    assert len(theirs) == BEAM_MODES
    np.testing.assert_allclose(own.frequencies, theirs, rtol=1e-4)
    assert (np.abs(own.frequencies - theirs) < uncertain).all()


@needs_exudyn
def test_a_drive_that_is_off_is_seen(monkeypatch):
    mechanism = load_robot("five-bar").mechanism
    correct = multibody.frequencies

    def off(at, elements, count):
        joints = tuple(
            replace(joint, drive=Drive(1.01 * joint.drive.stiffness)) if joint.drive else joint
            for joint in at.mechanism.joints
        )
        return correct(replace(at, mechanism=replace(mechanism, joints=joints)), elements, count)

    def verdicts():
        context = Context(load_robot("five-bar"), "quick")
        return [judge(case, case.measure(context), 0.0).verdict for case in of_exudyn(mechanism)]

    assert verdicts() == ["agree", "agree"]
    monkeypatch.setattr(other_programs, "frequencies", off)
    assert verdicts() == ["disagree", "disagree"]


_PROPPED = """
schema = 2
name = "propped"
[points]
A = [0.0, 0.0, 0.0]
B = [0.3, 0.1, 0.05]
C = [0.3, 0.1, 0.25]
[materials]
steel = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
[bodies.base]
from = "A"
to = "B"
section = { shape = "circle", diameter = 0.03 }
material = "steel"
[bodies.arm]
from = "B"
to = "C"
section = { shape = "i-section", width = 0.03, height = 0.04, flange = 0.004, web = 0.004 }
material = "steel"
[joints]
foot = { type = "fixed", between = ["ground", "base"], at = "A" }
elbow = { type = "fixed", between = ["base", "arm"], at = "B" }
table = { type = "planar", between = ["ground", "arm"], at = "C", axis = [0.0, 1.0, 1.0] }
[tool]
body = "arm"
point = "C"
moves = []
mass = 1.0
"""


@needs_exudyn
def test_a_frame_on_a_plane(tmp_path):
    """Planar and fixed joints, a section of two stiffnesses; one posture, hence one case."""
    mechanism = robot_of(_PROPPED, tmp_path).mechanism
    assert len(of_exudyn(mechanism)) == 1
    own, theirs, uncertain = by_both(reference_posture(mechanism))
    np.testing.assert_allclose(own.frequencies, theirs, rtol=5e-4)
    assert (np.abs(own.frequencies - theirs) < uncertain).all()


def test_without_exudyn_the_cases_say_so(monkeypatch):
    robot = load_robot("five-bar")

    def missing(_name):
        raise multibody.PackageNotFoundError

    monkeypatch.setattr(multibody, "version", missing)
    for case in of_exudyn(robot.mechanism):
        with pytest.raises(Skip, match=r"flexproof\[exudyn\]"):
            case.measure(Context(robot, "quick"))


def test_what_is_not_written_for_it_is_named():
    """A leg of a 6×6, a body without mass and a joint that gives, each on a line of its own."""
    mechanism = load_robot("ifw").mechanism
    with pytest.raises(InputError) as raised:
        multibody.require_beams(mechanism)
    said = "\n".join(raised.value.faults)
    assert "leg1: EXUDYN's beams have a section; this body is a 6×6" in said
    assert "without mass" in said
    assert "joints that give" in said
