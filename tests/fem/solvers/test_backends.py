"""Properties that every linear solver library must have, choice between them, and fallbacks."""

import re
import warnings

import numpy as np
import pytest
from scipy.linalg import eigvalsh
from scipy.sparse import csr_array
from scipy.sparse.linalg import spsolve
from support.fakes.graphics_card import (
    CUDARuntimeError,
    CuDSSError,
    OutOfMemoryError,
    discard_card,
    insert_card,
)
from support.fakes.petsc_installation import require_petsc

from fem.bodies.solid import clamped_leg, solid_leg
from fem.reduction.counted_modes import counted_modes
from fem.reduction.held import free_body, held_body
from fem.solvers.backends import cudss
from fem.solvers.backends.choice import (
    GAIN_FROM,
    SolverFallbackWarning,
    choose,
    solver_name,
)
from fem.solvers.backends.cudss import Device
from fem.solvers.backends.protocol import HOST
from fem.solvers.backends.request import require_usable
from fem.solvers.backends.rslab import RslabOrdering
from fem.solvers.certificate import count_below, pencil
from fem.solvers.factor import Inertia, NotPositiveDefiniteError, analyse
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle
from lumped.solver_request import RANKS_VARIABLE, VARIABLE, Solver, requested_solver
from meshes.prism import extrude, stations
from meshes.section.section_mesh import SectionMesh

FAKE, SUPERLU = "cudss on a fake card", "superlu"
STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)


@pytest.fixture(autouse=True)
def fresh_memos():
    yield
    discard_card()


@pytest.fixture(scope="module")
def leg():
    """Return a leg of six hexahedra in a row, numbered by hand so that gmsh is not needed."""
    y, z = (side.ravel() for side in np.meshgrid([-0.02, 0.0, 0.02], [-0.03, 0.0, 0.03]))
    cell = np.array([[0, 2, 8, 6, 1, 5, 7, 3, 4]])
    section = SectionMesh(np.column_stack([y, z]), cell, "quad9")
    mesh = extrude(section, stations(0.3, 6))
    return solid_leg(ConstantLeg(0.3, Rectangle(0.04, 0.06), STEEL), mesh)


@pytest.fixture(scope="module")
def matrices(leg):
    """Return stiffness and mass of the leg without the nodes of its root."""
    fixed_unknowns = np.add.outer(3 * leg.mesh.root.nodes, range(3)).ravel()
    free = np.setdiff1d(np.arange(leg.stiffness.shape[0]), fixed_unknowns)
    return leg.stiffness[free][:, free], leg.mass[free][:, free]


@pytest.fixture
def card(monkeypatch):
    """Return a simulated graphics card, requested by the environment variable."""
    monkeypatch.setenv(VARIABLE, Solver.CUDSS)
    return insert_card(monkeypatch)


@pytest.fixture(params=["rslab", FAKE, "cudss", "petsc on 1 rank", "petsc on 2 ranks", SUPERLU])
def backend(request, monkeypatch):
    """Select each library in turn; cuDSS on a real card and PETSc only where they are installed."""
    solver, _, ranks = request.param.partition(" on ")
    monkeypatch.setenv(VARIABLE, "auto" if solver == SUPERLU else solver)
    if request.param == FAKE:
        insert_card(monkeypatch)
    elif solver == "cudss" and cudss.device() is None:
        pytest.skip("no graphics card, or the extra gpu is not installed")
    elif solver == "petsc":
        monkeypatch.setenv(RANKS_VARIABLE, ranks.split()[0])
        require_petsc()
    elif solver == SUPERLU:
        monkeypatch.setattr("fem.solvers.backends.rslab.load_error", lambda: "damaged")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore" if solver == SUPERLU else "error", SolverFallbackWarning)
        yield request.param


