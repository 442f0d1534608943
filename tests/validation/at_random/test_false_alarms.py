"""Robots at random, lumped and with solid legs of every shape: no comparison raises an alarm."""

import pytest
from random_robots import SHAPES, alarms, robots

LUMPED = ("mechanism.lumped",)
SOLIDS = (
    *(f"leg{n}.{group}" for n in (1, 2) for group in ("solid", "modes")),
    "robot.solid.modes",
)
TYPICAL = ("rectangle", "tube", "i-section")


@pytest.mark.exhaustive
@pytest.mark.parametrize("chunk", range(2))
def test_random_robots_raise_no_alarm(chunk):
    for robot in robots(20, chunk):
        assert not alarms(robot, LUMPED), robot


@pytest.mark.soak
def test_two_hundred_robots_raise_no_alarm_at_standard():
    for robot in robots(200, chunk=2):
        assert not alarms(robot, LUMPED, "standard"), robot


@pytest.mark.parametrize(
    ("shape", "count", "chunk"),
    [
        # Solid, with walls all round, and open.
        *(pytest.param(s, 1, 5, marks=pytest.mark.exhaustive) for s in TYPICAL),
        *(pytest.param(s, 6, 7, marks=pytest.mark.soak) for s in SHAPES),
    ],
)
def test_random_robots_raise_no_alarm_with_solid_legs(shape, count, chunk):
    """A quarter of a minute each."""
    for robot in robots(count, chunk, shape):
        assert not alarms(robot, SOLIDS), robot
