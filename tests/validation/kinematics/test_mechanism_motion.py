"""A mechanism's moves by differences of postures: what they say."""

import pytest
from random_linkages import hexarod

from lumped.robot_file import load_robot
from validation.cases.mechanism import motion
from validation.context import Context
from validation.results.outcome import judge


@pytest.mark.parametrize(
    "robot",
    ["five-bar", *(pytest.param(n, marks=pytest.mark.exhaustive) for n in ("delta", "3-rrr"))],
)
def test_moves_stir_what_the_assembler_says(robot):
    assert all_agree(load_robot(robot))


def test_so_they_do_where_the_tool_is_turned(tmp_path):
    """Rates of a rotation vector are not those of the body away from the reference posture."""
    assert all_agree(hexarod(0).written(tmp_path))


def all_agree(robot):
    context = Context(robot, "quick")
    cases = motion.cases(moving=bool(context.robot_file.mechanism.tool.moves))
    found = [judge(case, case.compute(context), 0.0).verdict for case in cases]
    return found and set(found) == {"agree"}
