"""Beam finite elements of a prismatic leg against closed forms and published frequencies."""

from dataclasses import replace

import numpy as np
import pytest
from compliances import scaled_difference
from numpy.testing import assert_allclose
from prismatic_legs import LEG_1, LEG_2

from fem.beams.beam import beam_leg
from fem.beams.beam_theory import (
    bending_frequencies,
    tension_frequencies,
    torsion_frequencies,
)
from lumped.dense.modes import dense
from lumped.errors import InputError
from lumped.legs import BeamProperties, ConstantLeg, Material, tip_compliance
from lumped.mechanism.body_model import LegMatrices
from lumped.models.cantilever import kind_frequencies, tip_compliance_of
from lumped.screws import shift
from lumped.sections import Rectangle

THEORIES = ("euler-bernoulli", "timoshenko")
PARTS = ("tension", "torsion", "bending y", "bending z")


def rigid_motions(leg: LegMatrices):
    """n×6: the leg moved rigidly by each unit twist of its root, its inside following freely."""
    stiffness = dense(leg.stiffness)
    ends = np.vstack([np.eye(6), shift(np.array([leg.length, 0.0, 0.0]))])
    inside = -np.linalg.solve(stiffness[12:, 12:], stiffness[12:, :12] @ ends)
    return np.vstack([ends, inside])


# ── statics ──────────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize("slenderness", [1.0, 10.0, 1e2, 1e3, 1e4])
def test_tip_compliance_is_exact_for_any_slenderness_and_number_of_elements(slenderness, theory):
    steel = Material.isotropic(2.1e11, 0.3, 7850.0)
    stub = ConstantLeg(slenderness * 0.1, Rectangle(0.06, 0.1), steel)
    for leg in (stub, LEG_2):
        properties = leg.properties(theory)
        expected = tip_compliance(properties, leg.length)
        for elements in (1, 2, 7):
            compliance = tip_compliance_of(beam_leg(properties, leg.length, elements))
            # Rounding alone, which the condition of n elements raises as n⁴: 2400 eps for n = 7.
            assert scaled_difference(compliance, expected) < 1e-12


def przemieniecki_stiffness(p: BeamProperties, l: float):
    """12×12 of Przemieniecki, Theory of Matrix Structural Analysis (1968), §5.6."""
    phi_y, phi_z = 12.0 * p.EIz / (p.GAy * l**2), 12.0 * p.EIy / (p.GAz * l**2)
    k = np.zeros((12, 12))
    for i, j, value in (
        (0, 0, p.EA / l),
        (0, 6, -p.EA / l),
        (6, 6, p.EA / l),
        (3, 3, p.GJ / l),
        (3, 9, -p.GJ / l),
        (9, 9, p.GJ / l),
    ):
        k[i, j] = k[j, i] = value
    for w, theta, sign, EI, phi in ((1, 5, 1.0, p.EIz, phi_y), (2, 4, -1.0, p.EIy, phi_z)):
        block = np.array(
            [
                [12.0, 6.0 * l, -12.0, 6.0 * l],
                [6.0 * l, (4.0 + phi) * l**2, -6.0 * l, (2.0 - phi) * l**2],
                [-12.0, -6.0 * l, 12.0, -6.0 * l],
                [6.0 * l, (2.0 - phi) * l**2, -6.0 * l, (4.0 + phi) * l**2],
            ]
        )
        signs = np.array([1.0, sign, 1.0, sign])
        places = [w, theta, w + 6, theta + 6]
        k[np.ix_(places, places)] = block * np.outer(signs, signs) * EI / ((1.0 + phi) * l**3)
    return k


@pytest.mark.parametrize("theory", THEORIES)
def test_one_element_is_przemieniecki_s_matrix(theory):
    properties = LEG_2.properties(theory)
    k = dense(beam_leg(properties, LEG_2.length, 1).stiffness)
    ends = k[:12, :12] - k[:12, 12:] @ np.linalg.solve(k[12:, 12:], k[12:, :12])
    reference = przemieniecki_stiffness(properties, LEG_2.length)
    # Rounding alone: sums of four Gauss points.
    assert scaled_difference(ends, reference) < 1e-13


