"""The robot assembled from two legs: limits that can be computed by hand, and known values."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

sys.path.insert(0, str(Path(__file__).parent))

from shared_unknowns import by_hand

from lumped import biglide
from lumped.biglide import Biglide, postures, printed
from lumped.dense.modes import solve_modes
from lumped.dense.statics import solve_statics
from lumped.errors import ComputationError, InputError
from lumped.legs import constant_leg
from lumped.models.segments import segment_chain, segment_leg, with_printed_tip_joint
from lumped.screws import move_compliance
from lumped.system.assembly import assemble
from lumped.system.solution import Solved, compliance, modes, solved

# Equivalent legs of the IFW demonstrator (known values) and its foot's compliance, the
# appendix's k_Foot with (6,6) corrected.
FOOT = np.array(
    [
        [1.67e-10, 8.85e-13, -7.78e-14, -2.12e-13, 7.95e-12, 2.50e-12],
        [8.85e-13, 5.87e-9, 6.39e-12, -3.58e-11, -2.12e-11, 3.94e-8],
        [-7.78e-14, 6.39e-12, 5.53e-10, 1.35e-11, -4.49e-9, 1.91e-11],
        [-2.12e-13, -3.58e-11, 1.35e-11, 6.96e-8, 5.28e-11, -2.71e-10],
        [7.95e-12, -2.12e-11, -4.49e-9, 5.28e-11, 8.48e-8, 7.40e-9],
        [2.50e-12, 3.94e-8, 1.91e-11, -2.71e-10, 7.40e-9, 3.16e-7],
    ]
)
ROBOT = Biglide(
    name="IFW",
    a=0.92,
    platform_mass=46.0,
    actuator_stiffness=1.0e9,
    leg1=constant_leg(0.85, EA=8.613e8, EIy=4.771e6, EIz=1.832e6, GJ=9.212e6, mass=69.705),
    leg2=constant_leg(0.775, EA=4.316e9, EIy=5.980e7, EIz=4.182e6, GJ=6.478e6, mass=49.366),
    foot_compliance=FOOT,
)


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


def stiff(length: float, mass: float):
    """A leg 1e6 times stiffer than the feet; more would drown the feet in rounding."""
    return constant_leg(length, EA=1e15, EIy=1e15, EIz=1e15, GJ=1e15, mass=mass)


def test_stiff_massless_legs_on_y_springs_are_the_simplified_model():
    """With springs along y alone left, δt = J K⁻¹ Jᵀ f, eq. (1)."""
    foot = np.diag([1e-15, 1e-9, 1e-15, 1e-15, 1e-15, 1e-15])
    robot = replace(ROBOT, leg1=stiff(0.85, 1e-9), leg2=stiff(0.775, 1e-9), foot_compliance=foot)
    x = 0.4
    s1, s2 = np.sqrt(0.85**2 - x**2), np.sqrt(0.775**2 - (0.92 - x) ** 2)
    jacobian = np.linalg.solve(np.array([[x, s1], [x - 0.92, s2]]), np.diag([s1, s2]))
    mechanism = build(robot, x, elements=1)
    expected = jacobian @ jacobian.T / 1e9
    assert_allclose(compliance(mechanism)[:2, :2], expected, rtol=1e-5)
    frequencies = modes(mechanism, 2).frequencies
    exact = np.sqrt(1.0 / (46.0 * np.linalg.eigvalsh(expected)))[::-1] / (2.0 * np.pi)
    # Along z the feet leave 1e-15 m/N: the two planar modes are the lowest.
    assert_allclose(frequencies, exact, rtol=1e-5)


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


def test_tool_spring_adds_its_compliance_and_offset_moves_the_loaded_point():
    offset = np.array([0.02, -0.03, 0.155])
    spring = np.diag([1e-9, 2e-9, 3e-9, 4e-7, 5e-7, 6e-7])
    at_b = compliance(build(ROBOT, 0.6, 2))
    at_p = compliance(build(replace(ROBOT, tool_offset=offset), 0.6, 2))
    assert_allclose(at_p, move_compliance(at_b, offset), rtol=1e-9, atol=1e-18)
    with_tool = replace(ROBOT, tool_offset=offset, tool_compliance=spring)
    result = compliance(build(with_tool, 0.6, 2))
    assert_allclose(result, at_p + spring, rtol=1e-9, atol=1e-18)


def test_rigid_feet_are_the_limit_of_stiff_feet():
    # Feet 1e-8 of the legs' compliance leave a difference of about that size.
    nearly = replace(ROBOT, foot_compliance=1e-8 * FOOT)
    rigid = replace(ROBOT, foot_compliance=None)
    for x in (ROBOT.stroke[0], ROBOT.centre, ROBOT.stroke[1]):
        expected = compliance(build(rigid, x, 2))
        scale = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
        assert_allclose(compliance(build(nearly, x, 2)) / scale, expected / scale, atol=1e-6)


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


def test_posture_outside_the_stroke_is_refused():
    with pytest.raises(InputError, match=r"x = 0\.9 m is outside the stroke 0\.145 m to 0\.85 m"):
        build(ROBOT, 0.9, 1)


def test_a_free_part_is_an_error_that_names_the_robot():
    """Aligned legs (x between two slides, both legs along x) leave B free along y."""
    robot = replace(ROBOT, a=1.625 - 2e-16, foot_compliance=None)
    with pytest.raises(ComputationError, match="the tool is free to"):
        compliance(build(robot, robot.stroke[1], 1))
