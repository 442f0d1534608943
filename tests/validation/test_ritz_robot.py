"""The biglide by Ritz's method against trusses by hand and against models without shared code."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from lumped.biglide import with_equivalent_legs
from lumped.robot_file import load_robot
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.options import ModelOptions
from validation.studies import ritz_robot

IFW = load_robot("ifw").robot
OFFSET = replace(IFW, tool_offset=np.array([0.03, -0.02, 0.155]))
SPRING = replace(OFFSET, tool_compliance=np.diag([1e-9, 2e-9, 5e-10, 3e-6, 2e-6, 4e-6]))
ROBOTS = {
    "feet": IFW,
    "rigid feet": replace(IFW, foot_compliance=None),
    "tool offset": OFFSET,
    "tool spring": SPRING,
}


def test_in_the_plane_of_rigid_feet_the_legs_are_bars():
    robot = with_equivalent_legs(ROBOTS["rigid feet"])
    at = robot.posture(0.3)
    stiffness = np.zeros((2, 2))
    for leg, root in ((robot.leg1, at.root1), (robot.leg2, at.root2)):
        along = (at.tip - root)[:2] / leg.length
        stiffness += leg.timoshenko.EA / leg.length * np.outer(along, along)
    found = ritz_robot.compliance(robot, 0.3)[:2, :2]
    assert found == pytest.approx(np.linalg.inv(stiffness), rel=1e-9)


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
@pytest.mark.parametrize("share", [0.05, 0.5, 0.98])
def test_statics_are_those_of_virtual_joints(robot, share):
    x = robot.stroke[0] + share * robot.stroke_length
    reference = robot_compliance("vjm", robot, x, ModelOptions(legs="equivalent"))
    scale = np.sqrt(np.outer(np.diag(reference), np.diag(reference)))
    # Rounding, grown by the condition of the robot.
    assert np.abs((ritz_robot.compliance(robot, x) - reference) / scale).max() < 1e-9


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_frequencies_are_what_beams_converge_to(robot):
    x = robot.centre
    found = ritz_robot.frequencies(robot, x, 4)
    coarse, fine = (
        robot_frequencies("beam", robot, x, 4, ModelOptions(elements=elements))
        for elements in (10, 20)
    )
    # Fourth order: what is left is a fifteenth of the last step; a third more for the next term.
    left = (coarse - fine) / 15.0
    assert np.all(np.abs(fine - found - left) < 0.34 * left + 1e-9 * found)


def test_polynomials_converge_from_above():
    by_degree = [ritz_robot.frequencies(IFW, 0.4, 4, degree) for degree in (4, 6, 8, 14)]
    for lower, higher in pairwise(by_degree):
        assert np.all(lower >= higher * (1.0 - 1e-11))
