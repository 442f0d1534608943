"""The robot assembled from two legs: against shared unknowns, and known values."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from shared_unknowns import by_hand

from lumped import biglide
from lumped.biglide import Biglide, postures, printed, with_equivalent_legs
from lumped.dense.modes import solve_modes
from lumped.dense.statics import solve_statics
from lumped.errors import ComputationError
from lumped.models.segments import segment_chain, segment_leg, with_printed_tip_joint
from lumped.robot_file import load_robot
from lumped.system.assembly import assemble
from lumped.system.solution import Solved, compliance, modes, solved

ROBOT = with_equivalent_legs(load_robot("ifw").robot)


def legs_of(robot: Biglide, elements: int, release: str):
    chains = [
        segment_chain(leg.timoshenko, leg.length, elements) for leg in (robot.leg1, robot.leg2)
    ]
    if release == "printed":
        chains[1] = with_printed_tip_joint(chains[1])
    return [segment_leg(chain) for chain in chains]


def build(robot: Biglide, x: float, elements: int = 20, release: str = "condensed") -> Solved:
    legs = legs_of(robot, elements, release)
    if release == "condensed":
        return solved(biglide.system(robot, x, *legs))
    (at,) = postures(robot, (x,))
    at = replace(at, mechanism=printed(at.mechanism))
    return solved(assemble(at, dict(zip(("leg1", "leg2"), legs, strict=True))))


def test_first_frequencies_at_the_centre():
    """Known values: 113, 184, 213, 355 Hz; with Timoshenko's springs within 1 % of those."""
    frequencies = modes(build(ROBOT, ROBOT.centre), 4).frequencies
    assert_allclose(frequencies, [113.0, 184.0, 213.0, 355.0], rtol=0.01)


def test_deflections_at_the_centre_with_equivalent_legs():
    """Known values, α = 1: 7.3 µm planar under fx, 23 µm along z, at 1000 N."""
    result = compliance(build(ROBOT, ROBOT.centre, 3)) * 1e9
    assert_allclose(np.linalg.norm(result[:2, 0]), 7.3, atol=0.05)
    assert_allclose(result[2, 2], 23.0, atol=0.5)


def test_printed_joints_move_the_second_frequency_to_300_hz():
    """Known values, eq. (25): about 300 Hz as printed instead of about 184 Hz."""
    frequencies = modes(build(ROBOT, ROBOT.centre, release="printed"), 2).frequencies
    assert_allclose(frequencies[1], 300.0, rtol=0.01)


TOOL = np.diag([1e-9, 2e-9, 3e-9, 4e-7, 5e-7, 6e-7])
ROBOTS = {
    "as built": ROBOT,
    "rigid feet": replace(ROBOT, foot_compliance=None),
    "tool": replace(ROBOT, tool_offset=np.array([0.02, -0.03, 0.155]), tool_compliance=TOOL),
}


@pytest.mark.parametrize("release", ["condensed", "printed"])
@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
def test_joints_leave_what_shared_unknowns_leave(robot, release):
    """An independent formulation: feet, hinge and tool by shared unknowns (`shared_unknowns`)."""
    for x in robot.stations(3):
        found = build(robot, x, 4, release)
        stiffness, mass, loaded = by_hand(robot, x, *legs_of(robot, 4, release), release)
        expected = loaded @ solve_statics(stiffness, loaded.T, "by hand")
        scale = 1.0 / np.sqrt(np.diag(expected))
        difference = (compliance(found) - expected) * scale[:, None] * scale
        assert np.abs(difference).max() < 1e-10
        exact = solve_modes(stiffness, mass, 10, "by hand")
        assert_allclose(modes(found, 10).frequencies, exact.frequencies, rtol=1e-10)


def test_a_free_part_is_an_error_that_names_the_robot():
    """Aligned legs (x between two slides, both legs along x) leave B free along y."""
    robot = replace(ROBOT, a=1.625 - 2e-16, foot_compliance=None)
    with pytest.raises(ComputationError, match="the tool is free to"):
        compliance(build(robot, robot.stroke[1], 1))
