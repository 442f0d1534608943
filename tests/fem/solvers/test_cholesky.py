"""Sparse factors by every way to eliminate, against SuperLU and a dense Cholesky."""

import importlib.util
import pickle

import numpy as np
import pytest
from prismatic_legs import STEEL
from scipy.sparse import block_diag, csr_array, diags_array, eye_array
from scipy.sparse.linalg import spsolve

import fem.solvers.cholesky
import fem.solvers.factor
from fem.elements.elasticity import stiffness
from fem.machine import threads
from fem.solvers import cholesky
from fem.solvers.cholesky import analyse, backend
from fem.solvers.cholmod import whole_factor
from fem.solvers.cholmod.bisected_factor import BisectedFactor
from fem.solvers.cholmod.kernel import kernel
from fem.solvers.cholmod.supernodes import entry_count
from fem.solvers.cholmod.whole_factor import CholmodFactor, PublicFactor, symbolic_factor
from fem.solvers.factor import NotPositiveDefiniteError, SeparatedFactor, upper_triangle
from fem.solvers.modes import MissedModesError
from lumped.errors import ComputationError, InputError
from lumped.sections import Rectangle
from meshes.prism.hexahedra import extrude, stations
from meshes.section.section_mesh import section_mesh

KIND = {"whole": CholmodFactor, "halves": BisectedFactor, "public": PublicFactor}
MKL = pytest.param(
    "mkl",
    marks=pytest.mark.skipif(
        importlib.util.find_spec("pypardiso") is None, reason="the extra mkl is not installed"
    ),
)
# Solutions of one matrix by two eliminations differ by its condition number (here 1e6) times 1e-16.
SOLVER_TOLERANCE = 1e-9


@pytest.fixture
def way(request, monkeypatch):
    """Each way to eliminate, in halves matrices that are far too small for two threads."""
    monkeypatch.setenv("OMP_NUM_THREADS", "2")
    monkeypatch.setenv("FLEXPROOF_SOLVER", "mkl" if request.param == "mkl" else "cholmod")
    if request.param == "halves":
        monkeypatch.setattr(fem.solvers.cholesky, "_BISECTED", 0)
    if request.param == "public":
        monkeypatch.setattr(fem.solvers.cholesky, "factors_are_readable", lambda: False)
    return request.param


every_way = pytest.mark.parametrize("way", [*KIND, MKL], indirect=True)
separated = pytest.mark.parametrize("way", ["whole", "halves"], indirect=True)
in_halves = pytest.mark.parametrize("way", ["halves"], indirect=True)


def factor_of(matrix, way):
    factor = analyse(matrix).factorise()
    assert type(factor) is KIND.get(way, type(factor))
    assert isinstance(factor, SeparatedFactor) == (way in ("whole", "halves"))
    return factor


def assert_solves(factor, matrix, columns=2):
    loads = np.random.default_rng(1).standard_normal((matrix.shape[0], columns))
    expected, found = spsolve(matrix.tocsc(), loads), factor.solve(loads)
    assert found.shape == loads.shape
    assert np.abs(found - expected).max() <= SOLVER_TOLERANCE * np.abs(expected).max()


@every_way
def test_factors_of_several_matrices_at_once(short_leg, way):
    K, M = short_leg
    matrices = K, K + 1e6 * M
    factors = [factor_of(matrix, way) for matrix in matrices]
    for factor, matrix, columns in zip(factors, matrices, (40, 2), strict=True):
        assert_solves(factor, matrix, columns)
    one = factors[0].solve(np.ones(K.shape[0]))
    assert one.shape == (K.shape[0],)
    np.testing.assert_allclose(K @ one, 1.0, atol=1e-6)
    assert factors[0].solve(np.ones((K.shape[0], 0))).shape == (K.shape[0], 0)
    by_triangle = factor_of(upper_triangle(K), way)
    np.testing.assert_array_equal(by_triangle.solve(np.ones(K.shape[0])), one)


