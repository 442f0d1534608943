"""Robots at random, lumped and with solid legs of every shape: no comparison raises an alarm."""

import pytest
from random_robots import SHAPES, alarms, robots

LUMPED = ("leg1.lumped", "leg2.lumped", "mechanism.lumped")
SOLIDS = (
    *(f"leg{n}.{group}" for n in (1, 2) for group in ("solid", "modes")),
    *(f"restraint.leg{n}" for n in (1, 2)),
    "robot.solid.modes",
)


@pytest.mark.exhaustive
@pytest.mark.parametrize("chunk", range(2))
def test_random_robots_raise_no_alarm(chunk):
    """Fifty robots in each of two chunks."""
    for robot in robots(50, chunk):
        assert not alarms(robot, LUMPED), robot


@pytest.mark.soak
def test_two_hundred_robots_raise_no_alarm_at_standard():
    for robot in robots(200, chunk=2):
        assert not alarms(robot, LUMPED, "standard"), robot


@pytest.mark.parametrize(
    ("count", "chunk"),
    [
        pytest.param(1, 5, marks=pytest.mark.exhaustive),
        pytest.param(6, 7, marks=pytest.mark.soak),
    ],
)
@pytest.mark.parametrize("shape", SHAPES)
def test_random_robots_raise_no_alarm_with_solid_legs(count, chunk, shape):
    """A quarter of a minute each."""
    for robot in robots(count, chunk, shape):
        assert not alarms(robot, SOLIDS), robot