@pytest.mark.usefixtures("backend")
class TestEveryLibrary:
    @pytest.mark.parametrize("columns", [0, 1, 8, 40])
    def test_solution_equals_superlu(self, matrices, columns):
        """None to forty right-hand sides, against SciPy's SuperLU."""
        K, _ = matrices
        loads = np.random.default_rng(1).standard_normal((K.shape[0], columns))
        solution = analyse(K).factorise().solve(loads)
        assert solution.shape == loads.shape
        if columns:
            expected = spsolve(K.tocsc(), loads).reshape(loads.shape)
            # Two factorisations differ by the condition number, 1e6, times 1e-16.
            assert np.abs(solution - expected).max() <= 1e-9 * np.abs(expected).max()

    def test_backward_error_is_small(self, matrices):
        """Residual of the solution below 1e-13 of |K||u| + |f|."""
        K, _ = matrices
        load = np.random.default_rng(2).standard_normal(K.shape[0])
        solution = analyse(K).factorise().solve(load)
        assert solution.shape == load.shape
        # Twice the energy equals the work of the loads; observed differences are below 1e-15.
        assert solution @ (K @ solution) == pytest.approx(load @ solution, rel=1e-12)
        size = np.abs(K.data).max() * np.abs(solution).max() + np.abs(load).max()
        assert np.abs(K @ solution - load).max() <= 1e-13 * size

    def test_earlier_factor_stays_valid(self, matrices):
        """A factor still solves after another matrix with equal sparsity was factorised."""
        K, M = matrices
        matrix_pencil = pencil(K, M)
        load = np.ones(K.shape[0])
        first = matrix_pencil.symbolic.factorise()
        before = first.solve(load)
        other = matrix_pencil.shifted(-1e6).factorise()
        assert np.abs((K + 1e6 * M) @ other.solve(load) - load).max() <= 1e-6
        # Two factorisations differ by the condition number, 1e6, times 1e-16.
        size = np.abs(before).max()
        np.testing.assert_allclose(first.solve(load), before, rtol=0.0, atol=1e-9 * size)
        repeated = matrix_pencil.symbolic.factorise().solve(load)
        np.testing.assert_allclose(repeated, before, rtol=0.0, atol=1e-9 * size)

    def test_eigenvalue_count_equals_dense_count(self, matrices):
        """Counts by inertia below shifts between the eigenvalues of a dense solution."""
        K, M = matrices
        exact, matrix_pencil = eigvalsh(K.toarray(), M.toarray()), pencil(K, M)
        for below in (0, 1, 5, 40):
            sigma = exact[0] / 2.0 if below == 0 else (exact[below - 1] + exact[below]) / 2.0
            assert count_below(matrix_pencil, sigma) == Inertia(below, 0, len(exact) - below)

    def test_empty_matrix_has_no_modes(self):
        """The matrix of a body without free unknowns."""
        assert analyse(csr_array((0, 0))).indefinite("held").inertia == Inertia(0, 0, 0)

    def test_indefinite_matrix_is_refused(self, matrices):
        """Dynamic stiffness K − ω²M at 10 kHz, above the first frequencies of the leg."""
        K, M = matrices
        with pytest.raises(NotPositiveDefiniteError, match="leg 1"):
            analyse(K - 2.0 * (2.0 * np.pi * 1e4) ** 2 * M).factorise("leg 1")

    def test_unsupported_body_is_refused(self, leg):
        """The stiffness of a leg without supports is singular: six rigid-body motions."""
        with pytest.raises(NotPositiveDefiniteError, match="rigid body"):
            analyse(leg.stiffness).factorise()

    def test_chain_on_round_off_support_is_refused(self):
        """Chain on a support of 40 or 4000 rounding units: the stiffer one is accepted."""
        chain = 2.0 * np.eye(20) - np.eye(20, k=1) - np.eye(20, k=-1)
        for roundings in (40.0, 4000.0):
            chain[0, 0] = chain[-1, -1] = 1.0
            chain[0, 0] += roundings * np.finfo(float).eps
            symbolic = analyse(csr_array(chain))
            if roundings > 100.0:
                symbolic.factorise("chain")
            else:
                with pytest.raises(NotPositiveDefiniteError):
                    symbolic.factorise("chain")

    def test_zero_pivot_is_handled_or_reported(self):
        """With a zero diagonal a library uses 2×2 pivots or must report zero pivots."""
        B = np.random.default_rng(5).standard_normal((6, 6))
        matrix = np.block([[np.zeros((6, 6)), B], [B.T, np.zeros((6, 6))]])
        count = count_below(pencil(csr_array(matrix), csr_array((12, 12))), 0.0)
        assert count.zero or count == Inertia(6, 0, 6)
        singular = csr_array(np.diag([1.0, 0.0, -1.0]))
        assert count_below(pencil(singular, csr_array((3, 3))), 0.0).zero >= 1

    def test_compliance_and_modes_equal_rslab(self, leg, monkeypatch):
        """Compliances agree to 1e-10, frequencies to 1e-9, and counts are equal.

        Clamped body, body with fixed interfaces, and free body.
        """

        def numbers():
            body = clamped_leg(leg)
            modes = body.modes(12)
            kinds = [counted_modes(kind(body), 2e4) for kind in (held_body, free_body)]
            return body.compliance, modes, kinds

        compliance, modes, kinds = numbers()
        monkeypatch.undo()
        monkeypatch.setenv(VARIABLE, "rslab")
        assert type(analyse(leg.stiffness).analysis.ordering) is RslabOrdering
        expected, expected_modes, expected_kinds = numbers()
        np.testing.assert_allclose(
            compliance, expected, rtol=0.0, atol=1e-10 * np.abs(expected).max()
        )
        np.testing.assert_allclose(modes.frequencies, expected_modes.frequencies, rtol=1e-9)
        assert modes.count == expected_modes.count
        for kind, expected_kind in zip(kinds, expected_kinds, strict=True):
            np.testing.assert_allclose(kind.frequencies, expected_kind.frequencies, rtol=1e-9)
            assert kind.counted == expected_kind.counted

    def test_repeated_solution_agrees(self, leg):
        """Compliances agree to 1e-10, frequencies to 1e-9; only rslab repeats bits."""
        first, second = (clamped_leg(leg) for _ in range(2))
        size = np.abs(first.compliance).max()
        np.testing.assert_allclose(second.compliance, first.compliance, rtol=0, atol=1e-10 * size)
        frequencies = [body.modes(6).frequencies for body in (first, second)]
        np.testing.assert_allclose(*frequencies, rtol=1e-9)


