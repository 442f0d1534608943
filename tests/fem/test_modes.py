import numpy as np
import pytest
from scipy.linalg import eigh, null_space
from scipy.sparse import csr_array, eye_array

from fem.cholesky import analyse, factorise
from fem.modes import certify, clamped_count, lowest_modes, modes
from fem.solid import clamped_leg, solid_leg
from fem.sturm import count_below
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, Material
from lumped.sections import Circle, Rectangle, Tube
from meshes.extrude import extrude, stations
from meshes.section_mesh import section_mesh
from meshes.tetrahedra import tetrahedra

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
# Both solve one matrix pencil; what is left is rounding, eps times the condition of K (some 1e5).
SAME = 1e-10


def leg(section, length=0.6, slices=6, ends="rigid"):
    one = ConstantLeg(length, section, STEEL)
    return clamped_leg(
        solid_leg(one, extrude(section_mesh(section, 1), stations(length, slices))), ends
    )


def dense_solution(clamped):
    """Eigenvalues and vectors (on the leg's unknowns) by LAPACK, constraints eliminated.

    As M φ = θ K φ: LAPACK's errors are relative to the largest eigenvalue, here the lowest mode's.
    """
    if hasattr(clamped.ends, "interior"):
        theta, vectors = eigh(clamped.mass.toarray(), clamped.stiffness.toarray())
    else:
        allowed = null_space(clamped.ends.root_loads.T)
        K, M = clamped.solid.stiffness, clamped.solid.mass
        theta, vectors = eigh(allowed.T @ (M @ allowed), allowed.T @ (K @ allowed))
        vectors = allowed @ vectors
    return 1.0 / theta[::-1], vectors[:, ::-1] / np.sqrt(theta[::-1])


def hertz(values):
    return np.sqrt(values) / (2.0 * np.pi)


@pytest.fixture(scope="module")
def bar():
    clamped = leg(Rectangle(0.08, 0.12))
    return clamped, *dense_solution(clamped)


@pytest.fixture(scope="module")
def square():
    """Every bending mode twice."""
    clamped = leg(Rectangle(0.1, 0.1))
    return clamped, *dense_solution(clamped)


@pytest.mark.parametrize("ends", ["rigid", "free"])
@pytest.mark.parametrize("section", [Rectangle(0.08, 0.12), Circle(0.1), Tube(0.1, 0.01)])
def test_modes_equal_a_dense_solution(section, ends):
    clamped = leg(section, slices=4, ends=ends)
    values, _ = dense_solution(clamped)
    found = modes(clamped, 8)
    np.testing.assert_allclose(found.frequencies, hertz(values[:8]), rtol=SAME)
    assert found.count == (values < found.shift).sum() >= 8
    gram = found.shapes.T @ (clamped.solid.mass @ found.shapes)
    np.testing.assert_allclose(gram, np.eye(8), atol=1e-12)


def test_tetrahedra():
    one = ConstantLeg(0.3, Rectangle(0.1, 0.1), STEEL)
    clamped = clamped_leg(solid_leg(one, tetrahedra(one.section, one.length, 1)))
    values, _ = dense_solution(clamped)
    np.testing.assert_allclose(modes(clamped, 8).frequencies, hertz(values[:8]), rtol=SAME)


def test_errors_bound_the_true_ones(bar):
    clamped, values, _ = bar
    found = modes(clamped, 20)
    true = np.abs(found.frequencies / hertz(values[:20]) - 1.0)
    # Beside the residual's share, rounding of LAPACK and of the factor.
    assert np.all(true <= found.frequency_errors + SAME)
    assert found.frequency_errors.max() <= 5e-7


def test_few_solves(bar):
    """88 measured here, in blocks of eight that read the factor once; room for one block more."""
    assert modes(bar[0], 20).solves <= 96


def test_two_runs_are_the_same(square):
    first, second = modes(square[0], 10), modes(square[0], 10)
    np.testing.assert_array_equal(first.frequencies, second.frequencies)
    np.testing.assert_array_equal(first.shapes, second.shapes)


def test_both_of_a_pair_when_the_start_has_one(square):
    clamped, values, vectors = square
    assert values[1] / values[0] - 1.0 < 1e-9
    found = modes(clamped, 6, start=vectors[:, [0, 2, 3]])
    np.testing.assert_allclose(found.frequencies, hertz(values[:6]), rtol=SAME)


