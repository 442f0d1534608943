"""CHOLMOD's factor as a whole and in halves, through what both can do."""

import numpy as np
import pytest
from scipy.sparse import block_diag, csr_array, diags_array, eye_array
from scipy.sparse.linalg import spsolve

import fem.solvers.cholesky
from fem.machine import threads
from fem.solvers.cholesky import analyse, factorise
from fem.solvers.cholmod.bisected_factor import BisectedFactor
from fem.solvers.cholmod.whole_factor import CholmodFactor
from fem.solvers.factor import (
    NotPositiveDefiniteError,
    SeparatedFactor,
    upper_triangle,
    whole_matrix,
)

# Solutions of one matrix by two eliminations differ by its condition number (here 1e6) times 1e-16.
SOLVER_TOLERANCE = 1e-9
KIND = {"whole": CholmodFactor, "halves": BisectedFactor}


@pytest.fixture(params=["whole", "halves"])
def way(request, monkeypatch):
    """Both eliminations on a matrix far too small for two threads."""
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    if request.param == "halves":
        monkeypatch.setattr(fem.solvers.cholesky, "_BISECTED", 0)
    return request.param


@pytest.fixture
def halves(monkeypatch):
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    monkeypatch.setattr(fem.solvers.cholesky, "_BISECTED", 0)


def factor_of(matrix, way):
    factor = factorise(analyse(matrix, backend="cholmod"), matrix)
    assert isinstance(factor, KIND[way])
    assert isinstance(factor, SeparatedFactor)
    return factor


def assert_solves(factor, matrix, columns=2):
    loads = np.random.default_rng(1).standard_normal((matrix.shape[0], columns))
    expected, found = spsolve(matrix.tocsc(), loads), factor.solve(loads)
    assert found.shape == loads.shape
    assert np.abs(found - expected).max() <= SOLVER_TOLERANCE * np.abs(expected).max()


def patches(factor, n, count=5, size=12):
    """Random columns W (csr n×k), three on a patch of each of the largest separators."""
    rng = np.random.default_rng(2)
    columns = np.zeros((n, 3 * count))
    for number, separator in enumerate(factor.separators(count)):
        own = separator[:size]
        columns[own, 3 * number : 3 * number + 3] = rng.standard_normal((len(own), 3))
    return csr_array(columns)


def test_the_upper_triangle_is_enough(short_leg, way):
    K, _ = short_leg
    triangle = upper_triangle(K)
    assert abs(whole_matrix(triangle) - K).max() == 0.0
    whole, half = factor_of(K, way), factor_of(triangle, way)
    load = np.ones(K.shape[0])
    np.testing.assert_array_equal(half.solve(load), whole.solve(load))


def test_separators_are_disjoint_and_the_largest_first(short_leg, way):
    K, _ = short_leg
    separators = factor_of(K, way).separators(9)
    assert len(separators) == 9
    assert [len(s) for s in separators] == sorted((len(s) for s in separators), reverse=True)
    together = np.concatenate(separators)
    assert len(np.unique(together)) == len(together)
    if way == "halves":
        factor = factor_of(K, way)
        first, second = (half.order[: half.own] for half in factor.halves)
        assert K[first][:, second].nnz == 0
        assert len(first) + len(second) + len(factor.separator) == K.shape[0]
        # Halves by name: their work differs little.
        assert 0.8 < len(first) / len(second) < 1.25


@pytest.mark.parametrize("spread", [False, True])
def test_gram_is_that_of_solutions(short_leg, way, spread):
    """Columns on separators, and columns anywhere: then all of L is on their paths."""
    K, _ = short_leg
    factor, n = factor_of(K, way), K.shape[0]
    W = patches(factor, n)
    if spread:
        rng = np.random.default_rng(3)
        W = csr_array(np.where(rng.random((n, 7)) < 0.02, rng.standard_normal((n, 7)), 0.0))
    expected = W.T @ spsolve(K.tocsc(), W.toarray())
    found = factor.gram(W)
    assert np.abs(found - expected).max() <= SOLVER_TOLERANCE * np.abs(expected).max()


def test_renewed_in_place_with_couplings_within_separators(short_leg, way):
    K, M = short_leg
    factor, n = factor_of(K, way), K.shape[0]
    load = np.ones(n)
    before = factor.solve(load)
    W = patches(factor, n) * np.sqrt(K.diagonal().mean())
    other = csr_array(K + 1e6 * M + W @ W.T)
    assert other.nnz > K.nnz
    renewed = factor.renewed(upper_triangle(other), "other")
    assert_solves(renewed, other)
    again = renewed.renewed(upper_triangle(K), "first")
    np.testing.assert_array_equal(again.solve(load), before)


