"""One leg as a solid, held against beam theory, thin-wall theory and the known values."""

import numpy as np
import pytest
from compliances import scaled_difference
from prismatic_legs import LEG_1, LEG_2, STEEL, meshed

from fem.bodies.solid import (
    clamped_leg,
    section_twists,
    solid_leg,
    solid_mesh,
)
from fem.sections.section_constants import beam_properties, section_constants
from lumped.errors import ComputationError, InputError
from lumped.legs import ConstantLeg, Material
from lumped.legs import tip_compliance as beam_tip_compliance
from lumped.sections import ISection, Rectangle, Tube
from meshes.prism.tetrahedra import tetrahedra

CUBIC = Material(E=2.1e11, G=1.2e11, nu=0.25, rho=7850.0)


def beam_with_mesh_constants(solid):
    material = solid.leg.material
    constants = section_constants(solid.mesh.root.mesh, material.nu, material.G / material.E)
    return beam_tip_compliance(beam_properties(constants, material), solid.leg.length)


# Lengths (m), sections, divisions across, slices; a stub as well as legs.
FREE_LEGS = [
    (0.2, Rectangle(0.10, 0.16), 3, 8),
    (0.8, Tube(0.12, 0.008), 4, 12),
    (0.8, ISection(0.10, 0.16, 0.012, 0.008), 2, 20),
]


@pytest.mark.parametrize(
    ("length", "section", "divisions", "slices"),
    FREE_LEGS,
    ids=lambda value: getattr(value, "shape", None),
)
def test_free_ends_reproduce_beam_theory(length, section, divisions, slices):
    """Clapeyron: with Saint-Venant ends the solid is Timoshenko's beam of its section."""
    solid = meshed(ConstantLeg(length, section, CUBIC), divisions, slices)
    compliance = clamped_leg(solid, "free").compliance
    # The limit, 1e-4; what remains is the deflection's cubic on quadratic slices.
    assert scaled_difference(compliance, beam_with_mesh_constants(solid)) < 1e-4


def test_rigid_ends_stiffen_torsion_of_leg_2():
    """Known values: 18 %; and 0.26 % along z, where shear carries a sixth of the deflection."""
    solid = meshed(LEG_2, (3, 9), 12)
    compliance = clamped_leg(solid).compliance
    beam = beam_tip_compliance(LEG_2.timoshenko, LEG_2.length)
    share = 1.0 - np.diag(compliance) / np.diag(beam)
    assert share[3] == pytest.approx(0.18, abs=0.005)
    assert np.abs(share[[0, 1, 4, 5]]).max() < 2e-4
    assert 0.0 < share[2] < 3e-3


def test_first_frequencies_of_leg_1():
    """Known values: z-bending of leg 1 at 181.8 Hz in the 3-D solid."""
    found = clamped_leg(meshed(LEG_1, 2, 12)).modes(4)
    # One unit in the last digit given.
    assert found.frequencies[1] == pytest.approx(181.8, abs=0.1)
    # Tension: √(EA/μ)/4L, exact for ν = 0 but for the slices' own error, (kl)⁴.
    beam = LEG_1.timoshenko
    tension = np.sqrt(beam.EA / beam.mu) / (4.0 * LEG_1.length)
    assert found.frequencies[3] == pytest.approx(tension, rel=1e-5)


def test_centreline_of_a_tip_load_is_the_beam():
    """Under Fy the sections of the middle follow Timoshenko's cantilever."""
    solid = meshed(LEG_1, 2, 24)
    clamped = clamped_leg(solid)
    u = clamped.solid.transformation @ clamped.response[:, 1]
    at = np.array([0.3, 0.5, 0.85])
    twists = (section_twists(solid.mesh, at) @ u).reshape(-1, 6)
    beam, L = LEG_1.timoshenko, LEG_1.length
    deflection = at**2 * (3.0 * L - at) / (6.0 * beam.EIz) + at / beam.GAy
    rotation = at * (2.0 * L - at) / (2.0 * beam.EIz)
    # Ends restrained in shear warping, and the mean of a quadratic slice: some 1e-4.
    np.testing.assert_allclose(twists[:, 1], deflection, rtol=1e-3)
    np.testing.assert_allclose(twists[:, 5], rotation, rtol=1e-3)


def test_solid_mesh_has_slices_as_long_as_its_elements_are_wide():
    mesh = solid_mesh(ConstantLeg(0.8, Rectangle(0.10, 0.16), STEEL), 2)
    assert mesh.slices == 16
    assert mesh.element == "hex27"
    with pytest.raises(InputError, match="shorter than"):
        solid_mesh(ConstantLeg(0.1, Rectangle(0.10, 0.16), STEEL), 2)
    with pytest.raises(InputError, match=r"between 0 m and 0.8 m"):
        section_twists(mesh, np.array([0.9]))
    with pytest.raises(InputError, match="extruded"):
        section_twists(tetrahedra(LEG_1.section, LEG_1.length, 1), np.array([0.1]))


@pytest.mark.parametrize("nu", [-0.9999999, 0.4999999])
def test_a_material_that_double_precision_does_not_resolve_is_refused(nu):
    leg = ConstantLeg(0.8, Rectangle(0.1, 0.14), Material.isotropic(2.1e11, nu, 7850.0))
    with pytest.raises(
        ComputationError, match=r"material with ν = .*: changes of .* and .* differ"
    ):
        solid_leg(leg, solid_mesh(leg, 2))
