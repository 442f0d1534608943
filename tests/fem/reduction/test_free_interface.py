"""Parts reduced by their free modes: against dense matrices, against Craig and Bampton, bounds."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh

from fem.reduction.craig_bampton import reduction
from fem.reduction.free_interface import free_interface
from lumped.errors import ComputationError, InputError

CLAMPED = 6
COUNT = 6


@pytest.fixture(scope="module")
def free_frequencies(bar):
    """Elastic ones of the free bar (Hz)."""
    return bar.frequencies(0)[6:]


@pytest.fixture(scope="module")
def cutoff(free_frequencies):
    return 1.001 * free_frequencies[6]


@pytest.fixture(scope="module")
def found(bar, cutoff):
    return free_interface(bar.rooted, cutoff / 2.5, cutoff)


def clamped(stiffness, mass):
    """Frequencies (Hz) with the first interface held; massless unknowns have none."""
    own = slice(CLAMPED, None)
    inverse_squares = eigh(mass[own, own], stiffness[own, own], eigvals_only=True)[::-1]
    with_mass = inverse_squares[inverse_squares > 1e-12 * inverse_squares[0]]
    return 1.0 / (2.0 * np.pi * np.sqrt(with_mass))


def test_it_has_the_free_modes_below_its_cut_off(found, free_frequencies):
    reduced, _ = found
    assert reduced.counted == len(reduced.frequencies) == 7
    assert_allclose(reduced.frequencies, free_frequencies[:7], rtol=1e-8)
    own = eigh(reduced.stiffness, reduced.mass, eigvals_only=True)[6:]
    assert_allclose(np.sqrt(own[:7]) / (2.0 * np.pi), free_frequencies[:7], rtol=1e-8)


def test_its_matrices_are_those_of_its_displacements(bar, found):
    """By the dense triple product; unknowns are the twists of the interfaces, statics exact."""
    reduced, _ = found
    solid, V = bar.rooted.solid, reduced.recovery
    for matrix, own in ((solid.stiffness, reduced.stiffness), (solid.mass, reduced.mass)):
        assert V.T @ (matrix @ V) == pytest.approx(own, abs=1e-10 * np.abs(own).max())
    twists = solid.twists.T @ V
    assert twists == pytest.approx(np.eye(*twists.shape), abs=1e-10)
    count = len(twists)
    assert reduced.stiffness[:count, :count] == pytest.approx(bar.held.stiffness)
    assert not reduced.stiffness[:count, count:].any()


def test_clamped_it_swings_as_the_whole_bar_and_as_by_craig_and_bampton(bar, found, cutoff):
    exact = bar.frequencies(CLAMPED)[:COUNT]
    reduced, truncation = found
    assert exact[-1] < cutoff
    upper = clamped(reduced.stiffness, reduced.mass)[:COUNT]
    fixed = reduction(bar.held, cutoff / 2.5, cutoff)
    assert (upper >= exact * (1.0 - 1e-9)).all()
    # Measured: 3e-8 for the first two, 1e-4 for one just below the cut-off.
    assert_allclose(upper, exact, rtol=2e-4)
    assert_allclose(upper[:2], clamped(fixed.stiffness, fixed.mass)[:2], rtol=1e-7)
    lower = np.array(
        [clamped(*truncation.loosened((2.0 * np.pi * f) ** 2))[j] for j, f in enumerate(upper)]
    )
    assert (lower <= exact * (1.0 + 1e-9)).all()
    # Worth something: not much wider than the error is.
    assert (upper - lower <= 10.0 * (upper - exact) + 1e-8 * exact).all()


def test_a_reduction_that_drops_nothing_is_refused(bar):
    rooted = bar.rooted
    with pytest.raises(ComputationError, match=r"bar, free: its modes up to .* leave nothing"):
        free_interface(rooted, 1e8, 1e9)
    with pytest.raises(InputError, match="must be above the highest frequency"):
        free_interface(rooted, 1000.0, 900.0)