def test_renewed_after_a_matrix_that_was_not_positive_definite(short_leg, way):
    K, M = short_leg
    factor = factor_of(K, way)
    with pytest.raises(NotPositiveDefiniteError, match="too far"):
        factor.renewed(upper_triangle(csr_array(K - 1e12 * M)), "too far")
    assert_solves(factor.renewed(upper_triangle(K), "back"), K)


@pytest.mark.parametrize("place", ["half", "separator"])
@pytest.mark.usefixtures("halves")
def test_the_unknown_of_a_negative_pivot_is_named_and_nothing_printed(short_leg, place, capfd):
    K, _ = short_leg
    factor = factor_of(K, "halves")
    unknown = {"half": factor.halves[1].order[7], "separator": factor.separator[4]}[place]
    # By its own diagonal entry alone: whatever is eliminated before makes it no larger.
    broken = csr_array(diags_array(np.where(np.arange(K.shape[0]) == unknown, -1.0, 2.0)))
    with pytest.raises(NotPositiveDefiniteError, match="leg 1") as refused:
        factorise(analyse(K, backend="cholmod"), broken, "leg 1")
    assert refused.value.unknown == unknown
    assert capfd.readouterr() == ("", "")


@pytest.mark.usefixtures("halves")
def test_whole_that_is_indefinite_although_both_halves_are_not():
    """A chain with ends that push each other: either half is positive definite with the other held.

    Eigenvalues of the second difference are 2 − 2 cos(kπ/(n+1)); a shift between the lowest of the
    chain and the lowest of its halves leaves one negative.
    """
    n = 300
    chain = 2.0 * eye_array(n) - eye_array(n, k=1) - eye_array(n, k=-1)
    lowest = 2.0 - 2.0 * np.cos(np.array([1.0, 2.0]) * np.pi / (n + 1))
    shifted = csr_array(chain - lowest.mean() * eye_array(n))
    with pytest.raises(NotPositiveDefiniteError):
        factorise(analyse(shifted, backend="cholmod"), shifted)
    sound = csr_array(chain - 0.5 * lowest[0] * eye_array(n))
    assert_solves(factor_of(sound, "halves"), sound)


@pytest.mark.usefixtures("halves")
def test_pieces_that_are_not_coupled(short_leg):
    """A half of several pieces may not keep its separator last, equal pieces need none."""
    K, _ = short_leg
    for sizes in ((300, 90, 600, 60), (300, 300)):
        pieces = csr_array(block_diag([K[:size, :size] for size in sizes]))
        assert_solves(factorise(analyse(pieces, backend="cholmod"), pieces), pieces)


@pytest.mark.usefixtures("halves")
def test_factorisations_at_once_do_not_disturb_each_other(short_leg):
    """CHOLMOD's workspaces are apart and its BLAS locks its buffers: the same bits every time."""
    K, _ = short_leg
    symbolic = analyse(K, backend="cholmod")
    loads = np.random.default_rng(5).standard_normal((K.shape[0], 8))
    first = factorise(symbolic, K).solve(loads)
    for _ in range(8):
        np.testing.assert_array_equal(factorise(symbolic, K).solve(loads), first)


def test_halves_for_large_matrices_and_two_threads_alone(short_leg, monkeypatch):
    K, _ = short_leg
    for told, size, kind in (("2", 0, "halves"), ("1", 0, "whole"), ("2", 10**6, "whole")):
        monkeypatch.setenv("OMP_NUM_THREADS", told)
        monkeypatch.setattr(fem.solvers.cholesky, "_BISECTED", size)
        factor_of(K, kind)
    monkeypatch.setattr("fem.solvers.cholmod.library._library", lambda: None)
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    monkeypatch.setattr(fem.solvers.cholesky, "_BISECTED", 0)
    factor_of(K, "whole")


def test_threads_from_the_environment(monkeypatch):
    for told, expected in (("1", 1), ("3", 3)):
        monkeypatch.setenv("OMP_NUM_THREADS", told)
        assert threads() == expected
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1, 2, 3}, raising=False)
    for told in ("", "0", "many"):
        monkeypatch.setenv("OMP_NUM_THREADS", told)
        assert threads() == 4
