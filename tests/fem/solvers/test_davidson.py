"""Modes by a preconditioner alone: springs in a row, a membrane with pairs of modes, a failure."""

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array, eye_array, kron

from fem.solvers.davidson import StagnationError, davidson
from fem.solvers.modes import preconditioned_modes


def chain(n):
    """Return the stiffness of n masses in a row between n + 1 springs of 1 N/m."""
    return csr_array(diags_array([-1.0, 2.0, -1.0], offsets=[-1, 0, 1], shape=(n, n)))


def smoothing(K, sweeps):
    """Return an approximation of K⁻¹ that is good for short waves and poor for long ones."""
    inverse = np.linalg.inv(K.toarray() + np.diag(K.diagonal()) / sweeps)
    return lambda block: inverse @ block


def noise(n, columns=8):
    """Return random start vectors, a block n×`columns`."""
    return np.random.default_rng(3).standard_normal((n, columns))


def test_chain_frequencies_equal_closed_form():
    """Masses of 1 kg between springs of 1 N/m: ω² = 4 sin²(kπ/(2(n+1)))."""
    n, count = 200, 12
    exact = 4.0 * np.sin(np.arange(1, count + 1) * np.pi / (2.0 * (n + 1))) ** 2
    M = csr_array(eye_array(n))
    values, shapes = davidson(chain(n), M, smoothing(chain(n), 300), noise(n), count, 2000)
    # ρ² over the smallest relative gap, 1e-10/0.15; observed 4e-12.
    np.testing.assert_allclose(values, exact, rtol=1e-9)
    np.testing.assert_allclose(shapes.T @ shapes, np.eye(count), atol=1e-10)


def test_square_membrane_has_both_modes_of_each_pair():
    """A square grid of strings has ω² = a + b for all pairs of a chain's a and b."""
    n, count = 14, 10
    single = 4.0 * np.sin(np.arange(1, n + 1) * np.pi / (2.0 * (n + 1))) ** 2
    exact = np.sort(np.add.outer(single, single).ravel())[:count]
    identity = eye_array(n)
    K = csr_array(kron(chain(n), identity) + kron(identity, chain(n)))
    M = csr_array(eye_array(n * n))
    values, _ = davidson(K, M, smoothing(K, 50), noise(n * n, 5), count, 2000)
    np.testing.assert_allclose(values, exact, rtol=1e-9)


def test_stagnating_search_is_repeated_with_solutions(monkeypatch):
    """The identity is no approximation of K⁻¹ for a long chain, which block Lanczos solves."""
    n, count = 400, 4
    monkeypatch.setattr("fem.solvers.modes._CYCLES", 50)
    K, M = chain(n), csr_array(eye_array(n))
    with pytest.raises(StagnationError, match=r"^[0-3] of 4 modes"):
        davidson(K, M, lambda block: block, noise(n), count, 100)
    inverse = np.linalg.inv(K.toarray())
    modes = preconditioned_modes(K, M, lambda x: x, lambda x: inverse @ x, count, "leg")
    exact = 2.0 * np.sin(np.arange(1, count + 1) * np.pi / (2.0 * (n + 1))) / (2.0 * np.pi)
    # Round-off of the inverse, whose condition is 7e4.
    np.testing.assert_allclose(modes.frequencies, exact, rtol=1e-10)


def test_indefinite_preconditioner_gives_no_false_modes():
    """A negative rᵀT r is no small residual: T = −K⁻¹ passed for converged at once before."""
    n, count = 60, 3
    K, M = chain(n), csr_array(eye_array(n))
    inverse = np.linalg.inv(K.toarray())
    exact = 4.0 * np.sin(np.arange(1, count + 1) * np.pi / (2.0 * (n + 1))) ** 2
    values, _ = davidson(K, M, lambda block: -inverse @ block, noise(n), count, 1000)
    np.testing.assert_allclose(values, exact, rtol=1e-9)
