"""Legs as solids against beam theory and known values; natural modes against dense solutions."""

from functools import partial

import numpy as np
import pytest
from scipy.linalg import eigh, null_space
from scipy.sparse import csr_array, eye_array
from support.oracles.compliance_difference import scaled_difference
from support.robots.paper_legs import CUBIC, LEG_1, LEG_2, STEEL, meshed

from fem.bodies.doubling import condensed_leg, tip_compliance
from fem.bodies.solid import clamped_leg, section_twists, solid_leg, solid_mesh
from fem.sections.section_constants import beam_properties, section_constants
from fem.solvers.block_lanczos import Ritz, merged
from fem.solvers.certificate import count_below, pencil
from fem.solvers.factor import Inertia, analyse
from fem.solvers.modes import MissedModesError, certify, lowest_modes
from lumped.beam_properties import tip_compliance as beam_tip_compliance
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, Material
from lumped.sections import Circle, ISection, Rectangle, Tube
from meshes.prism import tetrahedra
from meshes.section.section_mesh import section_mesh

# Relative difference of two solutions of the same problem: rounding times the condition number 1e5.
SAME = 1e-10


def leg(section, length=0.6, slices=6, ends="rigid"):
    return clamped_leg(meshed(ConstantLeg(length, section, STEEL), 1, slices), ends)


def of_tetrahedra():
    square = ConstantLeg(0.3, Rectangle(0.1, 0.1), STEEL)
    return clamped_leg(solid_leg(square, tetrahedra(square.section, square.length, 1)))


def dense_solution(clamped):
    """Return eigenvalues ω² and mass-normalised vectors of the clamped leg by LAPACK.

    Solved as M φ = θ K φ, because LAPACK's errors are relative to the largest eigenvalue, here that
    of the lowest mode.
    """
    allowed = null_space(clamped.root.T)
    K, M = clamped.solid.stiffness, clamped.solid.mass
    theta, vectors = eigh(allowed.T @ (M @ allowed), allowed.T @ (K @ allowed))
    vectors = allowed @ vectors
    return 1.0 / theta[::-1], vectors[:, ::-1] / np.sqrt(theta[::-1])


def hertz(values):
    return np.sqrt(values) / (2.0 * np.pi)


@pytest.fixture(scope="module", params=["rigid", "free"])
def bar(request):
    clamped = leg(Rectangle(0.08, 0.12), slices=4, ends=request.param)
    return clamped, *dense_solution(clamped)


@pytest.mark.parametrize(
    "clamped",
    [
        # Nearly square and round legs have pairs of bending modes less than 0.01 % apart.
        lambda: leg(Rectangle(0.1, 0.1 * (1.0 + 1e-6)), slices=3),
        lambda: leg(Rectangle(0.1, 0.1 * (1.0 + 1e-4)), slices=3, ends="free"),
        lambda: leg(Circle(0.1), slices=3, ends="free"),
        of_tetrahedra,
    ],
    ids=["nearly square", "nearly square, free", "circle", "tetrahedra"],
)
def test_leg_modes_equal_dense_solution(clamped):
    """Reference: eigenvalues of the dense matrices; square bars have close or equal pairs."""
    clamped = clamped()
    values, _ = dense_solution(clamped)
    for number in (1, 5, 12, 8):
        result = clamped.modes(number)
        np.testing.assert_allclose(result.frequencies, hertz(values[:number]), rtol=SAME)
        assert result.count == (values < result.shift).sum() >= number
    transformation = clamped.solid.transformation
    amplitudes = np.linalg.lstsq(transformation.toarray(), result.shapes, rcond=None)[0]
    gram = amplitudes.T @ (clamped.solid.mass @ amplitudes)
    np.testing.assert_allclose(gram, np.eye(8), atol=1e-12)


def test_frequency_error_estimates_are_bounds(bar):
    """True errors, from dense eigenvalues, are at most the estimates of the solver."""
    clamped, values, _ = bar
    result = clamped.modes(20)
    true = np.abs(result.frequencies / hertz(values[:20]) - 1.0)
    # SAME allows for the rounding errors of LAPACK and of the factor.
    assert np.all(true <= result.frequency_errors + SAME)
    assert result.frequency_errors.max() <= 5e-7
    # Counting released the factor of K, so that only one was in memory.
    assert "numeric" not in vars(clamped.factor)


