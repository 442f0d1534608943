"""Modes of a part with its interfaces held, counted: against all of them dense, and one missing."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fem.reduction.counted_modes as counting
from fem.reduction.counted_modes import counted_modes
from fem.reduction.craig_bampton import reduction
from fem.reduction.held import free_body
from fem.reduction.interface_modes import interface_modes
from lumped.dense.modes import Modes
from lumped.errors import ComputationError


@pytest.mark.parametrize("free", [False, True])
def test_inertia_counts_what_a_dense_eigensolver_finds(bar, held_frequencies, free):
    """Of the bar with its interfaces held, and of the free bar without its rigid motions."""
    body = free_body(bar.rooted) if free else bar.held
    frequencies = bar.frequencies(0)[6:] if free else held_frequencies
    assert body.size > 400
    if free:
        assert body.rigid.T @ (body.mass @ body.rigid) == pytest.approx(np.eye(6), abs=1e-10)
    for below in (0, 1, 2, 5, 12, 40):
        lowest, next_one = np.append(0.0, frequencies)[[below, below + 1]]
        if next_one > 1.001 * lowest:
            found = body.inertia((np.pi * (lowest + next_one)) ** 2)
            assert (found.negative, found.zero) == (below, 0)


def test_a_reduction_has_the_modes_that_are_counted(bar, held_frequencies):
    cutoff = 1.001 * held_frequencies[14]
    found = reduction(bar.held, 0.4 * cutoff, cutoff)
    below = held_frequencies[held_frequencies < found.cutoff]
    assert found.counted == len(below) >= 15
    assert_allclose(found.frequencies[: len(below)], below, rtol=1e-8)


@pytest.mark.parametrize("missed", [0, 3, 7])
def test_a_mode_that_the_search_missed_is_counted_and_searched_for(
    bar, held_frequencies, missed, monkeypatch
):
    cutoff = 1.001 * held_frequencies[9]

    def blind(held, cutoff, search=0):
        found = interface_modes(held, cutoff, search)
        if search:
            return found
        kept = np.arange(len(found.frequencies)) != missed
        return Modes(found.frequencies[kept], found.shapes[:, kept])

    sound = counted_modes(bar.held, cutoff)
    monkeypatch.setattr(counting, "interface_modes", blind)
    found = counted_modes(bar.held, cutoff)
    assert found.counted == sound.counted
    assert_allclose(found.frequencies, sound.frequencies, rtol=1e-9)
    gram = found.shapes.T @ (bar.held.mass @ found.shapes)
    assert_allclose(gram, np.eye(len(gram)), atol=1e-8)


def test_a_mode_that_is_never_found_or_found_twice_is_an_error(bar, held_frequencies, monkeypatch):
    cutoff = 1.001 * held_frequencies[9]

    def without_the_first(held, cutoff, search=0):
        found = interface_modes(held, cutoff, search)
        return Modes(found.frequencies[1:], found.shapes[:, 1:])

    monkeypatch.setattr(counting, "interface_modes", without_the_first)
    with pytest.raises(ComputationError, match="bar, all interfaces held: certificate"):
        counted_modes(bar.held, cutoff)

    def first_twice(held, cutoff, search=0):
        found = interface_modes(held, cutoff, search)
        twice = np.r_[0, 0 : len(found.frequencies)]
        return Modes(found.frequencies[twice], found.shapes[:, twice])

    monkeypatch.setattr(counting, "interface_modes", first_twice)
    with pytest.raises(ComputationError, match="certificate of the modes failed"):
        counted_modes(bar.held, cutoff)
