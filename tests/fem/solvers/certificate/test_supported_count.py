import numpy as np
import pytest
from prismatic_legs import STEEL, meshed
from scipy.linalg import eigvalsh, null_space

import fem.solvers.certificate.count
from fem.bodies.solid import clamped_leg
from fem.solvers.certificate.supported_count import supported_count
from fem.solvers.factor import upper_triangle
from lumped.legs import ConstantLeg
from lumped.sections import Rectangle


def held(section, ends):
    return clamped_leg(meshed(ConstantLeg(0.6, section, STEEL), 2, 6), ends)


@pytest.fixture(scope="module", params=["rigid", "free"])
def leg(request):
    """A clamped leg, its factor's points and constraints, and its eigenvalues by LAPACK."""
    clamped = held(Rectangle(0.08, 0.12), request.param)
    K, M, B = clamped.solid.stiffness, clamped.solid.mass, clamped.root
    allowed = null_space(B.T)
    theta = eigvalsh(allowed.T @ (M @ allowed), allowed.T @ (K @ allowed))
    K, M = upper_triangle(K), upper_triangle(M)
    return clamped, K, M, clamped.solid.places, B, 1.0 / theta[::-1]


@pytest.mark.parametrize("below", [0, 2, 12])
def test_count_is_that_of_dense_eigenvalues(leg, below):
    clamped, K, M, points, B, values = leg
    lower = values[below - 1] if below else 0.0
    # Near either of the two eigenvalues too: 1e-3 is a tenth of the certificate's usual distance.
    for sigma in (0.5 * (lower + values[below]), lower * 1.001, values[below] * 0.999):
        found = supported_count(clamped.factor, K, M, sigma, points, B)
        assert found == (below, 0, len(values) - below)


def test_shift_on_an_eigenvalue_has_no_sign_or_moves_the_count_by_one(leg):
    clamped, K, M, points, B, values = leg
    found = supported_count(clamped.factor, K, M, values[5], points, B)
    assert found.negative in {5, 6}
    assert found.zero <= 1


def test_too_few_supports_prove_nothing_and_fronts_count(leg, monkeypatch):
    clamped, K, M, points, B, values = leg
    below = 200
    sigma = 0.5 * (values[below] + values[below - 1])
    assert supported_count(clamped.factor, K, M, sigma, points, B) is None
    answers = []

    def spied(*arguments):
        answers.append(supported_count(*arguments))
        return answers[-1]

    monkeypatch.setattr(fem.solvers.certificate.count, "supported_count", spied)
    assert clamped.rooted_inertia(sigma).negative == below
    assert answers == [None]


def test_count_without_room_for_two_factors(leg, monkeypatch):
    """The factor of K gives its place to that of the count, and comes again for a solve."""
    clamped, values = leg[0], leg[-1]
    loads = clamped.equilibrated(clamped.loads)
    before, first = clamped.factor.solve(loads), clamped.factor.numeric
    count = clamped.rooted_inertia
    enough = 4 * clamped.factor.symbolic.peak_bytes
    monkeypatch.setattr("fem.solvers.renewable_factor.available_memory", lambda: enough)
    assert count(0.5 * (values[5] + values[6])).negative == 6
    assert clamped.factor.numeric is first
    monkeypatch.setattr("fem.solvers.renewable_factor.available_memory", lambda: enough - 1)
    for below in (6, 9):
        assert count(0.5 * (values[below - 1] + values[below])).negative == below
    assert clamped.factor.numeric is not first
    assert clamped.factor.numeric is clamped.factor.numeric
    np.testing.assert_array_equal(clamped.factor.solve(loads), before)
