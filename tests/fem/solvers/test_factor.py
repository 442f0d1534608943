"""Sparse factors against SuperLU, refused matrices, and counts of eigenvalues by inertia."""

import pickle

import numpy as np
import pytest
from scipy.linalg import eigvalsh
from scipy.sparse import block_diag, csr_array, eye_array
from scipy.sparse.linalg import spsolve
from support.robots.paper_legs import STEEL, meshed

from fem.machine import threads
from fem.solvers.certificate import count_below, pencil
from fem.solvers.factor import Inertia, NotPositiveDefiniteError, analyse, upper_triangle
from fem.solvers.modes import MissedModesError
from lumped.errors import ComputationError
from lumped.legs import ConstantLeg
from lumped.sections import Rectangle


def without(matrix, fixed_unknowns):
    """Return the matrix without the rows and columns `fixed_unknowns`."""
    free = np.setdiff1d(np.arange(matrix.shape[0]), fixed_unknowns)
    return matrix[free][:, free]


def solid_and_root(length, slices):
    """Return a solid leg and the numbers of the unknowns of its root."""
    solid = meshed(ConstantLeg(length, Rectangle(0.04, 0.06), STEEL), 2, slices)
    return solid, np.add.outer(3 * solid.mesh.root.nodes, range(3)).ravel()


@pytest.fixture(scope="module")
def short_leg():
    """Return stiffness and mass of a leg without the nodes of its root."""
    solid, root = solid_and_root(0.3, 4)
    return without(solid.stiffness, root), without(solid.mass, root)


def assert_solves(factor, matrix, columns=2):
    loads = np.random.default_rng(1).standard_normal((matrix.shape[0], columns))
    expected, solution = spsolve(matrix.tocsc(), loads), factor.solve(loads)
    assert solution.shape == loads.shape
    # Two factorisations differ by the condition number, here 1e6, times 1e-16.
    assert np.abs(solution - expected).max() <= 1e-9 * np.abs(expected).max()


def test_two_factors_are_independent(short_leg):
    """Three matrices factorised at a time; each solution is that of its own matrix."""
    K, M = short_leg
    pieces = csr_array(block_diag([K[:size, :size] for size in (300, 90, 600, 60)]))
    matrices = K, K + 1e6 * M, pieces
    factors = [analyse(matrix).factorise() for matrix in matrices]
    for factor, matrix, columns in zip(factors, matrices, (40, 2, 3), strict=True):
        assert_solves(factor, matrix, columns)
    solution = factors[0].solve(np.ones(K.shape[0]))
    np.testing.assert_allclose(K @ solution, 1.0, atol=1e-6)
    assert factors[0].solve(np.ones((K.shape[0], 0))).shape == (K.shape[0], 0)
    by_triangle = analyse(upper_triangle(K)).factorise()
    np.testing.assert_array_equal(by_triangle.solve(np.ones(K.shape[0])), solution)


def test_solution_bits_are_independent_of_threads(short_leg, monkeypatch):
    """One, two and four threads give equal bits. OMP_NUM_THREADS sets their number."""
    loads = np.random.default_rng(5).standard_normal((short_leg[0].shape[0], 8))
    solutions = []
    for setting in ("1", "2", "4"):
        monkeypatch.setenv("OMP_NUM_THREADS", setting)
        solutions.append(analyse(short_leg[0]).factorise().solve(loads))
        np.testing.assert_array_equal(solutions[-1], solutions[0])
    monkeypatch.setattr("os.sched_getaffinity", lambda _: {0, 1, 2, 3}, raising=False)
    for setting, expected in (("3", 3), ("", 4), ("0", 4), ("many", 4)):
        monkeypatch.setenv("OMP_NUM_THREADS", setting)
        assert threads() == expected


def test_indefinite_factor_is_refused(short_leg, capfd):
    """Dynamic stiffness of a leg at 10 kHz, and a chain with one negative eigenvalue."""
    K, M = short_leg
    with pytest.raises(NotPositiveDefiniteError, match=r"leg 1: .*not positive definite"):
        analyse(K - 2.0 * (2.0 * np.pi * 1e4) ** 2 * M).factorise("leg 1")
    assert capfd.readouterr() == ("", "")
    # A chain with one negative eigenvalue; those of second differences are 2 − 2 cos(kπ/(n+1)).
    n = 300
    chain = 2.0 * eye_array(n) - eye_array(n, k=1) - eye_array(n, k=-1)
    lowest = 2.0 - 2.0 * np.cos(np.array([1.0, 2.0]) * np.pi / (n + 1))
    with pytest.raises(NotPositiveDefiniteError):
        analyse(csr_array(chain - lowest.mean() * eye_array(n))).factorise()
    sound = csr_array(chain - 0.5 * lowest[0] * eye_array(n))
    assert_solves(analyse(sound).factorise(), sound)


