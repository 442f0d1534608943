import importlib.util
import pickle

import numpy as np
import pytest
from prismatic_legs import STEEL
from scipy.sparse import block_diag, csr_array, diags_array, eye_array
from scipy.sparse.linalg import spsolve

import fem.solvers.cholesky
import fem.solvers.factor
from fem.elements.elasticity import stiffness_and_mass
from fem.solvers.cholesky import analyse, default_backend, factorise
from fem.solvers.cholmod.bisected_factor import BisectedFactor
from fem.solvers.cholmod.supernodes import statistics
from fem.solvers.cholmod.whole_factor import CholmodFactor, symbolic_factor
from fem.solvers.factor import NotPositiveDefiniteError, upper_triangle
from fem.solvers.modes import MissedModesError
from fem.solvers.ordering import block_graph, nested_dissection
from lumped.errors import ComputationError, InputError
from lumped.sections import Rectangle
from meshes.prism.extrude import extrude, stations
from meshes.section.section_mesh import section_mesh

CHOLMOD = {"whole": CholmodFactor, "halves": BisectedFactor}
# Solutions of one matrix by two eliminations differ by its condition number (here 1e6) times 1e-16.
SOLVER_TOLERANCE = 1e-9


@pytest.fixture(
    params=[
        *CHOLMOD,
        pytest.param(
            "mkl",
            marks=pytest.mark.skipif(
                importlib.util.find_spec("pypardiso") is None,
                reason="the extra mkl is not installed",
            ),
        ),
    ]
)
def elimination(request, monkeypatch):
    """Analysis by each way to eliminate, in halves a matrix that is far too small for two threads.

    Solutions are SuperLU's.
    """
    way = request.param
    if way in CHOLMOD:
        monkeypatch.setenv("OMP_NUM_THREADS", "2")
        monkeypatch.setattr(fem.solvers.cholesky, "_BISECTED", 0 if way == "halves" else 10**9)

    def analysed(matrix):
        return analyse(matrix, backend="cholmod" if way in CHOLMOD else way)

    def solves(factor, matrix, columns=2):
        assert isinstance(factor, CHOLMOD.get(way, object))
        loads = np.random.default_rng(1).standard_normal((matrix.shape[0], columns))
        expected, found = spsolve(matrix.tocsc(), loads), factor.solve(loads)
        assert found.shape == loads.shape
        assert np.abs(found - expected).max() <= SOLVER_TOLERANCE * np.abs(expected).max()

    return analysed, solves


def test_one_analysis_serves_several_matrices_at_once(short_leg, elimination):
    (K, M), (analysed, solves) = short_leg, elimination
    symbolic = analysed(K)
    matrices = K, K + 1e6 * M, diags_array(K.diagonal(), format="csr")
    factors = [factorise(symbolic, matrix) for matrix in matrices]
    for factor, matrix, columns in zip(factors, matrices, (40, 2, 2), strict=True):
        solves(factor, matrix, columns)
    one = factors[0].solve(np.ones(K.shape[0]))
    assert one.shape == (K.shape[0],)
    np.testing.assert_allclose(K @ one, 1.0, atol=1e-6)
    assert factors[0].solve(np.ones((K.shape[0], 0))).shape == (K.shape[0], 0)


def test_what_is_no_positive_definite_matrix_of_the_pattern_is_refused(short_leg, elimination):
    (K, M), (analysed, _) = short_leg, elimination
    symbolic = analysed(diags_array(K.diagonal(), format="csr"))
    with pytest.raises(ComputationError, match="outside the pattern"):
        factorise(symbolic, K)
    with pytest.raises(ComputationError, match="given to the analysis"):
        factorise(symbolic, K[:-3, :-3])
    shift = 2.0 * (2.0 * np.pi * 1e4) ** 2
    with pytest.raises(NotPositiveDefiniteError, match=r"leg 1: .*not positive definite.*unknown"):
        factorise(analysed(K), K - shift * M, part="leg 1")
    free, _ = stiffness_and_mass(
        extrude(section_mesh(Rectangle(0.04, 0.06), 2, "quad9"), stations(0.3, 3)), STEEL
    )
    with pytest.raises(NotPositiveDefiniteError, match="rigid body"):
        factorise(analysed(free), free)


