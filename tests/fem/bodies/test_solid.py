"""One leg as a solid, direct and by doubling: beam theory, thin-wall theory, known values."""

import numpy as np
import pytest
from compliances import scaled_difference
from prismatic_legs import CUBIC, LEG_1, LEG_2, STEEL, meshed

from fem.bodies.doubling import condensed_leg, tip_compliance
from fem.bodies.solid import clamped_leg, section_twists, solid_leg, solid_mesh
from fem.sections.section_constants import beam_properties, section_constants
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, Material
from lumped.legs import tip_compliance as beam_tip_compliance
from lumped.sections import ISection, Rectangle, Tube
from meshes.prism import tetrahedra
from meshes.section.section_mesh import section_mesh


def beam_with_mesh_constants(section, length):
    constants = section_constants(section, CUBIC.nu, CUBIC.G / CUBIC.E)
    return beam_tip_compliance(beam_properties(constants, CUBIC), length)


@pytest.mark.parametrize(
    ("length", "section", "divisions", "slices"),
    [
        # Doubled, and slices joined: 11 is 1011 in binary, 13 is 1101, 19 is 10011.
        (0.2, Rectangle(0.10, 0.16), 2, 11),
        (0.8, Tube(0.12, 0.012), 4, 13),
        (0.8, ISection(0.10, 0.16, 0.012, 0.008), 2, 19),
    ],
)
def test_tip_compliance_is_that_of_the_direct_solve_and_with_free_ends_the_beam_s(
    length, section, divisions, slices
):
    """Clapeyron: with Saint-Venant ends the solid is Timoshenko's beam of its section."""
    leg = ConstantLeg(length, section, CUBIC)
    solid, face = meshed(leg, divisions, slices), section_mesh(section, divisions)
    condensed = condensed_leg(leg, face, slices)
    for ends in ("rigid", "free"):
        direct = clamped_leg(solid, ends).compliance
        # The limit. Slices many times as long as a wall is thick come closest to it:
        # there the direct solve loses digits to the condition of single elements.
        assert scaled_difference(tip_compliance(condensed, ends), direct) < 1e-9
    # The limit; what remains is the deflection's cubic on quadratic slices.
    assert scaled_difference(direct, beam_with_mesh_constants(face, length)) < 1e-4


def test_free_ends_reach_beam_theory():
    """Saint-Venant's solution but for the cubic deflection on quadratic slices: error ~ n⁻⁴."""
    leg = ConstantLeg(8.0, Rectangle(0.16, 0.08), CUBIC)
    section = section_mesh(leg.section, (2, 1))
    beam = beam_with_mesh_constants(section, leg.length)
    coarse, fine = (
        scaled_difference(tip_compliance(condensed_leg(leg, section, n), "free"), beam)
        for n in (256, 1024)
    )
    # (L/h)² of slenderness stands before n⁻⁴.
    assert coarse < 1e-7
    assert fine < 1e-9
    assert np.log(coarse / fine) / np.log(4.0) == pytest.approx(4.0, abs=0.2)


def test_rigid_ends_stiffen_torsion_of_leg_2():
    """Known values: 18 %; and 0.26 % along z, where shear carries a sixth of the deflection."""
    compliance = clamped_leg(meshed(LEG_2, (3, 9), 12)).compliance
    beam = beam_tip_compliance(LEG_2.timoshenko, LEG_2.length)
    share = 1.0 - np.diag(compliance) / np.diag(beam)
    assert share[3] == pytest.approx(0.18, abs=0.005)
    assert np.abs(share[[0, 1, 4, 5]]).max() < 2e-4
    assert 0.0 < share[2] < 3e-3


def test_leg_1_swings_as_is_known_and_its_centreline_bends_as_the_beam_s():
    """Known values: z-bending at 181.8 Hz. Under Fy sections follow Timoshenko's cantilever."""
    solid = meshed(LEG_1, 2, 24)
    clamped = clamped_leg(solid)
    found = clamped.modes(4).frequencies
    # One unit in the last digit given.
    assert found[1] == pytest.approx(181.8, abs=0.1)
    # Tension: √(EA/μ)/4L, exact for ν = 0 but for the slices' own error, (kl)⁴.
    beam, L = LEG_1.timoshenko, LEG_1.length
    assert found[3] == pytest.approx(np.sqrt(beam.EA / beam.mu) / (4.0 * L), rel=1e-5)
    u = clamped.solid.transformation @ clamped.response[:, 1]
    at = np.array([0.3, 0.5, 0.85])
    twists = (section_twists(solid.mesh, at) @ u).reshape(-1, 6)
    # Ends restrained in shear warping, and the mean of a quadratic slice: some 1e-4.
    deflection = at**2 * (3.0 * L - at) / (6.0 * beam.EIz) + at / beam.GAy
    np.testing.assert_allclose(twists[:, 1], deflection, rtol=1e-3)
    rotation = at * (2.0 * L - at) / (2.0 * beam.EIz)
    np.testing.assert_allclose(twists[:, 5], rotation, rtol=1e-3)


def test_solid_mesh_has_slices_as_long_as_its_elements_are_wide():
    mesh = solid_mesh(ConstantLeg(0.8, Rectangle(0.10, 0.16), STEEL), 2)
    assert (mesh.slices, mesh.element) == (16, "hex27")
    with pytest.raises(InputError, match="shorter than"):
        solid_mesh(ConstantLeg(0.1, Rectangle(0.10, 0.16), STEEL), 2)
    with pytest.raises(InputError, match=r"between 0 m and 0.8 m"):
        section_twists(mesh, np.array([0.9]))
    with pytest.raises(InputError, match="extruded"):
        section_twists(tetrahedra(LEG_1.section, LEG_1.length, 1), np.array([0.1]))


@pytest.mark.parametrize("nu", [-0.9999999, 0.4999999])
def test_a_material_that_double_precision_does_not_resolve_is_refused(nu):
    leg = ConstantLeg(0.8, Rectangle(0.1, 0.14), Material.isotropic(2.1e11, nu, 7850.0))
    message = r"material with ν = .*: changes of .* and .* differ"
    with pytest.raises(ComputationError, match=message):
        solid_leg(leg, solid_mesh(leg, 2))