@pytest.mark.parametrize(("slices", "length"), [(3, 0.3), (12, 0.3), (30, 20.0)])
def test_unsupported_solid_is_refused(slices, length):
    """Round-off may make the six zero eigenvalues positive. A clamped solid is accepted."""
    solid, root = solid_and_root(length, slices)
    with pytest.raises(NotPositiveDefiniteError, match="rigid body"):
        analyse(solid.stiffness).factorise()
    analyse(without(solid.stiffness, root)).factorise()
    # Five of six rigid motions are held, by three displacements of one node and two of another.
    with pytest.raises(NotPositiveDefiniteError):
        analyse(without(solid.stiffness, root[[0, 1, 2, -3, -2]])).factorise()


def test_factor_of_chain_held_by_round_off_is_refused():
    """Chains on a support of 40 or 4000 rounding units: the stiffer one is accepted."""
    chain = 2.0 * np.eye(20) - np.eye(20, k=1) - np.eye(20, k=-1)
    for roundings in (40.0, 4000.0):
        chain[0, 0] = chain[-1, -1] = 1.0
        chain[0, 0] += roundings * np.finfo(float).eps
        symbolic = analyse(csr_array(chain))
        assert symbolic.indefinite("chain").inertia == Inertia(0, 0, 20)
        if roundings > 100.0:
            symbolic.factorise("chain")
        else:
            with pytest.raises(NotPositiveDefiniteError):
                symbolic.factorise("chain")


def test_memory_is_checked_before_factoring(short_leg, monkeypatch):
    """The estimate is above the matrix itself. One byte less of free memory is refused."""
    symbolic = analyse(short_leg[0])
    # The factor needs at least the memory of the lower triangle of K.
    assert 8 * short_leg[0].nnz / 2 < symbolic.peak_bytes < 1e9
    monkeypatch.setattr(
        "fem.solvers.backends.factor_checks.available_memory", lambda: symbolic.peak_bytes - 1
    )
    with pytest.raises(ComputationError, match=r"leg 2: factorising \d+ unknowns needs about"):
        symbolic.factorise("leg 2")


@pytest.mark.parametrize(
    "error", [NotPositiveDefiniteError("leg 1"), MissedModesError("leg 1: 2 missing", 2)]
)
def test_solver_errors_survive_pickling(error):
    """Errors raised in worker processes are pickled; their class, text and data arrive."""
    arrived = pickle.loads(pickle.dumps(error))  # noqa: S301  its own bytes
    assert (type(arrived), str(arrived), vars(arrived)) == (type(error), str(error), vars(error))


def test_eigenvalue_count_with_2x2_pivots():
    """With a zero diagonal only 2×2 pivots exist; eigenvalues are ± the singular values of B."""
    B = np.random.default_rng(5).standard_normal((6, 6))
    matrix = np.block([[np.zeros((6, 6)), B], [B.T, np.zeros((6, 6))]])
    count = count_below(pencil(csr_array(matrix), csr_array((12, 12))), 0.0)
    assert count == Inertia((eigvalsh(matrix) < 0).sum(), 0, 6) == Inertia(6, 0, 6)
    singular = csr_array(np.diag([1.0, 0.0, -1.0]))
    assert count_below(pencil(singular, csr_array((3, 3))), 0.0) == Inertia(1, 1, 1)


def test_mode_count_with_extra_mass_entries():
    """M has entries where K is zero; an entry of K − σM becomes zero by cancellation.

    The count equals that of dense eigenvalues.
    """
    K, M = np.diag([1.0, 2.0, 6.0]), np.array([[2.0, 1.0, 0.0], [1.0, 2.0, 0.5], [0.0, 0.5, 3.0]])
    K[0, 2] = K[2, 0] = M[0, 2] = M[2, 0] = 0.25
    exact, matrix_pencil = eigvalsh(K, M), pencil(csr_array(K), csr_array(M))
    for sigma in (0.1, 0.9, 1.0, 1.9, 9.0):
        assert count_below(matrix_pencil, sigma).negative == (exact < sigma).sum()