def test_too_little_memory_is_said_before_the_factorisation(short_leg, elimination, monkeypatch):
    (K, _), (analysed, _) = short_leg, elimination
    symbolic = analysed(K)
    monkeypatch.setattr(fem.solvers.factor, "available_memory", lambda: symbolic.peak_bytes - 1)
    with pytest.raises(ComputationError, match=r"leg 2: factorising \d+ unknowns needs about"):
        factorise(symbolic, K, part="leg 2")


def test_block_solves_and_cvxopts_own_agree(short_leg, monkeypatch):
    K, _ = short_leg
    factor = factorise(analyse(K, backend="cholmod"), K)
    loads = np.random.default_rng(2).standard_normal((K.shape[0], 5))
    together = factor.solve(loads)
    monkeypatch.setattr("fem.solvers.cholmod.library._library", lambda: None)
    one_by_one = factor.solve(loads)
    assert np.abs(together - one_by_one).max() <= SOLVER_TOLERANCE * np.abs(together).max()


def test_predicted_size_is_the_factors(short_leg):
    """The factor's entries by a dense Cholesky of the pattern in the same order."""
    K, _ = short_leg
    symbolic = analyse(K, backend="cholmod")
    order = symbolic.elimination.order
    pattern = K.copy()
    pattern.data = np.random.default_rng(3).uniform(-1.0, -0.5, K.nnz)
    pattern = pattern + pattern.T
    dominant = pattern + diags_array(np.abs(pattern).sum(axis=1) + 1.0)
    lower = np.linalg.cholesky(dominant.toarray()[np.ix_(order, order)])
    entries = (lower != 0.0).sum()
    # Entries of such a factor do not cancel; far from the diagonal they fall to 1e-60, not to zero.
    handle, _ = symbolic_factor(upper_triangle(K), order)
    assert statistics(handle).entries == entries
    # Blocks that are half of a square for nothing, the triangle's copies, and no more.
    assert 8 * entries <= symbolic.peak_bytes <= 3 * 8 * entries + 60 * K.nnz


def test_backend_from_the_environment(monkeypatch):
    monkeypatch.delenv("FLEXPROOF_SOLVER", raising=False)
    assert default_backend() == "cholmod"
    monkeypatch.setenv("FLEXPROOF_SOLVER", "mkl")
    assert default_backend() == "mkl"
    monkeypatch.setenv("FLEXPROOF_SOLVER", "superlu")
    with pytest.raises(InputError, match="FLEXPROOF_SOLVER = 'superlu'"):
        default_backend()


def test_missing_extra_is_said(short_leg, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "pypardiso", None)
    with pytest.raises(ComputationError, match=r"flexproof\[mkl\]"):
        analyse(short_leg[0], backend="mkl")


def test_order_is_a_permutation_that_saves_fill(short_leg):
    K, _ = short_leg
    ends = csr_array(np.ones((12, K.shape[0])))
    coupled = block_diag([eye_array(12), K], format="lil")
    coupled[:12, 12:600] = ends.toarray()[:, :588]
    coupled[12:600, :12] = ends.toarray()[:, :588].T
    matrix = csr_array(coupled)
    order = nested_dissection(block_graph(matrix, leading=(6, 6))).order
    assert (np.sort(order) == np.arange(matrix.shape[0])).all()
    # Unknowns of one block stay together: six of an end, three of a node.
    places = np.argsort(order)
    assert (np.diff(places[:6]) == 1).all()
    assert (np.diff(places[12:].reshape(-1, 3), axis=1) == 1).all()
    with pytest.raises(ValueError, match="threes"):
        block_graph(matrix, leading=(6, 6, 1))


def test_upper_triangle_sorts_and_keeps_zeros():
    rows, columns = np.array([0, 0, 1, 2, 2, 0]), np.array([2, 0, 1, 2, 0, 2])
    matrix = csr_array((np.array([2.0, 5.0, 0.0, 4.0, 3.0, 1.0]), (rows, columns)), shape=(3, 3))
    triangle = upper_triangle(matrix)
    assert triangle.indptr.tolist() == [0, 2, 3, 4]
    assert triangle.indices.tolist() == [0, 2, 1, 2]
    assert triangle.data.tolist() == [5.0, 3.0, 0.0, 4.0]


@pytest.mark.parametrize(
    "error", [NotPositiveDefiniteError("leg 1", 7), MissedModesError("leg 1: 2 missing", 2)]
)
def test_errors_of_solvers_arrive_from_another_process(error):
    arrived = pickle.loads(pickle.dumps(error))  # noqa: S301  its own bytes
    assert (type(arrived), str(arrived), vars(arrived)) == (type(error), str(error), vars(error))