def test_double_mode_at_cut_off_is_complete():
    """If one mode of a square bar is requested, both modes of its pair are counted."""
    clamped = leg(Rectangle(0.1, 0.1), slices=4)
    values, _ = dense_solution(clamped)
    assert values[1] / values[0] - 1.0 < 1e-9
    result = clamped.modes(1)
    assert (result.count, len(result.frequencies)) == (2, 1)
    assert values[1] < result.shift < values[2]
    result, repeated = (clamped.modes(6) for _ in range(2))
    np.testing.assert_allclose(result.frequencies, hertz(values[:6]), rtol=SAME)
    np.testing.assert_array_equal(result.shapes, repeated.shapes)


def test_leg_mode_count_equals_dense_count(bar):
    """Eigenvalues below a shift, counted by the inertia of K − σM and by a dense solution."""
    clamped, values, _ = bar
    for below in (0, 2, 12, 100):
        lower = values[below - 1] if below else 0.0
        gap = values[below] - lower
        # Also close to each eigenvalue, at a tenth of the usual distance of a counting shift.
        near = min(0.001 * values[below], 0.4 * gap)
        for sigma in (lower + 0.5 * gap, lower + near, values[below] - near):
            assert clamped.rooted_inertia(sigma) == (below, 0, len(values) - below)
    # At an eigenvalue one pivot is zero, or the count may differ by one.
    result = clamped.rooted_inertia(values[5])
    assert result.negative in {5, 6}
    assert result.zero <= 1


def test_mode_count_needs_one_factor_at_a_time(bar, monkeypatch):
    """The factor of K is released for the count and computed again for the next solution."""
    clamped, values, _ = bar
    loads = clamped.equilibrated(clamped.loads)
    before, first = clamped.factor.solve(loads), clamped.factor.numeric
    enough = 4 * clamped.factor.symbolic.peak_bytes
    monkeypatch.setattr("fem.solvers.factor.available_memory", lambda: enough)
    assert clamped.rooted_inertia(0.5 * (values[5] + values[6])).negative == 6
    assert clamped.factor.numeric is first
    monkeypatch.setattr("fem.solvers.factor.available_memory", lambda: enough - 1)
    for below in (6, 9):
        assert clamped.rooted_inertia(0.5 * (values[below - 1] + values[below])).negative == below
    assert clamped.factor.numeric is not first
    np.testing.assert_array_equal(clamped.factor.solve(loads), before)


def test_merged_modes_keep_residuals():
    """Modes of two searches are sorted together with their residuals."""
    first, second = (
        Ritz(np.array(values), np.ones((2, len(values))), np.array(residuals), np.inf)
        for values, residuals in (([1.0, 3.0], [1e-9, 2e-9]), ([2.0], [5e-9]))
    )
    merged_modes = merged(first, second)
    assert merged_modes.values.tolist() == [1.0, 2.0, 3.0]
    assert merged_modes.residuals.tolist() == [1e-9, 5e-9, 2e-9]


def test_missing_mode_is_detected(bar):
    """Five of six modes, or six of which two are equal, contradict the count by inertia."""
    clamped, values, _ = bar
    count, message = clamped.rooted_inertia, "leg: wrong number of modes: 6 lie"
    assert values[5] < certify(values[:6], values[6], count, "leg") < values[6]
    with pytest.raises(MissedModesError, match=message) as error:
        certify(np.delete(values[:6], 4), values[6], count, "leg")
    assert error.value.missing == 1
    with pytest.raises(ComputationError, match=message):
        certify(np.sort(np.append(values[:6], values[4])), values[6], count, "leg")


def test_shift_on_eigenvalue_is_moved(bar):
    """A shift with zero pivots is moved three times. If all shifts have them, modes are refused."""
    clamped, values, _ = bar
    counts = iter([1, 1, 1, 0])

    def zero_three_times(sigma):
        return clamped.rooted_inertia(sigma)._replace(zero=next(counts))

    # ω² of the second mode is below three times that of the first: the shift is midway between.
    shift = certify(values[:1], values[1], zero_three_times, "leg")
    assert shift == pytest.approx(0.5 * (values[0] + values[1]), rel=1e-12)
    with pytest.raises(ComputationError, match="leg: the modes cannot be counted: zero pivots"):
        certify(values[:1], values[1], lambda _: Inertia(1, 1, 0), "leg")


