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


def solved(K):
    return cho_solve(cho_factor(K), LOADS)


# The two stiffnesses stand in one entry, 1e13 + 1: of the soft one three digits are left.
LOST = chain(1.0, 1e13 + 1.0 / 3.0)


@pytest.mark.parametrize(
    ("K", "X", "said"),
    [
        # X too large by so much in the soft spring: FᵀX errs by that much, and so does XᵀR say.
        (chain(10.0), 1.1 * solved(chain(10.0)), "two springs: .* differ by 10 %"),
        (chain(10.0), 1.001 * solved(chain(10.0)), "two springs: .* differ by 0.1 %"),
        (LOST, solved(LOST), "more than double precision resolves"),
        (np.eye(2), np.nan * LOADS, "two springs"),
        (np.zeros((2, 2)), -LOADS, "two springs"),
    ],
)
def test_unbalanced_energy_is_the_error(K, X, said):
    with pytest.raises(ComputationError, match=said):
        balanced_flexibility(LOADS, X, K @ X, "two springs")


def test_rigid_directions_are_balanced():
    assert balanced_flexibility(LOADS, np.zeros((2, 1)), LOADS, "rigid") == 0.0


@pytest.mark.parametrize("entry", [0.0, -1.0])
def test_diagonal_without_positive_entry_is_refused(entry):
    # Scaled to a unit diagonal it would overflow.
    K = np.array([[1e300, 0.0], [0.0, entry]])
    for solve, given in ((solve_statics, (LOADS,)), (solve_modes, (np.eye(2), 1))):
        with pytest.raises(ComputationError, match="soft: the stiffness matrix is not positive"):
            solve(K, *given, "soft")


@pytest.mark.parametrize("stiff", [1.0, 1e8])
def test_rounding_bound_equals_random_perturbation(stiff):
    # Entries changed by one part in 2⁵² each, but a thousand times as much: what is left of eps
    # itself in the solution is none of the spread.
    K, rng = chain(stiff), np.random.default_rng(3)
    expected = 1000.0 * rounding_of_flexibility(K, solved(K))[0, 0] / 2.0
    noise = np.triu(rng.standard_normal((2000, 2, 2)))
    noise += np.triu(noise, 1).transpose(0, 2, 1)
    changed = K * (1.0 + 1000.0 * np.finfo(float).eps * noise)
    # Exact for a 2×2: the far end yields K_11 / det K.
    spread = np.std(
        changed[:, 0, 0] / (changed[:, 0, 0] * changed[:, 1, 1] - changed[:, 0, 1] ** 2)
    )
    # Entries off the diagonal come in pairs, those on it do not: at most √2 on the safe side, and
    # two thousand samples give a spread to 1.6 %, one sigma.
    assert 0.95 * spread < expected < 1.08 * np.sqrt(2.0) * spread


@pytest.mark.parametrize(("angle", "softer"), [(1e-9, 1e3), (1e-9, 1e9), (0.3, 1e3), (0.3, 1e9)])
def test_rounding_bound_covers_rotated_blocks(angle, softer):
    """Two bars at right angles, K = k₁ n nᵀ + k₂ t tᵀ: the soft one yields 1/k₂ along t."""
    errors, expected = [], []
    for turn in angle * (1.0 + 1e-3 * np.arange(100)):
        c, s = np.cos(turn), np.sin(turn)
        rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        K = rotation @ np.diag([softer, 1.0, 1.0]) @ rotation.T
        load = rotation[:, 1:2]
        X = np.linalg.solve(K, load)
        errors.append((load.T @ X)[0, 0] - 1.0)
        expected.append(rounding_of_flexibility(K, X, rotated=3)[0, 0])
    assert np.std(errors) < 0.5 * np.max(expected) + 1e-15
    # A bound, but no idle one: twenty times two sigma, since here four roundings of the dozen
    # happen, to four of the block's nine entries. A leg that is not turned may lose nothing.
    if angle > 0.1:
        assert np.max(expected) < 50.0 * np.std(errors) + 1e-15
