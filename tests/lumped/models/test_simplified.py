"""The simplified model against statics by hand, the paper's statements and both stroke ends."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from lumped.errors import ComputationError
from lumped.models import simplified

MICROMETRE = 1e-6
FX, FY = np.array([1000.0, 0.0]), np.array([0.0, 1000.0])


def planar(robot, x, force):
    return np.linalg.norm(simplified.compliance(robot, x) @ force, axis=-1) / MICROMETRE


@pytest.mark.parametrize("x", [0.145, 0.3, 0.4975, 0.7, 0.85])
def test_compliance_is_the_drives_energy_under_the_leg_forces(demonstrator, x):
    """Castigliano: 2U = Σ τᵢ²/Kᵢ with the bar forces from equilibrium of B, no Jacobian used."""
    posture = demonstrator.posture(x)
    bars = np.column_stack([posture.rotation1[:2, 0], posture.rotation2[:2, 0]])
    drive_forces = np.diag(bars[1]) @ np.linalg.inv(bars)
    expected = drive_forces.T @ drive_forces / 1.0e9
    # two 2×2 solves in double precision, condition below 10
    assert_allclose(simplified.compliance(demonstrator, x), expected, rtol=1e-12, atol=1e-23)


def test_deflection_under_fx_stays_below_the_papers_bound(demonstrator):
    """Known values (1.063 µm near x = 0.497); paper §2.1: inferior to 1.1 µm."""
    x = demonstrator.stations(2001)
    deflections = planar(demonstrator, x, FX)
    assert deflections.max() == pytest.approx(1.063, abs=0.0005)  # digits printed
    # The maximum is flat: 0.01 m beside it the deflection has changed by its fourth digit.
    assert x[deflections.argmax()] == pytest.approx(0.497, abs=0.01)


def test_no_deflection_under_fx_at_both_ends(demonstrator):
    """Paper §2.1: equal to zero; s² of the horizontal leg is rounding, 1e-16 relative."""
    deflections = planar(demonstrator, np.array(demonstrator.stroke), FX)
    assert_allclose(deflections, 0.0, atol=1e-7)


def test_deflection_under_fy_is_largest_at_the_ends(demonstrator):
    """Known values: 0.503 µm at the centre, 1.0 µm at the ends, F/K for a single drive."""
    assert planar(demonstrator, demonstrator.centre, FY) == pytest.approx(0.503, abs=0.0005)
    assert_allclose(planar(demonstrator, np.array(demonstrator.stroke), FY), 1.0, rtol=1e-7)
    assert planar(demonstrator, demonstrator.stations(501), FY).argmax() in (0, 500)


def test_first_frequency_over_the_stroke(demonstrator):
    """Known values: 713.4 to 756.2 Hz; paper §3.1: superior to 710 Hz."""
    first = simplified.frequencies(demonstrator, demonstrator.stations(2001))[:, 0]
    assert first.min() == pytest.approx(713.4, abs=0.05)
    assert first.max() == pytest.approx(756.2, abs=0.05)


def test_ends_of_the_stroke_have_one_finite_and_one_infinite_frequency(demonstrator):
    """A single drive carries y: f1 = √(K/m)/2π; along x the robot is rigid."""
    for x in demonstrator.stroke:
        first, second = simplified.frequencies(demonstrator, x)
        assert first == pytest.approx(np.sqrt(1.0e9 / 46.0) / (2.0 * np.pi), rel=1e-7)
        assert second == np.inf
    first_x, last_x = demonstrator.stroke
    inside = simplified.frequencies(demonstrator, [first_x + 1e-9, last_x - 1e-9])
    assert np.isfinite(inside).all()


def test_frequencies_solve_the_eigenproblem_of_the_work_balance(demonstrator):
    """Eq. (12) with J⁻ᵀKJ⁻¹; the printed J⁻¹KJ⁻ᵀ agrees for K ∝ I and differs otherwise."""
    J = simplified.jacobian(demonstrator, 0.35)
    inverse, M = np.linalg.inv(J), 46.0 * np.eye(2)

    def hertz(stiffness):
        return np.sort(np.sqrt(np.linalg.eigvals(stiffness / 46.0)) / (2.0 * np.pi))

    equal, unequal = np.diag([1.0e9, 1.0e9]), np.diag([1.0e9, 3.0e9])
    for K in (equal, unequal):
        found = simplified.natural_frequencies(J, K, M)
        assert_allclose(found, hertz(inverse.T @ K @ inverse), rtol=1e-12)
    found = simplified.natural_frequencies(J, equal, M)
    assert_allclose(hertz(inverse @ equal @ inverse.T), found, rtol=1e-12)
    found = simplified.natural_frequencies(J, unequal, M)
    assert abs(hertz(inverse @ unequal @ inverse.T)[0] / found[0] - 1.0) > 0.01


def test_one_station_and_many_agree(demonstrator):
    x = demonstrator.stations(7)
    many = simplified.compliance(demonstrator, x.reshape(7, 1))
    assert many.shape == (7, 1, 2, 2)
    for station, matrix in zip(x, many[:, 0], strict=True):
        assert_allclose(simplified.compliance(demonstrator, station), matrix, rtol=1e-14)


def test_aligned_legs_are_named(demonstrator):
    """A = (0, −√3), C = (½, −√3/2), B = (1, 0) lie on one line: 2:1 legs with a = ½."""
    robot = replace(
        demonstrator,
        a=0.5,
        leg1=replace(demonstrator.leg1, length=2.0),
        leg2=replace(demonstrator.leg2, length=1.0),
    )
    with pytest.raises(ComputationError, match=r"legs are aligned at x = 1 m .*type 2"):
        simplified.frequencies(robot, [0.9, 1.0])