@every_way
@pytest.mark.usefixtures("way")
def test_what_is_not_positive_definite_is_refused(short_leg, capfd):
    K, M = short_leg
    shift = 2.0 * (2.0 * np.pi * 1e4) ** 2
    with pytest.raises(NotPositiveDefiniteError, match=r"leg 1: .*not positive definite.*unknown"):
        analyse(K - shift * M).factorise("leg 1")
    section = section_mesh(Rectangle(0.04, 0.06), 2)
    free = stiffness(extrude(section, stations(0.3, 3)), STEEL)
    with pytest.raises(NotPositiveDefiniteError, match="rigid body"):
        analyse(free).factorise()
    assert capfd.readouterr() == ("", "")


def test_too_little_memory_is_said_before_the_factorisation(short_leg, monkeypatch):
    symbolic = analyse(short_leg[0])
    monkeypatch.setattr(fem.solvers.factor, "available_memory", lambda: symbolic.peak_bytes - 1)
    with pytest.raises(ComputationError, match=r"leg 2: factorising \d+ unknowns needs about"):
        symbolic.factorise("leg 2")


def test_predicted_size_is_the_factors(short_leg):
    """The factor's entries by a dense Cholesky of the pattern in the same order."""
    K, _ = short_leg
    symbolic = analyse(K)
    order = symbolic.elimination.order
    pattern = K.copy()
    pattern.data = np.random.default_rng(3).uniform(-1.0, -0.5, K.nnz)
    pattern = pattern + pattern.T
    dominant = pattern + diags_array(np.abs(pattern).sum(axis=1) + 1.0)
    lower = np.linalg.cholesky(dominant.toarray()[np.ix_(order, order)])
    entries = (lower != 0.0).sum()
    # Entries of such a factor do not cancel; far from the diagonal they fall to 1e-60, not to zero.
    handle, _ = symbolic_factor(upper_triangle(K), order)
    assert entry_count(handle) == entries
    # Blocks that are half of a square for nothing, the triangle's copies, and no more.
    assert 8 * entries <= symbolic.peak_bytes <= 3 * 8 * entries + 60 * K.nnz


@separated
def test_separators_and_products_across_them(short_leg, way):
    """Columns on separators, and columns anywhere: then all of L is on their paths."""
    K, _ = short_leg
    factor, n = factor_of(K, way), K.shape[0]
    separators = factor.separators(9)
    assert [len(s) for s in separators] == sorted((len(s) for s in separators), reverse=True)
    together = np.concatenate(separators)
    assert len(np.unique(together)) == len(together)
    if way == "halves":
        first, second = (half.order[: half.own] for half in factor.halves)
        assert K[first][:, second].nnz == 0
        # Halves by name: their work differs little.
        assert 0.7 < len(first) / len(second) < 1.4
    rng = np.random.default_rng(3)
    patches = np.zeros((n, 15))
    for number, separator in enumerate(separators[:5]):
        patches[separator[:12], 3 * number : 3 * number + 3] = rng.standard_normal((12, 3))
    anywhere = np.where(rng.random((n, 7)) < 0.02, rng.standard_normal((n, 7)), 0.0)
    for W in (patches, anywhere):
        expected = W.T @ spsolve(K.tocsc(), W)
        found = factor.gram(csr_array(W))
        assert np.abs(found - expected).max() <= SOLVER_TOLERANCE * np.abs(expected).max()


@in_halves
def test_the_unknown_of_a_negative_pivot_is_named(short_leg, way):
    K, _ = short_leg
    factor = factor_of(K, way)
    for unknown in (factor.halves[1].order[7], factor.separator[4]):
        # By its own diagonal entry alone: whatever is eliminated before makes it no larger.
        twice = diags_array(np.where(np.arange(K.shape[0]) == unknown, 2.0 * K.diagonal(), 0.0))
        with pytest.raises(NotPositiveDefiniteError, match="leg 1") as refused:
            analyse(csr_array(K - twice)).factorise("leg 1")
        assert refused.value.unknown == unknown


@in_halves
def test_whole_that_is_indefinite_although_both_halves_are_not(way):
    """A chain with ends that push each other: either half is positive definite with the other held.

    Eigenvalues of the second difference are 2 − 2 cos(kπ/(n+1)); a shift between the lowest of the
    chain and the lowest of its halves leaves one negative.
    """
    n = 300
    chain = 2.0 * eye_array(n) - eye_array(n, k=1) - eye_array(n, k=-1)
    lowest = 2.0 - 2.0 * np.cos(np.array([1.0, 2.0]) * np.pi / (n + 1))
    shifted = csr_array(chain - lowest.mean() * eye_array(n))
    with pytest.raises(NotPositiveDefiniteError):
        analyse(shifted).factorise()
    sound = csr_array(chain - 0.5 * lowest[0] * eye_array(n))
    assert_solves(factor_of(sound, way), sound)


