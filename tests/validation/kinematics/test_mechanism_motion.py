"""A mechanism's moves by differences of postures: what they say."""

import pytest

from lumped.robot_file import load_robot
from validation.cases.mechanism import motion as mechanism_motion
from validation.context import Context
from validation.results.outcome import judge


def verdicts(robot: str) -> dict[str, str]:
    context = Context(load_robot(robot), "quick")
    return {
        case.id: judge(case, case.compute(context), 0.0).verdict
        for case in mechanism_motion.cases(moving=bool(context.robot_file.mechanism.tool.moves))
    }


@pytest.mark.parametrize("robot", ["five-bar", "3-rrr", "delta", "hexapod"])
def test_moves_stir_what_the_assembler_says(robot):
    assert set(verdicts(robot).values()) == {"agree"}
