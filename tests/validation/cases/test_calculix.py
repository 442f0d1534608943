"""CalculiX as a case of a mechanism's run: it agrees, it can disagree, and it may be missing."""

import shutil
from dataclasses import replace

import numpy as np
import pytest

from fem.calculix import run as calculix_run
from lumped.mechanism.joint import Drive
from lumped.robot_file import load_robot
from validation.case import Skip
from validation.cases import other_programs
from validation.cases.other_programs import by_calculix, by_reduced, farthest_entry
from validation.context import Context
from validation.kinematics.poses import postures_of
from validation.solids.bars import with_bars

needs_calculix = pytest.mark.skipif(
    not any(map(shutil.which, calculix_run.PROGRAMS)), reason="CalculiX (ccx) is not installed"
)


def first_pose(mechanism):
    return postures_of(mechanism, mechanism.poses[:1])[0]


@needs_calculix
@pytest.mark.exhaustive
def test_a_five_bar_of_bars_and_one_whose_drive_is_off(monkeypatch):
    """A thousandth of a drive's stiffness is seen; without it both agree to the digits printed."""
    at = first_pose(load_robot("five-bar").mechanism)
    (own, frequencies), (theirs, their_frequencies) = by_reduced(at), by_calculix(at)
    value, reference = farthest_entry(own, theirs)
    assert abs(value - reference) < 1e-6
    np.testing.assert_allclose(frequencies, their_frequencies, rtol=1e-6)
    correct = other_programs.compliance_and_frequencies

    def off(posture, legs, modes):
        joints = tuple(
            replace(joint, drive=Drive(1.001 * joint.drive.stiffness)) if joint.drive else joint
            for joint in posture.mechanism.joints
        )
        mechanism = replace(posture.mechanism, joints=joints)
        return correct(replace(posture, mechanism=mechanism), legs, modes)

    monkeypatch.setattr(other_programs, "compliance_and_frequencies", off)
    theirs, _ = by_calculix(at)
    value, reference = farthest_entry(own, theirs)
    assert abs(value - reference) > 1e-4


def test_bars_have_the_outer_size_of_the_legs():
    at = first_pose(load_robot("delta").mechanism)
    for name, body in with_bars(at).mechanism.bodies.items():
        shape = at.mechanism.bodies[name].shape
        if hasattr(shape, "section"):
            assert body.shape.section.extent == shape.section.extent
            assert body.shape.section.area > shape.section.area


def test_without_calculix_both_cases_say_so(monkeypatch):
    monkeypatch.setattr(calculix_run, "PROGRAMS", ("no-such-program",))
    robot = load_robot("five-bar")
    asked = [
        case
        for case in other_programs.cases(mechanism=robot.mechanism)
        if case.group == "mechanism.calculix"
    ]
    assert len(asked) == 2
    for case in asked:
        with pytest.raises(Skip, match="is not installed"):
            case.measure(Context(robot, "standard"))