CARD, SMALL = Device("card", 80_000_000_000), Device("small card", 4_000_000_000)


@pytest.mark.parametrize(
    ("request_", "unknowns", "card", "expected"),
    [
        ("auto", GAIN_FROM - 1, CARD, "rslab"),
        ("auto", GAIN_FROM, CARD, "cudss"),
        ("auto", 10**7, CARD, "cudss"),
        ("auto", 10**7, None, "rslab"),
        ("auto", 10**7, SMALL, "rslab"),
        ("auto", 10**6, SMALL, "cudss"),
        ("cudss", 10**7, SMALL, "cudss"),
        ("petsc", 1, CARD, "petsc"),
        ("petsc", 10**7, None, "petsc"),
        ("rslab", 10**7, CARD, "rslab"),
        ("rslab", 10**7, None, "rslab"),
        ("cudss", 1, CARD, "cudss"),
    ],
)
def test_solver_follows_request_size_and_card(request_, unknowns, card, expected):
    """`auto` takes cudss from GAIN_FROM unknowns on if the card's memory suffices, else rslab."""
    assert choose(Solver(request_), unknowns, card) is Solver(expected)


def test_invalid_environment_variable_is_refused(monkeypatch):
    """FLEXPROOF_SOLVER: empty is auto, unknown names are refused with the valid ones."""
    for text, expected in (("", "auto"), ("auto", "auto"), ("rslab", "rslab"), ("petsc", "petsc")):
        monkeypatch.setenv(VARIABLE, text)
        assert requested_solver() is Solver(expected)
    monkeypatch.delenv(VARIABLE)
    assert requested_solver() is Solver.AUTO
    monkeypatch.setenv(VARIABLE, "pardiso")
    with pytest.raises(InputError, match='FLEXPROOF_SOLVER = "pardiso": must be auto, rslab, cud'):
        requested_solver()


def test_cudss_without_card_is_refused(monkeypatch, matrices):
    """Missing packages and a missing card are two different messages."""
    monkeypatch.setenv(VARIABLE, "cudss")
    monkeypatch.setattr("fem.extras.find_spec", lambda _: None)
    discard_card()
    with pytest.raises(InputError, match=r"solver cudss: needs cupy and nvmath, not installed"):
        analyse(matrices[0])
    insert_card(monkeypatch)
    import cupy  # noqa: PLC0415  the fake one

    monkeypatch.setattr(cupy.cuda.runtime, "getDeviceCount", lambda: 0)
    with pytest.raises(InputError, match=r"CUDA finds no graphics card; must be auto"):
        analyse(matrices[0])


