"""The fast path over postures against the general assembler and its solutions."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.bodies.beam import beam_leg
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.superelement import held_leg
from fem.sweep import posture_model, solve_posture
from lumped import biglide_assembly as mechanism
from lumped.biglide import with_equivalent_legs
from lumped.errors import ComputationError, InputError
from lumped.robot_file import load_robot
from lumped.segments import segment_chain, segment_leg, static_leg, with_printed_tip_joint

ROBOT = with_equivalent_legs(load_robot("ifw").robot)
TOOL = np.diag([1e-9, 2e-9, 3e-9, 4e-7, 5e-7, 6e-7])
ROBOTS = {
    "as built": ROBOT,
    "rigid feet": replace(ROBOT, foot_compliance=None),
    "tool": replace(ROBOT, tool_offset=np.array([0.02, -0.03, 0.155]), tool_compliance=TOOL),
}


def chain(leg, elements=4):
    return segment_chain(leg.timoshenko, leg.length, elements)


LEGS = {
    "segments": [segment_leg(chain(leg)) for leg in (ROBOT.leg1, ROBOT.leg2)],
    "superelements": [
        craig_bampton(held_leg(beam_leg(leg.timoshenko, leg.length, 8)), 1000.0).matrices
        for leg in (ROBOT.leg1, ROBOT.leg2)
    ],
}


@pytest.mark.parametrize("robot", ROBOTS.values(), ids=ROBOTS)
@pytest.mark.parametrize("legs", LEGS.values(), ids=LEGS)
def test_matrices_and_solutions_are_those_of_the_assembler(robot, legs):
    model = posture_model(robot, *legs)
    for x in robot.stations(4):
        whole = mechanism.assemble(robot, x, *legs)
        for found, expected in zip(
            model.matrices(x), (whole.stiffness.toarray(), whole.mass.toarray()), strict=True
        ):
            assert np.abs(found - expected).max() < 1e-12 * np.abs(expected).max()
        solved = solve_posture(model, x, 10)
        expected = mechanism.compliance(whole)
        scale = 1.0 / np.sqrt(np.diag(expected))
        # Rounding of the two solutions, times their conditioning.
        assert np.abs((solved.compliance - expected) * scale[:, None] * scale).max() < 1e-11
        modes = mechanism.modes(whole, 10)
        assert_allclose(solved.modes.frequencies, modes.frequencies, rtol=1e-10)
        gram = solved.modes.shapes.T @ (whole.mass @ modes.shapes)
        assert_allclose(np.abs(np.diag(gram)), 1.0, atol=1e-8)


def test_printed_joints():
    legs = [segment_leg(chain(ROBOT.leg1)), segment_leg(with_printed_tip_joint(chain(ROBOT.leg2)))]
    model = posture_model(ROBOT, *legs, release="printed")
    whole = mechanism.assemble(ROBOT, 0.3, *legs, release="printed")
    stiffness = whole.stiffness.toarray()
    assert np.abs(model.matrices(0.3)[0] - stiffness).max() < 1e-12 * np.abs(stiffness).max()


def test_posture_outside_the_stroke_is_refused():
    model = posture_model(ROBOT, *LEGS["segments"])
    with pytest.raises(InputError, match=r"x = 0\.9 m is outside the stroke"):
        solve_posture(model, 0.9, 4)


def test_free_part_and_missing_mass_are_errors_that_name_the_robot():
    robot = replace(ROBOT, a=1.625 - 2e-16, foot_compliance=None)
    legs = [segment_leg(chain(leg, 1)) for leg in (ROBOT.leg1, ROBOT.leg2)]
    with pytest.raises(ComputationError, match=r"IFW.* x = 0\.85 m.*free to move"):
        solve_posture(posture_model(robot, *legs), robot.stroke[1], 2)
    massless = [static_leg(chain(leg)) for leg in (ROBOT.leg1, ROBOT.leg2)]
    with pytest.raises(ComputationError, match="4 modes asked for, but fewer have mass"):
        solve_posture(posture_model(ROBOT, *massless), ROBOT.centre, 4)
