"""Lumped models of robots at random: the suite without a fault raises no alarm.

A hundred robots meet the cases of the lumped models; the costlier groups (Huang's equation, orders
of convergence) meet every 25th. The soak test shows 200 robots to all of them in the standard
preset.
"""

import sys
from pathlib import Path

import pytest
from hypothesis import Phase, given, settings

sys.path.insert(0, str(Path(__file__).parent))

from random_robots import alarms, of_groups, robots, shown

from validation.case import Case

CHUNKS, EXAMPLES = 2, 50
# A robot costs a second: one that raises an alarm is shown as it is.
UNSHRUNK = (Phase.explicit, Phase.generate)
LUMPED = ("leg1.lumped", "leg2.lumped", "mechanism.lumped")
COSTLIER = ("benchmark.huang.1", "benchmark.huang.2")
COSTLIER += tuple(f"refinement.{n}.{name}" for n in (1, 2) for name in ("half", "literal", "beam"))
RARELY = 25


def in_turn(number: int) -> list[Case]:
    """What robot `number` meets of the lumped groups."""
    return of_groups(LUMPED + (COSTLIER if number % RARELY == 0 else ()))


@pytest.mark.exhaustive
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_random_robots_raise_no_alarm(chunk):
    """Fifty robots in each of two chunks: 0.4 s each (measured)."""
    chosen = shown(robots(), EXAMPLES, chunk)
    assert len(chosen) >= EXAMPLES
    for number, robot in enumerate(chosen):
        assert not alarms(robot, in_turn(number)), robot


@pytest.mark.soak
@settings(max_examples=200, database=None, phases=UNSHRUNK, deadline=None)
@given(robots())
def test_random_robots_raise_no_alarm_in_any_lumped_group(chosen):
    assert not alarms(chosen, of_groups(LUMPED + COSTLIER), "standard")