def test_failing_gpu_driver_means_no_card(monkeypatch):
    """`auto` then takes rslab. `cudss` is refused with the message of the driver."""
    insert_card(monkeypatch)
    import cupy  # noqa: PLC0415  the fake one

    def failing():
        raise CUDARuntimeError("no CUDA-capable device is detected")

    monkeypatch.setattr(cupy.cuda.runtime, "getDeviceCount", failing)
    assert cudss.device() is None
    monkeypatch.setenv(VARIABLE, "auto")
    assert solver_name().startswith("rslab")
    with pytest.raises(InputError, match=r"\(no CUDA-capable device is detected\)"):
        require_usable(Solver.CUDSS)


def test_solver_name_has_libraries_and_card(monkeypatch):
    """The name in results: library, version and card, and the size from which `auto` takes it."""
    insert_card(monkeypatch)
    assert cudss.device() == Device("fake card", 8_000_000_000)
    monkeypatch.setenv(VARIABLE, "cudss")
    assert solver_name() == "cuDSS 0.8.0 on fake card"
    monkeypatch.setenv(VARIABLE, "rslab")
    assert "cuDSS" not in solver_name()
    monkeypatch.setenv(VARIABLE, "auto")
    assert solver_name().endswith(f"; from {GAIN_FROM} unknowns cuDSS 0.8.0 on fake card")


def test_small_matrix_is_solved_on_host(monkeypatch, matrices):
    """A matrix that a graphics card would not solve faster is never sent to it."""
    monkeypatch.setenv(VARIABLE, "auto")
    card = insert_card(monkeypatch)
    assert analyse(matrices[0]).space is HOST
    assert not card.calls


def numbers_of(leg):
    body = clamped_leg(leg)
    modes = body.modes(8)
    return body.compliance, modes.frequencies, modes.shapes, modes.count


LOST = CuDSSError("EXECUTION_FAILED (5)")


@pytest.mark.parametrize(
    ("call", "error", "message"),
    [
        ("ANALYSIS", LOST, r"EXECUTION_FAILED \(5\)"),
        ("FACTORIZATION", LOST, "EXECUTION_FAILED"),
        ("REFACTORIZATION", LOST, "EXECUTION_FAILED"),
        ("SOLVE", LOST, "EXECUTION_FAILED"),
        ("FACTORIZATION", OutOfMemoryError(), "out of memory on the card"),
        ("synchronize", CUDARuntimeError("unspecified launch failure"), "launch failure"),
        ("empty", OutOfMemoryError(), "out of memory on the card"),
        ("empty", TypeError("no such\n layout"), "no such layout"),
    ],
)
@pytest.mark.parametrize("after", [0, 1, 6])
def test_failing_card_gives_one_warning(leg, card, monkeypatch, call, error, message, after):
    """A graphics card fails at its first or a later call: all results are those of rslab."""
    card.fails = call, error, after
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        results = numbers_of(leg)
    lines = [str(w.message) for w in caught if w.category is SolverFallbackWarning]
    is_called = card.calls.count(call) > after
    assert len(lines) == is_called
    if is_called:
        assert re.fullmatch(
            f"graphics card: .*{message}.*; the processor computes instead", lines[0]
        )
    monkeypatch.setenv(VARIABLE, "rslab")
    expected = numbers_of(leg)
    np.testing.assert_allclose(results[0], expected[0], atol=1e-10 * np.abs(expected[0]).max())
    np.testing.assert_allclose(results[1], expected[1], rtol=1e-9)
    assert results[3] == expected[3]


def test_full_card_memory_gives_warning(leg, card):
    """A matrix that needs more than the card's free memory is factorised on the host."""
    card.free = 1_000_000
    with pytest.warns(
        SolverFallbackWarning, match=r"unknowns need about 0\.0 GB of the card's memory"
    ):
        body = clamped_leg(leg)
    assert body.space is HOST
    assert "FACTORIZATION" not in card.calls


def test_mode_search_stays_on_card(leg, card):
    """Each block of vectors of the search is solved on the card in one call, without copies."""
    body = clamped_leg(leg)
    assert body.space is not HOST
    _ = body.compliance
    card.calls.clear()
    body.modes(8)
    assert card.calls.count("REFACTORIZATION") == 1
    assert card.calls.count("ANALYSIS") == 0


def test_deleted_factor_frees_memory(matrices, card):
    """All handles of the graphics card are released with the Python object."""
    symbolic = analyse(matrices[0])
    symbolic.factorise().solve(np.ones(symbolic.size))
    assert card.alive == 3
    del symbolic
    assert card.alive == 0
