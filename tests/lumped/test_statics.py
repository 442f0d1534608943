"""The energy balance of a static solution shows how many digits its flexibility has lost."""

import numpy as np
import pytest
from scipy.linalg import cho_factor, cho_solve

from lumped.dense.modes import solve_modes
from lumped.dense.statics import balanced_flexibility, rounding_of_flexibility, solve_statics
from lumped.errors import ComputationError

LOADS = np.array([[0.0], [1.0]])


def chain(stiff, soft=1.0):
    """Return the 2×2 stiffness matrix of springs `stiff` (at the ground) and `soft` in series."""
    return np.array([[stiff + soft, -soft], [-soft, soft]])


def solved(K):
    return cho_solve(cho_factor(K), LOADS)


# Both stiffnesses are added in one entry, 1e13 + 1, where the soft one keeps only three digits.
LOST = chain(1.0, 1e13 + 1.0 / 3.0)


@pytest.mark.parametrize(
    ("K", "X", "message"),
    [
        # A solution X that is 10 % too large: FᵀX is 10 % too large, and XᵀKX differs from FᵀX.
        (chain(10.0), 1.1 * solved(chain(10.0)), "two springs: .* differ by 10 %"),
        (chain(10.0), 1.001 * solved(chain(10.0)), "two springs: .* differ by 0.1 %"),
        (LOST, solved(LOST), "more than double precision can represent"),
        (np.eye(2), np.nan * LOADS, "two springs"),
        (np.zeros((2, 2)), -LOADS, "two springs"),
    ],
)
def test_solution_with_energy_imbalance_is_refused(K, X, message):
    """Displacements 10 % or 0.1 % too large: work of loads and stored energy differ."""
    with pytest.raises(ComputationError, match=message):
        balanced_flexibility(LOADS, X, K @ X, "two springs")


def test_rigid_direction_has_zero_flexibility():
    """A load carried entirely by constraints does no work."""
    assert balanced_flexibility(LOADS, np.zeros((2, 1)), LOADS, "rigid") == 0.0


@pytest.mark.parametrize("entry", [0.0, -1.0])
def test_non_positive_diagonal_is_refused(entry):
    """0 or −1 beside 1e300, for statics and for modes."""
    # Scaling this matrix to a unit diagonal would overflow.
    K = np.array([[1e300, 0.0], [0.0, entry]])
    for solve, arguments in ((solve_statics, (LOADS,)), (solve_modes, (np.eye(2), 1))):
        with pytest.raises(ComputationError, match="soft: the stiffness matrix is not positive"):
            solve(K, *arguments, "soft")


@pytest.mark.parametrize("stiff", [1.0, 1e8])
def test_rounding_bound_covers_perturbation(stiff):
    """2000 random perturbations of the entries of K by rounding errors: bound near their spread."""
    # Each entry is perturbed at random by a thousand times its rounding error, so that rounding
    # errors of this computation itself are negligible.
    K, rng = chain(stiff), np.random.default_rng(3)
    expected = 1000.0 * rounding_of_flexibility(K, solved(K))[0, 0] / 2.0
    noise = np.triu(rng.standard_normal((2000, 2, 2)))
    noise += np.triu(noise, 1).transpose(0, 2, 1)
    changed = K * (1.0 + 1000.0 * np.finfo(float).eps * noise)
    # The flexibility at the far end of the two springs is K_11 / det K.
    spread = np.std(
        changed[:, 0, 0] / (changed[:, 0, 0] * changed[:, 1, 1] - changed[:, 0, 1] ** 2)
    )
    # The bound treats the two equal entries off the diagonal as independent: it may be √2 too
    # large. Two thousand samples give the standard deviation to 1.6 % (one sigma).
    assert 0.95 * spread < expected < 1.08 * np.sqrt(2.0) * spread


@pytest.mark.parametrize(("angle", "softer"), [(1e-9, 1e3), (1e-9, 1e9), (0.3, 1e3), (0.3, 1e9)])
def test_rounding_bound_covers_rotated_blocks(angle, softer):
    """Two springs at right angles, K = k₁ n nᵀ + k₂ t tᵀ; the flexibility along t is 1/k₂."""
    errors, expected = [], []
    for rotated in angle * (1.0 + 1e-3 * np.arange(100)):
        c, s = np.cos(rotated), np.sin(rotated)
        rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        K = rotation @ np.diag([softer, 1.0, 1.0]) @ rotation.T
        load = rotation[:, 1:2]
        X = np.linalg.solve(K, load)
        errors.append((load.T @ X)[0, 0] - 1.0)
        expected.append(rounding_of_flexibility(K, X, rotated=3)[0, 0])
    assert np.std(errors) < 0.5 * np.max(expected) + 1e-15
    # The bound is at most 50 times the observed standard deviation: only four of the
    # dozen roundings that it counts occur here, in four of nine entries. Without rotation there may
    # be no error at all.
    if angle > 0.1:
        assert np.max(expected) < 50.0 * np.std(errors) + 1e-15
