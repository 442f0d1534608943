"""Settings of computing processes: rarer searches of Python for reference cycles."""

import gc

import pytest

from fem.machine import search_cycles_rarely


@pytest.fixture
def thresholds():
    before = gc.get_threshold()
    yield
    gc.set_threshold(*before)


@pytest.mark.usefixtures("thresholds")
def test_chart_objects_start_no_cycle_search():
    """A chart consists of about ten thousand objects: too few for a search for reference cycles."""
    search_cycles_rarely()
    gc.collect()
    before = gc.get_stats()[0]["collections"]
    objects = [[] for _ in range(10_000)]
    assert gc.get_stats()[0]["collections"] == before
    assert len(objects) == 10_000
