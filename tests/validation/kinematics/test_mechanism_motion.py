"""A mechanism's moves by differences of postures: what they say."""

import pytest
from random_linkages import hexarod

from lumped.robot_file import RobotFile, load_robot
from validation.cases.mechanism import motion as mechanism_motion
from validation.context import Context
from validation.results.outcome import judge


def verdicts(robot: RobotFile) -> dict[str, str]:
    context = Context(robot, "quick")
    return {
        case.id: judge(case, case.compute(context), 0.0).verdict
        for case in mechanism_motion.cases(moving=bool(context.robot_file.mechanism.tool.moves))
    }


@pytest.mark.parametrize("robot", ["five-bar", "3-rrr", "delta", "hexapod"])
def test_moves_stir_what_the_assembler_says(robot):
    assert set(verdicts(load_robot(robot)).values()) == {"agree"}


@pytest.mark.parametrize("seed", range(2))
def test_so_they_do_where_the_tool_is_turned(seed, tmp_path):
    """Rates of a rotation vector are not those of the body away from the reference posture."""
    assert set(verdicts(hexarod(seed).written(tmp_path)).values()) == {"agree"}