def test_a_pair_that_the_number_of_modes_would_cut_stays_whole(square):
    clamped, values, _ = square
    found = modes(clamped, 1)
    assert (found.count, len(found.frequencies)) == (2, 1)
    assert values[1] < found.shift < values[2]


def test_start_without_a_wanted_mode(bar):
    clamped, values, vectors = bar
    found = modes(clamped, 6, start=vectors[:, [0, 1, 3, 4, 5, 6, 7]])
    np.testing.assert_allclose(found.frequencies, hertz(values[:6]), rtol=SAME)


@pytest.mark.parametrize("missing", [0, 3, 4])
@pytest.mark.parametrize("ends", ["rigid", "free"])
def test_a_missing_mode_fails_the_certificate(missing, ends):
    clamped = leg(Rectangle(0.08, 0.12), slices=3, ends=ends)
    values, _ = dense_solution(clamped)
    count = clamped_count(clamped, "cholmod")
    assert values[5] < certify(values[:7], 6, count, "leg") < values[6]
    with pytest.raises(ComputationError, match="leg: certificate of the modes failed: 6 lie"):
        certify(np.delete(values[:7], missing), 5, count, "leg")


class Blind:
    """A factor that loses one mode from every solution, as a faulty solver would."""

    def __init__(self, factor, mass, lost):
        self.factor, self.mass, self.lost = factor, mass, lost

    def solve(self, right_hand_sides):
        x = self.factor.solve(right_hand_sides)
        return x - self.lost[:, None] * (self.lost @ (self.mass @ x))


def test_a_mode_that_no_solve_shows_is_an_error(bar):
    clamped, _, vectors = bar
    blind = Blind(clamped.factor, clamped.mass, vectors[:, 2])
    with pytest.raises(ComputationError, match="certificate of the modes failed"):
        lowest_modes(blind, clamped.mass, 6, clamped_count(clamped, "cholmod"), "leg")


def test_missed_mode_is_searched_for_once_more(bar):
    """The first count says that a mode is missing: the second search, twice as wide, is right."""
    clamped, values, _ = bar
    count, calls = clamped_count(clamped, "cholmod"), []

    def wrong_at_first(sigma):
        calls.append(sigma)
        found = count(sigma)
        return found._replace(negative=found.negative + 1) if len(calls) == 1 else found

    found = lowest_modes(clamped.factor, clamped.mass, 6, wrong_at_first, "leg")
    assert len(calls) == 2
    np.testing.assert_allclose(found.frequencies, hertz(values[:6]), rtol=SAME)


def test_zero_pivots_move_the_shift(bar):
    clamped, values, _ = bar
    count, calls = clamped_count(clamped, "cholmod"), []

    def zero_at_first(sigma):
        calls.append(sigma)
        return count(sigma)._replace(zero=1) if len(calls) == 1 else count(sigma)

    assert values[5] < certify(values[:7], 6, zero_at_first, "leg") == calls[1] < calls[0]


def test_more_modes_than_have_mass():
    clamped = leg(Rectangle(0.1, 0.1), slices=2)
    light = clamped.mass.toarray()
    light[4:], light[:, 4:] = 0.0, 0.0
    with pytest.raises(ComputationError, match="leg: 5 modes asked for, but fewer have mass"):
        lowest_modes(clamped.factor, light, 5, lambda _: None, "leg")


def test_wrong_input_is_refused(bar):
    with pytest.raises(InputError, match="modes = 0"):
        modes(bar[0], 0)
    with pytest.raises(InputError, match="start has shape"):
        modes(bar[0], 2, start=np.ones((3, 1)))


def test_every_mode_of_a_small_matrix():
    K = np.diag(np.arange(1.0, 13.0))
    factor = factorise(analyse(csr_array(K)), csr_array(K))
    found = lowest_modes(
        factor,
        csr_array(eye_array(12)),
        12,
        lambda sigma: count_below(csr_array(K), csr_array(eye_array(12)), sigma),
        "matrix",
    )
    np.testing.assert_allclose(found.frequencies, hertz(np.arange(1.0, 13.0)), rtol=1e-13)
