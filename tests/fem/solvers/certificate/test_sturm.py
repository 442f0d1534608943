import importlib.util

import numpy as np
import pytest
from scipy.linalg import eigh, eigvalsh, null_space
from scipy.sparse import csr_array

from fem.solvers.certificate.sturm import Inertia, count_below, dissect, inertia
from fem.solvers.ordering import block_graph

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
@pytest.mark.parametrize("below", [0, 1, 20, 300])
def test_count_below_is_that_of_dense_eigenvalues(leg, backend, below):
    K, M, eigenvalues = leg
    sigma = 0.5 * (eigenvalues[below] + (eigenvalues[below - 1] if below else 0.0))
    found = count_below(K, M, sigma, backend=backend)
    assert found == Inertia(below, 0, len(eigenvalues) - below)


@pytest.mark.parametrize("backend", BACKENDS)
def test_count_on_constrained_vectors(leg, backend):
    K, M, _ = leg
    B = np.zeros((K.shape[0], 5))
    B[-5:] = np.random.default_rng(4).standard_normal((5, 5))
    B[:50, 2] = 1.0
    allowed = null_space(B.T)
    values = eigvalsh(allowed.T @ (K @ allowed), allowed.T @ (M @ allowed))
    for below in (1, 7):
        sigma = 0.5 * (values[below - 1] + values[below])
        found = count_below(K, M, sigma, backend=backend, constraints=B)
        assert found == Inertia(below, 0, len(values) - below)


def test_separators_separate(leg):
    """No entry of the matrix joins two halves that a separator keeps apart."""
    K, _, _ = leg
    fronts = dissect(block_graph(K))
    descendants = []
    for number, front in enumerate(fronts):
        below = {number}.union(*(descendants[child] for child in front.children))
        descendants.append(below)
    for front in fronts:
        if len(front.children) == 2:
            first, second = (
                np.concatenate([fronts[i].unknowns for i in descendants[child]])
                for child in front.children
            )
            assert K[first][:, second].nnz == 0


def test_matrix_whose_pivots_must_be_paired():
    """Zero diagonal: only 2×2 pivots exist; eigenvalues ± singular values of B."""
    B = np.random.default_rng(5).standard_normal((6, 6))
    matrix = np.block([[np.zeros((6, 6)), B], [B.T, np.zeros((6, 6))]])
    signs = eigvalsh(matrix)
    found = inertia(csr_array(matrix), dissect(block_graph(csr_array(matrix))))
    assert found == Inertia((signs < 0).sum(), 0, (signs > 0).sum()) == Inertia(6, 0, 6)


def test_leading_blocks_of_rigid_ends():
    rng = np.random.default_rng(6)
    dense = rng.standard_normal((42, 42))
    dense = dense + dense.T
    dense[:6, 6:12] = dense[6:12, :6] = 0.0
    signs = eigvalsh(dense)
    found = inertia(csr_array(dense), dissect(block_graph(csr_array(dense), leading=(6, 6))))
    assert found.negative == (signs < 0).sum()


def test_singular_matrix_has_no_sign():
    matrix = csr_array(np.diag([1.0, 0.0, -1.0]))
    found = inertia(matrix, dissect(block_graph(matrix)))
    assert found.zero == 1
