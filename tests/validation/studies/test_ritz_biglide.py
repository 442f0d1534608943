"""The biglide by Ritz's method against trusses by hand and against models without shared code."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from lumped.biglide import with_equivalent_legs
from lumped.legs import ConstantLeg, Material, equivalent_leg, tip_compliance
from lumped.robot_file import load_robot
from lumped.sections import Tube
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.options import ModelOptions
from validation.studies.ritz import biglide as ritz

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
    found = ritz.compliance(robot, 0.3)[:2, :2]
    assert found == pytest.approx(np.linalg.inv(stiffness), rel=1e-9)


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
@pytest.mark.parametrize("share", [0.05, 0.5, 0.98])
def test_statics_are_those_of_virtual_joints(robot, share):
    x = robot.stroke[0] + share * robot.stroke_length
    reference = robot_compliance("vjm", robot, x, ModelOptions(legs="equivalent"))
    scale = np.sqrt(np.outer(np.diag(reference), np.diag(reference)))
    # Rounding, grown by the condition of the robot.
    assert np.abs((ritz.compliance(robot, x) - reference) / scale).max() < 1e-9


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_frequencies_are_what_beams_converge_to(robot):
    x = robot.centre
    found = ritz.frequencies(robot, x, 4)
    coarse, fine = (
        robot_frequencies("beam", robot, x, 4, ModelOptions(elements=elements))
        for elements in (10, 20)
    )
    # Fourth order: what is left is a fifteenth of the last step; a third more for the next term.
    left = (coarse - fine) / 15.0
    assert np.all(np.abs(fine - found - left) < 0.34 * left + 1e-9 * found)


def test_polynomials_converge_from_above():
    by_degree = [ritz.frequencies(IFW, 0.4, 4, "timoshenko", degree) for degree in (4, 6, 8, 14)]
    for lower, higher in pairwise(by_degree):
        assert np.all(lower >= higher * (1.0 - 1e-11))


@pytest.mark.parametrize("theory", ["timoshenko", "euler-bernoulli"])
def test_a_leg_alone_is_the_textbook_cantilever(theory):
    leg = equivalent_leg(IFW.leg1)
    beam = leg.properties(theory)
    found = ritz.clamped_leg(leg, theory)
    length = leg.length
    assert found[2, 2] == pytest.approx(length**3 / (3.0 * beam.EIy) + length / beam.GAz, rel=1e-9)
    assert found[3, 3] == pytest.approx(length / beam.GJ, rel=1e-9)
    assert found[1, 5] == pytest.approx(length**2 / (2.0 * beam.EIz), rel=1e-9)
    assert found[2, 4] == pytest.approx(-(length**2) / (2.0 * beam.EIy), rel=1e-9)


def test_a_lump_on_a_rigid_robot_part_swings_on_the_stiffness_of_its_own_6x6():
    """With masses of nothing the platform alone swings: 1/ω² = m times the softest compliance."""
    light = replace(
        IFW,
        leg1=replace(IFW.leg1, mass=1e-6, inertia=None),
        leg2=replace(IFW.leg2, mass=1e-6, inertia=None),
    )
    soft = np.linalg.eigvalsh(IFW.platform_mass * ritz.compliance(light, 0.4, "given")[:3, :3])[-1]
    found = ritz.frequencies_with_masses(light, 0.4, 1, lumped=True)
    assert found[0] == pytest.approx(1.0 / (2.0 * np.pi * np.sqrt(soft)), rel=1e-6)


def test_springs_of_the_legs_own_6x6_are_the_legs_as_given():
    found = ritz.of_springs(IFW, 0.4, IFW.leg1.compliance, IFW.leg2.compliance)
    np.testing.assert_allclose(found, ritz.compliance(IFW, 0.4, "given"), rtol=1e-12)


@pytest.mark.parametrize("theory", ["timoshenko", "euler-bernoulli"])
def test_a_foil_of_a_tube_turns_by_its_own_torsion(theory):
    # Beside the stiffness along such a leg rounding took 2e-4 of its torsion, 3e-5 without shear.
    leg = ConstantLeg(90.0, Tube(2e-4, 1e-6), Material(2.1e11, 1.05e9, -0.9, 7850.0))
    expected = np.diag(tip_compliance(leg.properties(theory), leg.length))
    assert np.diag(ritz.clamped_leg(leg, theory)) == pytest.approx(expected, rel=3e-6)
