"""A mechanism's moves by differences of postures: what they say, and what they notice."""

import pytest

from lumped.robot_file import load_robot
from validation.case import judge
from validation.cases import mechanism_motion
from validation.context import Context


def verdicts(robot: str) -> dict[str, str]:
    context = Context(load_robot(robot), "quick")
    return {
        case.id: judge(case, case.compute(context), 0.0).verdict
        for case in mechanism_motion.cases(context.robot_file.mechanism)
    }


@pytest.mark.parametrize("robot", ["five-bar", "3-rrr", "delta", "hexapod"])
def test_moves_stir_what_the_assembler_says(robot):
    assert set(verdicts(robot).values()) == {"agree"}