@in_halves
@pytest.mark.usefixtures("way")
def test_pieces_that_are_not_coupled_and_factorisations_at_once(short_leg):
    """A half of several pieces may not keep its separator last, equal pieces need none.

    CHOLMOD's workspaces are apart and its BLAS locks its buffers: the same bits every time.
    """
    K, _ = short_leg
    for sizes in ((300, 90, 600, 60), (300, 300)):
        pieces = csr_array(block_diag([K[:size, :size] for size in sizes]))
        assert_solves(analyse(pieces).factorise(), pieces)
    symbolic = analyse(K)
    loads = np.random.default_rng(5).standard_normal((K.shape[0], 8))
    first = symbolic.factorise().solve(loads)
    for _ in range(8):
        np.testing.assert_array_equal(symbolic.factorise().solve(loads), first)


def test_halves_for_large_matrices_and_two_threads_alone(short_leg, monkeypatch):
    for told, size, kind in (("2", 0, "halves"), ("1", 0, "whole"), ("2", 10**6, "whole")):
        monkeypatch.setenv("OMP_NUM_THREADS", told)
        monkeypatch.setattr(fem.solvers.cholesky, "_BISECTED", size)
        factor_of(short_leg[0], kind)
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1, 2, 3}, raising=False)
    for told, expected in (("3", 3), ("", 4), ("0", 4), ("many", 4)):
        monkeypatch.setenv("OMP_NUM_THREADS", told)
        assert threads() == expected


@pytest.fixture
def asked_anew():
    """The question whether factors can be read is answered once; here, and after, once more."""
    whole_factor.factors_are_readable.cache_clear()
    yield
    whole_factor.factors_are_readable.cache_clear()


@pytest.mark.usefixtures("asked_anew")
@pytest.mark.parametrize(
    ("where", "name", "other"),
    [
        (whole_factor, "_READ", ("1.3.",)),
        (whole_factor, "version", lambda _library: "1.4.0"),
        (whole_factor, "library", lambda: None),
        (whole_factor, "elimination_order", lambda _factor: np.arange(432)[::-1]),
        (CholmodFactor, "_solved", lambda _self, columns: columns),
    ],
)
def test_another_version_or_layout_than_the_locked_one_is_noticed(monkeypatch, where, name, other):
    monkeypatch.setattr(where, name, other)
    read = name == "_READ"
    assert whole_factor.factors_are_readable() == read
    reached = "" if read else ", by cvxopt's public interface (slower)"
    assert cholesky.solver_name() == f"CHOLMOD (cvxopt, {kernel()} kernel) with METIS{reached}"
    matrix = csr_array(np.eye(3))
    assert type(analyse(matrix).factorise()) is (CholmodFactor if read else PublicFactor)


def test_backend_from_the_environment(short_leg, monkeypatch):
    monkeypatch.delenv("FLEXPROOF_SOLVER", raising=False)
    assert backend() == "cholmod"
    monkeypatch.setenv("FLEXPROOF_SOLVER", "superlu")
    with pytest.raises(InputError, match="FLEXPROOF_SOLVER = 'superlu'"):
        backend()
    monkeypatch.setenv("FLEXPROOF_SOLVER", "mkl")
    monkeypatch.setitem(__import__("sys").modules, "pypardiso", None)
    with pytest.raises(ComputationError, match=r"flexproof\[mkl\]"):
        analyse(short_leg[0])


@pytest.mark.parametrize(
    "error", [NotPositiveDefiniteError("leg 1", 7), MissedModesError("leg 1: 2 missing", 2)]
)
def test_errors_of_solvers_arrive_from_another_process(error):
    arrived = pickle.loads(pickle.dumps(error))  # noqa: S301  its own bytes
    assert (type(arrived), str(arrived), vars(arrived)) == (type(error), str(error), vars(error))
