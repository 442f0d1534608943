"""Solid legs of robots at random, of every shape: the suite without a fault raises no alarm."""

import pytest
from random_robots import SHAPES, alarms, of_groups, robots, shown

SOLIDS = (
    *(f"leg{n}.{group}" for n in (1, 2) for group in ("solid", "modes")),
    *(f"restraint.leg{n}" for n in (1, 2)),
    "robot.solid.modes",
)


@pytest.mark.exhaustive
@pytest.mark.parametrize("shape", SHAPES)
def test_random_robot_of_each_shape_raises_no_alarm_with_solid_legs(shape):
    # The first example of a strategy is its simplest one.
    robot = shown(robots(shape), 3, chunk=5)[-1]
    assert not alarms(robot, of_groups(SOLIDS)), robot


@pytest.mark.soak
@pytest.mark.parametrize("shape", SHAPES)
def test_random_robots_raise_no_alarm_with_solid_legs(shape):
    """Six robots of each of five shapes, a quarter of a minute each."""
    for robot in shown(robots(shape), 7, chunk=7)[1:]:
        assert not alarms(robot, of_groups(SOLIDS)), robot