def blinded_modes(clamped, lost, *, sees_again):
    """Return six modes from solutions without the mode `lost`.

    If `sees_again`, solutions are complete from the first count of modes on.
    """
    mass, counts = clamped.solid.mass, []

    def solve(right_hand_sides):
        x = clamped.flexibility(right_hand_sides)
        return x if sees_again and counts else x - lost[:, None] * (lost @ (mass @ x))

    def count(sigma):
        counts.append(sigma)
        return clamped.rooted_inertia(sigma)

    return lowest_modes(solve, mass, 6, count, "leg")


def test_missed_mode_is_reported(bar):
    """A search that misses one mode is refused.

    If a second search finds the mode, it is included.
    """
    clamped, values, vectors = bar
    with pytest.raises(ComputationError, match="wrong number of modes"):
        blinded_modes(clamped, vectors[:, 5], sees_again=False)
    result = blinded_modes(clamped, vectors[:, 0], sees_again=True)
    np.testing.assert_allclose(result.frequencies, hertz(values[:6]), rtol=SAME)
    gram = result.shapes.T @ (clamped.solid.mass @ result.shapes)
    np.testing.assert_allclose(gram, np.eye(6), atol=1e-12)
    # The second search excludes the modes that the first one result.
    assert result.count == 7


def test_slender_leg_has_both_bending_modes():
    """Length of 87 diameters: K's largest eigenvalue is 1e11 times that of the lowest mode."""
    result = leg(Circle(0.0873), length=7.6, slices=40).modes(2)
    assert result.count == 2
    # Euler–Bernoulli cantilever, 1.8751²/2π √(EI/ρA)/L²; shear and rotary inertia lower it by 1e-4,
    # slices of two diameters and the rigid face change it by less than the tolerance.
    exact = 1.8751041**2 / (2.0 * np.pi) * np.sqrt(2.1e11 / 7850.0) * (0.0873 / 4.0) / 7.6**2
    np.testing.assert_allclose(result.frequencies, exact, rtol=3e-3)


def test_more_modes_than_unknowns_are_refused(bar):
    """A 12×12 matrix has 12 modes; with four masses it has four, so that five are refused."""
    K, M = csr_array(np.diag(np.arange(1.0, 13.0))), csr_array(eye_array(12))
    solve = analyse(K).factorise().solve
    result = lowest_modes(solve, M, 12, partial(count_below, pencil(K, M)), "matrix")
    # Rounding error of the iteration, up to 3.4e-13 with six kernels of OpenBLAS.
    np.testing.assert_allclose(result.frequencies, hertz(np.arange(1.0, 13.0)), rtol=1e-11)
    light = csr_array(np.diag((np.arange(12) < 4).astype(float)))
    with pytest.raises(ComputationError, match="leg: 5 modes requested, but fewer modes move mass"):
        lowest_modes(solve, light, 5, lambda _: None, "leg")
    with pytest.raises(InputError, match="modes = 0"):
        bar[0].modes(0)


def beam_with_mesh_constants(section, length):
    constants = section_constants(section, CUBIC.nu, CUBIC.G / CUBIC.E)
    return beam_tip_compliance(beam_properties(constants, CUBIC), length)


@pytest.mark.parametrize(
    ("length", "section", "divisions", "slices"),
    [
        # Numbers of slices whose binary digits mix doubling and joining: 1011, 1101 and 10011.
        (0.2, Rectangle(0.10, 0.16), 2, 11),
        (0.8, Tube(0.12, 0.012), 4, 13),
        (0.8, ISection(0.10, 0.16, 0.012, 0.008), 2, 19),
    ],
)
def test_condensed_leg_equals_beam(length, section, divisions, slices):
    """With free warping at both ends the solid is the Timoshenko beam of its section."""
    leg = ConstantLeg(length, section, CUBIC)
    solid, face = meshed(leg, divisions, slices), section_mesh(section, divisions)
    condensed = condensed_leg(leg, face, slices)
    for ends in ("rigid", "free"):
        direct = clamped_leg(solid, ends).compliance
        # The direct solution loses digits to ill-conditioned elements, worst for slices much longer
        # than the wall is thick: 2.2e-10 with five kernels of OpenBLAS.
        assert scaled_difference(tip_compliance(condensed, ends), direct) < 5e-9
    # Quadratic slices approximate the cubic deflection.
    assert scaled_difference(direct, beam_with_mesh_constants(face, length)) < 1e-4