@pytest.mark.parametrize("elements", [1, 3])
@pytest.mark.parametrize("theory", THEORIES)
def test_rigid_motion_has_the_mass_and_inertia_of_the_leg(theory, elements):
    p, L = LEG_1.properties(theory), LEG_1.length
    leg = beam_leg(p, L, elements)
    motions = rigid_motions(leg)
    m = p.mu * L
    turning = m * L**2 / 12.0
    about_centre = np.diag([m, m, m, p.rho_J * L, p.rho_Iy * L + turning, p.rho_Iz * L + turning])
    to_centre = shift(np.array([L / 2.0, 0.0, 0.0]))
    expected = to_centre.T @ about_centre @ to_centre
    assert m == pytest.approx(69.705, rel=1e-12)
    # Rounding alone: the rigid motions lie in the space of the element.
    assert_allclose(motions.T @ dense(leg.mass) @ motions, expected, atol=1e-12 * m)


def test_one_slender_element_has_the_consistent_mass_of_its_cubic_in_both_planes():
    """m/420 (156, 22 L, 54, −13 L, 4 L², −3 L²): Archer, J. Struct. Div. ASCE 89 (1963) 161."""
    L = LEG_1.length
    mass = dense(beam_leg(LEG_1.properties("euler-bernoulli"), L, 1).mass) / LEG_1.mass
    published = np.array(
        [[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]
    )
    # Deflection and rotation at root and tip; a leg that goes up along z turns against y.
    for places, turned in (((1, 5, 7, 11), 1.0), ((2, 4, 8, 10), -1.0)):
        unit = np.array([1.0, turned / L] * 2)
        found = mass[np.ix_(places, places)] * np.outer(unit, unit)
        # Products of cubics, integrated exactly: rounding.
        assert_allclose(found, published / 420.0, atol=1e-12)


def test_parts_sum_to_the_stiffness_and_carry_their_own_load_only():
    p, L = LEG_1.timoshenko, LEG_1.length
    leg = beam_leg(p, L, 4)
    assert set(leg.parts) == set(PARTS)
    total = sum(dense(part) for part in leg.parts.values())
    assert_allclose(total, dense(leg.stiffness), rtol=0, atol=0)
    loads = {0: "tension", 1: "bending z", 2: "bending y", 3: "torsion"}
    compliance = tip_compliance(p, L)
    for direction, own in loads.items():
        force = np.zeros(leg.size - 6)
        force[direction] = 1.0
        u = np.r_[np.zeros(6), np.linalg.solve(dense(leg.stiffness)[6:, 6:], force)]
        for name, part in leg.parts.items():
            energy = compliance[direction, direction] if name == own else 0.0
            # Clapeyron: uᵀKu = F² c; rounding alone.
            assert u @ (part @ u) == pytest.approx(energy, rel=1e-11, abs=1e-30)


# ── the centre line ──────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("theory", THEORIES)
def test_centreline_of_a_rigid_motion_is_rigid_everywhere(theory):
    leg = beam_leg(LEG_1.properties(theory), LEG_1.length, 3)
    stations = np.array([0.0, 0.1, LEG_1.length / 3.0, 0.5, LEG_1.length])
    twists = (leg.centreline(stations) @ rigid_motions(leg)).reshape(5, 6, 6)
    for station, twist in zip(stations, twists, strict=True):
        assert_allclose(twist, shift(np.array([station, 0.0, 0.0])), atol=1e-13)


@pytest.mark.parametrize("theory", THEORIES)
def test_centreline_under_tip_loads_follows_the_deflection_curves(theory):
    p, L = LEG_2.properties(theory), LEG_2.length
    leg = beam_leg(p, L, 3)
    x = np.linspace(0.0, L, 14)
    loads = np.zeros((leg.size - 6, 6))
    loads[:6] = np.eye(6)
    u = np.vstack([np.zeros((6, 6)), np.linalg.solve(dense(leg.stiffness)[6:, 6:], loads)])
    curves = (leg.centreline(x) @ u).reshape(len(x), 6, 6)
    # Elementary beam theory, unit loads at the tip; the section leans by the bending part only.
    expected = np.zeros((len(x), 6, 6))
    expected[:, 0, 0] = x / p.EA
    expected[:, 1, 1] = x**2 * (3.0 * L - x) / (6.0 * p.EIz) + x / p.GAy
    expected[:, 5, 1] = x * (2.0 * L - x) / (2.0 * p.EIz)
    expected[:, 2, 2] = x**2 * (3.0 * L - x) / (6.0 * p.EIy) + x / p.GAz
    expected[:, 4, 2] = -x * (2.0 * L - x) / (2.0 * p.EIy)
    expected[:, 3, 3] = x / p.GJ
    expected[:, 2, 4] = -(x**2) / (2.0 * p.EIy)
    expected[:, 4, 4] = x / p.EIy
    expected[:, 1, 5] = x**2 / (2.0 * p.EIz)
    expected[:, 5, 5] = x / p.EIz
    # Rounding alone: the static solution is in the space everywhere, not at the nodes only.
    assert_allclose(curves, expected, rtol=1e-11, atol=1e-12 * expected.max(axis=0).max())


# ── frequencies ──────────────────────────────────────────────────────────────────────────────────


# The second frequency with 16 elements. Leading error (kl)⁴/1440, with kl = 3π/32 in tension and
# torsion and 4.694/16 in bending: 5.2e-6 and 5.1e-6. Shear lowers it.
CAP = 6e-6


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("theory", THEORIES)
def test_frequencies_converge_with_order_four(theory, part):
    p, L = LEG_2.properties(theory), LEG_2.length
    exact = {
        "tension": lambda: tension_frequencies(p, L, 2),
        "torsion": lambda: torsion_frequencies(p, L, 2),
        "bending y": lambda: bending_frequencies(p, L, "y", 2),
        "bending z": lambda: bending_frequencies(p, L, "z", 2),
    }[part]()[1]
    counts = np.array([6, 8, 12, 16])
    errors = np.array(
        [kind_frequencies(beam_leg(p, L, int(n)), part, 2)[1] / exact - 1.0 for n in counts]
    )
    order = -np.polyfit(np.log(counts), np.log(errors), 1)[0]
    # The fit still sees the next term of the error, (kl)² of the leading one.
    assert order == pytest.approx(4.0, abs=0.1)
    # Rayleigh–Ritz: from above, always.
    assert np.all(errors > 0.0)
    assert errors[-1] < CAP


def test_leg_1_about_z_is_about_180_hz():
    # Paper §3.3, "about 180 Hz"; Euler–Bernoulli by hand: 1.875104² √(EI/μ)/2πL².
    p, L = LEG_1.timoshenko, LEG_1.length
    by_hand = 1.875104069**2 * np.sqrt(p.EIy / p.mu) / (2.0 * np.pi * L**2)
    slender = kind_frequencies(beam_leg(p.as_euler_bernoulli(), L, 20), "bending y", 1)[0]
    rayleigh = replace(p, GAy=np.inf, GAz=np.inf)
    rotary = kind_frequencies(beam_leg(rayleigh, L, 20), "bending y", 1)[0]
    full = kind_frequencies(beam_leg(p, L, 20), "bending y", 1)[0]
    # 20 elements: below 1e-7; 1e-6 leaves room for rounding.
    assert slender == pytest.approx(by_hand, rel=1e-6)
    # Figures of an independent computation, given to 0.1 Hz.
    assert [slender, rotary, full] == pytest.approx([186.8, 183.6, 181.8], abs=0.05)


# ── wrong input ──────────────────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize("length", [0.0, -0.85, np.nan])
def test_length_must_be_positive(length):
    with pytest.raises(InputError, match="length"):
        beam_leg(LEG_1.timoshenko, length, 3)


def test_at_least_one_element():
    with pytest.raises(InputError, match="elements = 0"):
        beam_leg(LEG_1.timoshenko, 0.85, 0)


@pytest.mark.parametrize("station", [-0.01, 0.86, np.nan])
def test_stations_lie_on_the_leg(station):
    leg = beam_leg(LEG_1.timoshenko, 0.85, 3)
    with pytest.raises(InputError, match="station"):
        leg.centreline(np.array([0.1, station]))
