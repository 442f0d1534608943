"""Eigenvalues counted by fronts and by supports, against all of them dense."""

import importlib.util

import numpy as np
import pytest
from prismatic_legs import STEEL, meshed
from scipy.linalg import eigh, eigvalsh, null_space
from scipy.sparse import csr_array

import fem.solvers.certificate
from fem.bodies.solid import clamped_leg
from fem.solvers.certificate import Inertia, count_below, dissect, inertia, supported_count
from fem.solvers.factor import upper_triangle
from fem.solvers.ordering import block_graph
from lumped.legs import ConstantLeg
from lumped.sections import Rectangle

BACKENDS = [
    "cholmod",
    pytest.param(
        "mkl",
        marks=pytest.mark.skipif(
            importlib.util.find_spec("pypardiso") is None, reason="the extra mkl is not installed"
        ),
    ),
]


@pytest.fixture(scope="module")
def leg(short_leg):
    """Stiffness and mass of a clamped leg, and its eigenvalues by LAPACK."""
    K, M = short_leg
    return K, M, eigh(K.toarray(), M.toarray(), eigvals_only=True)


@pytest.mark.parametrize("backend", BACKENDS)
def test_count_below_is_that_of_dense_eigenvalues(leg, backend, monkeypatch):
    K, M, eigenvalues = leg
    monkeypatch.setenv("FLEXPROOF_SOLVER", backend)
    for below in (0, 1, 20, 300):
        sigma = 0.5 * (eigenvalues[below] + (eigenvalues[below - 1] if below else 0.0))
        found = count_below(K, M, sigma)
        assert found == Inertia(below, 0, len(eigenvalues) - below)


@pytest.mark.parametrize("backend", BACKENDS)
def test_count_on_constrained_vectors(leg, backend, monkeypatch):
    K, M, _ = leg
    monkeypatch.setenv("FLEXPROOF_SOLVER", backend)
    B = np.zeros((K.shape[0], 5))
    B[-5:] = np.random.default_rng(4).standard_normal((5, 5))
    B[:50, 2] = 1.0
    allowed = null_space(B.T)
    values = eigvalsh(allowed.T @ (K @ allowed), allowed.T @ (M @ allowed))
    for below in (1, 7):
        sigma = 0.5 * (values[below - 1] + values[below])
        found = count_below(K, M, sigma, constraints=B)
        assert found == Inertia(below, 0, len(values) - below)


def test_matrix_whose_pivots_must_be_paired():
    """Zero diagonal: only 2×2 pivots exist; eigenvalues ± singular values of B."""
    B = np.random.default_rng(5).standard_normal((6, 6))
    matrix = np.block([[np.zeros((6, 6)), B], [B.T, np.zeros((6, 6))]])
    signs = eigvalsh(matrix)
    found = inertia(csr_array(matrix), dissect(block_graph(csr_array(matrix))))
    assert found == Inertia((signs < 0).sum(), 0, (signs > 0).sum()) == Inertia(6, 0, 6)
    singular = csr_array(np.diag([1.0, 0.0, -1.0]))
    assert inertia(singular, dissect(block_graph(singular))).zero == 1


@pytest.fixture(scope="module", params=["rigid", "free"])
def solid(request):
    """A clamped leg, its factor's points and constraints, and its eigenvalues by LAPACK."""
    clamped = clamped_leg(
        meshed(ConstantLeg(0.6, Rectangle(0.08, 0.12), STEEL), 2, 4), request.param
    )
    K, M, B = clamped.solid.stiffness, clamped.solid.mass, clamped.root
    allowed = null_space(B.T)
    theta = eigvalsh(allowed.T @ (M @ allowed), allowed.T @ (K @ allowed))
    K, M = upper_triangle(K), upper_triangle(M)
    return clamped, K, M, clamped.solid.places, B, 1.0 / theta[::-1]


def test_count_is_that_of_dense_eigenvalues(solid):
    clamped, K, M, points, B, values = solid
    for below in (0, 2, 12):
        lower = values[below - 1] if below else 0.0
        # Near either of the two eigenvalues too: a tenth of the certificate's usual distance.
        for sigma in (0.5 * (lower + values[below]), lower * 1.001, values[below] * 0.999):
            found = supported_count(clamped.factor, K, M, sigma, points, B)
            assert found == (below, 0, len(values) - below)


def test_too_few_supports_prove_nothing_and_fronts_count(solid, monkeypatch):
    clamped, K, M, points, B, values = solid
    below = 200
    sigma = 0.5 * (values[below] + values[below - 1])
    assert supported_count(clamped.factor, K, M, sigma, points, B) is None
    answers = []

    def spied(*arguments):
        answers.append(supported_count(*arguments))
        return answers[-1]

    monkeypatch.setattr(fem.solvers.certificate, "supported_count", spied)
    assert clamped.rooted_inertia(sigma).negative == below
    assert answers == [None]


def test_count_without_room_for_two_factors(solid, monkeypatch):
    """The factor of K makes room for that of the count, and comes again for a solve."""
    clamped, values = solid[0], solid[-1]
    loads = clamped.equilibrated(clamped.loads)
    before, first = clamped.factor.solve(loads), clamped.factor.numeric
    count = clamped.rooted_inertia
    enough = 4 * clamped.factor.symbolic.peak_bytes
    monkeypatch.setattr("fem.solvers.cholesky.available_memory", lambda: enough)
    assert count(0.5 * (values[5] + values[6])).negative == 6
    assert clamped.factor.numeric is first
    monkeypatch.setattr("fem.solvers.cholesky.available_memory", lambda: enough - 1)
    for below in (6, 9):
        assert count(0.5 * (values[below - 1] + values[below])).negative == below
    assert clamped.factor.numeric is not first
    np.testing.assert_array_equal(clamped.factor.solve(loads), before)