def test_free_warping_solid_converges_to_beam():
    """Quadratic slices approximate the cubic deflection: the error falls as n⁻⁴."""
    leg = ConstantLeg(8.0, Rectangle(0.16, 0.08), CUBIC)
    section = section_mesh(leg.section, (2, 1))
    beam = beam_with_mesh_constants(section, leg.length)
    coarse, fine = (
        scaled_difference(tip_compliance(condensed_leg(leg, section, n), "free"), beam)
        for n in (256, 1024)
    )
    # The error is (L/h)² n⁻⁴ times a constant.
    assert coarse < 1e-7
    assert fine < 1e-9
    assert np.log(coarse / fine) / np.log(4.0) == pytest.approx(4.0, abs=0.2)


def test_rigid_ends_stiffen_torsion_of_leg_2():
    """Known values: 18 % in torsion; 0.26 % along z, where shear is a sixth of the deflection."""
    compliance = clamped_leg(meshed(LEG_2, (3, 9), 12)).compliance
    beam = beam_tip_compliance(LEG_2.timoshenko, LEG_2.length)
    share = 1.0 - np.diag(compliance) / np.diag(beam)
    assert share[3] == pytest.approx(0.18, abs=0.005)
    assert np.abs(share[[0, 1, 4, 5]]).max() < 2e-4
    assert 0.0 < share[2] < 3e-3


def test_leg_1_has_known_modes_and_centreline():
    """Known value for leg 1 of the paper: 181.8 Hz in bending.

    Under a force Fy its sections move as in Timoshenko's cantilever.
    """
    solid = meshed(LEG_1, 2, 24)
    clamped = clamped_leg(solid)
    result = clamped.modes(4).frequencies
    # One unit in the last known digit.
    assert result[1] == pytest.approx(181.8, abs=0.1)
    # Axial vibration for ν = 0: √(EA/μ)/4L; the slices have an error of (kl)⁴.
    beam, L = LEG_1.timoshenko, LEG_1.length
    assert result[3] == pytest.approx(np.sqrt(beam.EA / beam.mu) / (4.0 * L), rel=1e-5)
    u = clamped.solid.transformation @ clamped.response[:, 1]
    x = np.array([0.3, 0.5, 0.85])
    twists = (section_twists(solid.mesh, x) @ u).reshape(-1, 6)
    # Restrained warping at the ends and averaging over quadratic slices change it by some 1e-4.
    deflection = x**2 * (3.0 * L - x) / (6.0 * beam.EIz) + x / beam.GAy
    np.testing.assert_allclose(twists[:, 1], deflection, rtol=1e-3)
    rotation = x * (2.0 * L - x) / (2.0 * beam.EIz)
    np.testing.assert_allclose(twists[:, 5], rotation, rtol=1e-3)


def test_default_elements_have_equal_sides():
    """0.8 m with two divisions of 0.1 m give 16 slices.

    Shorter legs and other stations are refused.
    """
    mesh = solid_mesh(ConstantLeg(0.8, Rectangle(0.10, 0.16), STEEL), 2)
    assert (mesh.slices, mesh.element) == (16, "hex27")
    with pytest.raises(InputError, match="shorter than"):
        solid_mesh(ConstantLeg(0.1, Rectangle(0.10, 0.16), STEEL), 2)
    with pytest.raises(InputError, match=r"between 0 m and 0.8 m"):
        section_twists(mesh, np.array([0.9]))
    with pytest.raises(InputError, match="extruded"):
        section_twists(tetrahedra(LEG_1.section, LEG_1.length, 1), np.array([0.1]))


@pytest.mark.parametrize("nu", [-0.9999999, 0.4999999])
def test_moduli_beyond_round_off_are_refused(nu):
    """For ν near 0.5 or −1, resistance to changes of volume or shape is lost in round-off."""
    leg = ConstantLeg(0.8, Rectangle(0.1, 0.14), Material.isotropic(2.1e11, nu, 7850.0))
    message = r"material with ν = .*: changes of .* and .* differ"
    with pytest.raises(ComputationError, match=message):
        solid_leg(leg, solid_mesh(leg, 2))
