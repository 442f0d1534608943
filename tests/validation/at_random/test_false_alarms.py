"""Lumped models of robots at random: the suite without a fault raises no alarm.

The soak test shows them 200 robots in the standard preset.
"""

import pytest
from hypothesis import Phase, given, settings
from random_robots import alarms, of_groups, robots, shown

CHUNKS, EXAMPLES = 2, 50
# A robot costs a second: one that raises an alarm is shown as it is.
UNSHRUNK = (Phase.explicit, Phase.generate)
LUMPED = ("leg1.lumped", "leg2.lumped", "mechanism.lumped")


@pytest.mark.exhaustive
@pytest.mark.parametrize("chunk", range(CHUNKS))
def test_random_robots_raise_no_alarm(chunk):
    """Fifty robots in each of two chunks: 0.4 s each (measured)."""
    chosen = shown(robots(), EXAMPLES, chunk)
    assert len(chosen) >= EXAMPLES
    for robot in chosen:
        assert not alarms(robot, of_groups(LUMPED)), robot


@pytest.mark.soak
@settings(max_examples=200, database=None, phases=UNSHRUNK, deadline=None)
@given(robots())
def test_random_robots_raise_no_alarm_in_any_lumped_group(chosen):
    assert not alarms(chosen, of_groups(LUMPED), "standard")
