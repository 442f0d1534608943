"""CHOLMOD by cvxopt's public interface: what is used where its factor cannot be read."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.sparse import csr_array

from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from fem.solvers import cholesky
from fem.solvers.cholmod import public_factor, supernodes
from fem.solvers.factor import NotPositiveDefiniteError
from lumped.legs import ConstantLeg, Material
from lumped.sections import Rectangle

LEG = ConstantLeg(0.4, Rectangle(0.1, 0.14), Material.isotropic(2.1e11, 0.3, 7850.0))


@pytest.fixture
def asked_anew():
    """The question whether factors can be read is answered once; here, and after, once more."""
    public_factor.factors_are_readable.cache_clear()
    yield
    public_factor.factors_are_readable.cache_clear()


@pytest.fixture
def unread(monkeypatch):
    monkeypatch.setattr(cholesky, "factors_are_readable", lambda: False)


@pytest.mark.usefixtures("asked_anew")
def test_the_factor_of_the_cvxopt_that_is_locked_is_read():
    assert public_factor.factors_are_readable()
    assert cholesky.solver_name() == "CHOLMOD (cvxopt) with METIS"


@pytest.mark.usefixtures("asked_anew")
@pytest.mark.parametrize(
    ("where", "name", "other"),
    [
        (public_factor, "version", lambda _library: "1.4.0"),
        (supernodes, "elimination_order", lambda _factor: np.arange(432)[::-1]),
        (public_factor.library, "solve_columns", lambda _factor, columns: columns),
    ],
)
def test_another_version_or_layout_is_noticed(monkeypatch, where, name, other):
    monkeypatch.setattr(where, name, other)
    assert not public_factor.factors_are_readable()
    assert cholesky.solver_name().endswith("by cvxopt's public interface (slower)")
    symbolic = cholesky.analyse(csr_array(np.eye(3)))
    assert isinstance(
        cholesky.factorise(symbolic, csr_array(np.eye(3))), public_factor.PublicFactor
    )


def test_compliance_and_modes_are_those_of_the_factor_that_is_read(monkeypatch):
    solid = solid_leg(LEG, solid_mesh(LEG, 2))
    read = clamped_leg(solid, "rigid")
    expected, frequencies = read.compliance, read.modes(3).frequencies
    monkeypatch.setattr(cholesky, "factors_are_readable", lambda: False)
    public = clamped_leg(solid, "rigid")
    assert isinstance(public.factor.numeric, public_factor.PublicFactor)
    assert_allclose(public.compliance, expected, rtol=0.0, atol=1e-10 * expected.max())
    assert_allclose(public.modes(3).frequencies, frequencies, rtol=1e-9)


@pytest.mark.usefixtures("unread")
def test_one_right_hand_side_and_none_keep_their_shape():
    matrix = csr_array(np.diag([1.0, 2.0, 4.0]))
    factor = cholesky.factorise(cholesky.analyse(matrix), matrix)
    assert_allclose(factor.solve(np.ones(3)), [1.0, 0.5, 0.25])
    assert factor.solve(np.zeros((3, 0))).shape == (3, 0)


@pytest.mark.usefixtures("unread")
@pytest.mark.parametrize("last", [-1.0, 0.0])
def test_a_matrix_that_is_not_positive_definite_is_refused(last):
    matrix = csr_array(np.array([[2.0, 1.0, 0.0], [1.0, 0.5 + last, 0.0], [0.0, 0.0, 1.0]]))
    with pytest.raises(NotPositiveDefiniteError, match="held leg: the matrix is not positive"):
        cholesky.factorise(cholesky.analyse(matrix), matrix, "held leg")
