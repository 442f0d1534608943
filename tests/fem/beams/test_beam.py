"""Beam finite elements of a prismatic leg against closed forms and published frequencies."""

import numpy as np
import pytest
from compliances import scaled_difference
from numpy.testing import assert_allclose
from prismatic_legs import LEG_1, LEG_2, STEEL, kind_frequencies

from fem.beams.beam import beam_leg, warping_beam_leg
from fem.beams.beam_theory import (
    bending_frequencies,
    tension_frequencies,
    torsion_frequencies,
)
from fem.sections.nonuniform_torsion import cantilever_frequencies, held_torsion_compliance
from fem.sections.section_constants import SectionConstants, beam_properties, section_constants
from lumped.arrays import dense
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material, tip_compliance
from lumped.models.bodies import clamped_modes, tip_compliance_of
from lumped.sections import Circle, ISection, Rectangle
from meshes.section.section_mesh import section_mesh

THEORIES = ("euler-bernoulli", "timoshenko")
PARTS = ("tension", "torsion", "bending y", "bending z")


@pytest.mark.parametrize("theory", THEORIES)
@pytest.mark.parametrize("slenderness", [1.0, 1e4])
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


def test_no_elements_and_stations_beyond_the_tip_are_refused():
    with pytest.raises(InputError, match="elements = 0"):
        beam_leg(LEG_1.timoshenko, 0.85, 0)
    with pytest.raises(InputError, match="station"):
        beam_leg(LEG_1.timoshenko, 0.85, 3).centreline(np.array([0.1, 0.86]))


LENGTH = 0.9


@pytest.fixture(scope="module")
def flanged() -> SectionConstants:
    section = ISection(width=0.1, height=0.1, flange=0.008, web=0.006)
    return section_constants(section_mesh(section, 4), STEEL.nu)


def test_free_ends_leave_statics_to_saint_venant_and_have_the_frequencies_of_the_rod(flanged):
    leg = warping_beam_leg(flanged, STEEL, LENGTH, 20, "free")
    expected = tip_compliance(beam_properties(flanged, STEEL), LENGTH)
    assert tip_compliance_of(leg) == pytest.approx(expected, rel=1e-8, abs=1e-16)
    modes = clamped_modes(leg, 12)
    twist = leg.centreline(np.array([LENGTH]))[3].toarray().ravel()
    twists = np.abs(twist @ modes.shapes)
    torsional = modes.frequencies[twists > 0.1 * twists.max()]
    frequencies = cantilever_frequencies(flanged, STEEL, LENGTH, 2)
    assert torsional[:2] == pytest.approx(frequencies, rel=1e-4)


def test_held_ends_have_the_closed_forms_torsion_and_nothing_else(flanged):
    expected = tip_compliance(beam_properties(flanged, STEEL), LENGTH)
    expected[3, 3] = held_torsion_compliance(flanged, STEEL, LENGTH)
    coarse, fine = (
        tip_compliance_of(warping_beam_leg(flanged, STEEL, LENGTH, n, "rigid")) for n in (20, 40)
    )
    # Layers of 1/k at the ends, four elements long: what the fourth order leaves.
    assert coarse == pytest.approx(expected, rel=1e-4, abs=1e-16)
    assert abs(fine[3, 3] - expected[3, 3]) < abs(coarse[3, 3] - expected[3, 3]) / 12.0
    # Round sections have nothing that warps.
    constants = section_constants(section_mesh(Circle(diameter=0.1), 8), STEEL.nu)
    found = warping_beam_leg(constants, STEEL, LENGTH, 4, "rigid")
    assert found.size == beam_leg(beam_properties(constants, STEEL), LENGTH, 4).size
