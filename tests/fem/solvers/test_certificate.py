"""Eigenvalues counted by the signs of a factor, against all of them dense."""

import numpy as np
import pytest
from prismatic_legs import STEEL, meshed
from scipy.linalg import eigh, eigvalsh, null_space
from scipy.sparse import csr_array

from fem.bodies.solid import clamped_leg
from fem.solvers.certificate import count_below
from fem.solvers.factor import Inertia
from lumped.legs import ConstantLeg
from lumped.sections import Rectangle


@pytest.fixture(scope="module")
def leg(short_leg):
    """Stiffness and mass of a clamped leg, and its eigenvalues by LAPACK."""
    K, M = short_leg
    return K, M, eigh(K.toarray(), M.toarray(), eigvals_only=True)


def test_count_below_is_that_of_dense_eigenvalues(leg):
    K, M, eigenvalues = leg
    for below in (0, 1, 20, 300):
        sigma = 0.5 * (eigenvalues[below] + (eigenvalues[below - 1] if below else 0.0))
        assert count_below(K, M, sigma) == Inertia(below, 0, len(eigenvalues) - below)


def test_count_on_constrained_vectors(leg):
    K, M, _ = leg
    B = np.zeros((K.shape[0], 5))
    B[-5:] = np.random.default_rng(4).standard_normal((5, 5))
    B[:50, 2] = 1.0
    allowed = null_space(B.T)
    values = eigvalsh(allowed.T @ (K @ allowed), allowed.T @ (M @ allowed))
    for below in (1, 7):
        sigma = 0.5 * (values[below - 1] + values[below])
        assert count_below(K, M, sigma, B) == Inertia(below, 0, len(values) - below)


def test_matrix_whose_pivots_must_be_paired():
    """Zero diagonal: only 2×2 pivots exist; eigenvalues ± singular values of B."""
    B = np.random.default_rng(5).standard_normal((6, 6))
    matrix = np.block([[np.zeros((6, 6)), B], [B.T, np.zeros((6, 6))]])
    signs = eigvalsh(matrix)
    nothing = csr_array((12, 12))
    found = count_below(csr_array(matrix), nothing, 0.0)
    assert found == Inertia((signs < 0).sum(), 0, (signs > 0).sum()) == Inertia(6, 0, 6)
    singular = csr_array(np.diag([1.0, 0.0, -1.0]))
    assert count_below(singular, csr_array((3, 3)), 0.0) == Inertia(1, 1, 1)


@pytest.fixture(scope="module", params=["rigid", "free"])
def solid(request):
    """A clamped leg and its eigenvalues by LAPACK."""
    clamped = clamped_leg(
        meshed(ConstantLeg(0.6, Rectangle(0.08, 0.12), STEEL), 2, 4), request.param
    )
    K, M = clamped.solid.stiffness, clamped.solid.mass
    allowed = null_space(clamped.root.T)
    theta = eigvalsh(allowed.T @ (M @ allowed), allowed.T @ (K @ allowed))
    return clamped, 1.0 / theta[::-1]


def test_count_is_that_of_dense_eigenvalues(solid):
    clamped, values = solid
    for below in (0, 2, 12, 200):
        lower = values[below - 1] if below else 0.0
        gap = values[below] - lower
        # Near either of the two eigenvalues too: a tenth of the certificate's usual distance.
        near = min(0.001 * values[below], 0.4 * gap)
        for sigma in (lower + 0.5 * gap, lower + near, values[below] - near):
            found = clamped.rooted_inertia(sigma)
            assert found == (below, 0, len(values) - below)


def test_shift_on_an_eigenvalue_has_no_sign_or_moves_the_count_by_one(solid):
    clamped, values = solid
    found = clamped.rooted_inertia(values[5])
    assert found.negative in {5, 6}
    assert found.zero <= 1


def test_count_without_room_for_two_factors(solid, monkeypatch):
    """The factor of K makes room for that of the count, and comes again for a solve."""
    clamped, values = solid
    loads = clamped.equilibrated(clamped.loads)
    before, first = clamped.factor.solve(loads), clamped.factor.numeric
    count = clamped.rooted_inertia
    enough = 4 * clamped.factor.symbolic.peak_bytes
    monkeypatch.setattr("fem.solvers.factor.available_memory", lambda: enough)
    assert count(0.5 * (values[5] + values[6])).negative == 6
    assert clamped.factor.numeric is first
    monkeypatch.setattr("fem.solvers.factor.available_memory", lambda: enough - 1)
    for below in (6, 9):
        assert count(0.5 * (values[below - 1] + values[below])).negative == below
    assert clamped.factor.numeric is not first
    np.testing.assert_array_equal(clamped.factor.solve(loads), before)
