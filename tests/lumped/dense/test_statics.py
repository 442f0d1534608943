"""The energy balance of a solution foretells the digits that a flexibility has lost."""

import numpy as np
import pytest
from scipy.linalg import cho_factor, cho_solve

from lumped.dense.modes import solve_modes
from lumped.dense.statics import balanced_flexibility, rounding_of_flexibility, solve_statics
from lumped.errors import ComputationError

LOADS = np.array([[0.0], [1.0]])


def chain(stiff, soft=1.0):
    """Two springs in a row: the stiffness at the far end is `soft` whatever `stiff` is."""
    return np.array([[stiff + soft, -soft], [-soft, soft]])


@pytest.mark.parametrize("error", [1e-1, 1e-3])
def test_the_left_over_energy_is_the_error(error):
    # X too large by `error` in the soft spring: FᵀX errs by that much, and so does XᵀR say.
    K = chain(10.0)
    exact = cho_solve(cho_factor(K), LOADS)
    wrong = exact * (1.0 + error)
    with pytest.raises(ComputationError, match=rf"two springs: .* differ by {100.0 * error:.2g} %"):
        balanced_flexibility(LOADS, wrong, K @ wrong, "two springs")


def test_a_soft_spring_behind_a_stiff_one_is_lost_in_rounding():
    # The two stiffnesses stand in one entry, 1e13 + 1: of the soft one three digits are left.
    K = chain(1.0, 1e13 + 1.0 / 3.0)
    X = cho_solve(cho_factor(K), LOADS)
    with pytest.raises(ComputationError, match="more than double precision resolves"):
        balanced_flexibility(LOADS, X, K @ X, "two springs")


def test_what_is_no_number_is_refused_and_what_does_not_yield_is_not():
    nothing = np.zeros((2, 1))
    assert balanced_flexibility(LOADS, nothing, LOADS, "rigid") == 0.0
    with pytest.raises(ComputationError):
        balanced_flexibility(LOADS, np.full((2, 1), np.nan), nothing, "nan")
    with pytest.raises(ComputationError):
        balanced_flexibility(LOADS, -LOADS, nothing, "negative")


@pytest.mark.parametrize("entry", [0.0, -1.0])
def test_a_diagonal_that_rounding_left_without_a_positive_entry_is_refused_by_name(entry):
    # Scaled to a unit diagonal it would overflow.
    K = np.array([[1e300, 0.0], [0.0, entry]])
    with pytest.raises(ComputationError, match="soft model: the stiffness matrix is not positive"):
        solve_statics(K, LOADS, "soft model")
    with pytest.raises(ComputationError, match="soft model: the stiffness matrix is not positive"):
        solve_modes(K, np.eye(2), 1, "soft model")


@pytest.mark.parametrize("stiff", [1.0, 1e8])
def test_rounding_is_that_of_entries_changed_at_random(stiff):
    # Entries changed by one part in 2⁵² each, but a thousand times as much: what is left of eps
    # itself in the solution is none of the spread.
    K, rng = chain(stiff), np.random.default_rng(3)
    X = np.linalg.solve(K, LOADS)
    expected = 1000.0 * rounding_of_flexibility(K, X)[0, 0] / 2.0
    large = 1000.0 * np.finfo(float).eps
    noise = np.triu(rng.standard_normal((2000, 2, 2)))
    changed = K * (1.0 + large * (noise + np.triu(noise, 1).transpose(0, 2, 1)))
    # Exact for a 2×2: the far end yields K_11 / det K.
    found = [C[0, 0] / (C[0, 0] * C[1, 1] - C[0, 1] * C[1, 0]) for C in changed]
    # Entries off the diagonal come in pairs, those on it do not: at most √2 on the safe side, and
    # two thousand samples give a spread to 1.6 %, one sigma.
    assert 0.95 * np.std(found) < expected < 1.08 * np.sqrt(2.0) * np.std(found)


@pytest.mark.parametrize("softer", [1e3, 1e9])
@pytest.mark.parametrize("angle", [1e-9, 0.3])
def test_rounding_of_what_was_turned_covers_what_turning_loses(softer, angle):
    """Two bars at right angles, K = k₁ n nᵀ + k₂ t tᵀ: the soft one yields 1/k₂ along t."""
    errors, expected = [], []
    for step in range(200):
        n = np.array([np.cos(angle * (1.0 + 1e-3 * step)), np.sin(angle * (1.0 + 1e-3 * step))])
        rotation = np.array([[n[0], -n[1], 0.0], [n[1], n[0], 0.0], [0.0, 0.0, 1.0]])
        K = rotation @ np.diag([softer, 1.0, 1.0]) @ rotation.T
        load = rotation[:, 1:2]
        X = cho_solve(cho_factor(K), load)
        errors.append((load.T @ X)[0, 0] - 1.0)
        expected.append(rounding_of_flexibility(K, X, turned=3)[0, 0])
    assert np.std(errors) < 0.5 * np.max(expected) + 1e-15
    # A bound, but no idle one: twenty times two sigma, since here four roundings of the dozen
    # happen, to four of the block's nine entries. A leg that is not turned may lose nothing.
    if angle > 0.1:
        assert np.max(expected) < 50.0 * np.std(errors) + 1e-15
