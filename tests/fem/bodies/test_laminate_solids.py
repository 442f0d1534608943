"""Solids of fibre layers against closed forms of laminate theory, isotropic solids, CalculiX."""

from dataclasses import replace
from math import cos, pi, radians, sin

import numpy as np
import pytest

from fem.bodies import doubling
from fem.bodies.doubling import condensed_leg
from fem.bodies.solid import SolidLeg, clamped_leg, solid_leg, solid_mesh
from fem.calculix.leg import leg_deck
from fem.calculix.run import CalculixMissing, calculix_program, run_calculix
from fem.couplings.end_effects import restrained_compliance
from fem.elasticity import anisotropic_stiffness_and_mass, on_three_components, stiffness_and_mass
from fem.sections.composite import composite_properties, wrench_states
from fem.sections.moduli import in_wall, layer_elasticity, leg_moduli
from fem.sections.saint_venant import section_quadrature
from lumped.beam_properties import tip_compliance
from lumped.legs import ConstantLeg, Material
from lumped.sections import LaminateBox, LaminateTube, Layer, Rectangle
from meshes.prism import extrude, stations, tetrahedra
from meshes.section.section_mesh import section_mesh

# T300/5208 carbon and epoxy (S. W. Tsai, H. T. Hahn, Introduction to Composite Materials, 1980,
# table 1.7): Pa.
CARBON = {"E1": 181e9, "E2": 10.3e9, "G12": 7.17e9, "nu12": 0.28, "rho": 1600.0}
STEEL = {"E1": 2.1e11, "E2": 2.1e11, "G12": 2.1e11 / 2.6, "nu12": 0.3, "rho": 7850.0}


def layers(*angles, ply=CARBON, thickness=0.25e-3):
    return tuple(Layer(**ply, thickness=thickness, angle=angle) for angle in angles)


def leg_of(section, length=0.12):
    return ConstantLeg(length, section, Material(*section.mean_material))


def uniform(layer):
    """Function of points that returns the moduli (6×6) of a layer in the x-y plane."""
    matrix = in_wall(layer)
    return lambda points, _: np.broadcast_to(matrix, (*points.shape[:2], 6, 6))


@pytest.mark.parametrize("angle", [0.0, 15.0, -40.0, 90.0])
def test_off_axis_coupon_has_published_constants(angle):
    """R. M. Jones, Mechanics of Composite Materials, §2.6, eqs 2.97: 1/Ex and shear per tension.

    One element under uniform tension is exact.
    """
    length, width, height = 0.05, 0.02, 0.01
    mesh = extrude(section_mesh(Rectangle(width, height), (1, 1)), stations(length, 1))
    (layer,) = layers(angle)
    K, _ = anisotropic_stiffness_and_mass(mesh, uniform(layer), np.array([1600.0]))
    # Unit stress on both ends: Simpson's weights of a face of nine nodes.
    weights = np.array([1.0, 4.0, 1.0]) / 6.0
    y, z = (
        np.round(2.0 * mesh.root.mesh.nodes[:, i] / size).astype(int)
        for i, size in ((0, width), (1, height))
    )
    forces = np.zeros(K.shape[0])
    area = width * height * weights[y + 1] * weights[z + 1]
    forces[3 * mesh.tip.nodes], forces[3 * mesh.root.nodes] = area, -area
    motion = np.linalg.lstsq(K.toarray(), forces, rcond=1e-12)[0].reshape(-1, 3)
    far = mesh.nodes - mesh.nodes.mean(axis=0)
    gradient = np.linalg.lstsq(far, motion - motion.mean(axis=0), rcond=None)[0]
    c, s = cos(radians(angle)), sin(radians(angle))
    s11, s22, s66 = 1.0 / CARBON["E1"], 1.0 / CARBON["E2"], 1.0 / CARBON["G12"]
    s12 = -CARBON["nu12"] * s11
    along = s11 * c**4 + (2.0 * s12 + s66) * s**2 * c**2 + s22 * s**4
    shear = (2.0 * s11 - 2.0 * s12 - s66) * s * c**3 - (2.0 * s22 - 2.0 * s12 - s66) * s**3 * c
    assert gradient[0, 0] == pytest.approx(along, rel=1e-9)
    assert gradient[0, 1] + gradient[1, 0] == pytest.approx(shear, rel=1e-9, abs=1e-9 * along)


def test_axial_fibre_tube_has_E1_A_and_G12_J():
    """Errors: 2e-5 in the section (parabolas for arcs), 1e-3 in solids with curved walls."""
    leg = leg_of(LaminateTube(layers(0, thickness=1e-3), 0.06))
    mesh = section_mesh(leg.section, 4)
    beam = composite_properties(mesh, leg_moduli(leg, mesh))
    area = pi * (0.03**2 - 0.029**2)
    polar = pi * (0.03**4 - 0.029**4) / 2.0
    assert pytest.approx(CARBON["E1"] * area, rel=5e-5) == beam.EA
    assert pytest.approx(CARBON["G12"] * polar, rel=5e-5) == beam.GJ
    assert beam.EIy == pytest.approx(CARBON["E1"] * polar / 2.0, rel=5e-5)
    solid = clamped_leg(solid_leg(leg, solid_mesh(leg, 2, section=4)), "free").compliance
    expected = np.diag(tip_compliance(beam, leg.length))
    assert np.diag(solid) == pytest.approx(expected, rel=1e-3)


def test_tube_at_45_degrees_twists_with_published_G():
    """GJ = 2πr³t Gxy, Gxy = 46.59 GPa (Tsai & Hahn, table 3.5), as the wall becomes thin.

    Layers at ±45° at different radii couple tension and twist by the order of t/r.
    """
    couplings = []
    for thickness in (0.5e-3, 0.25e-3):
        leg = leg_of(LaminateTube(layers(45, -45, thickness=thickness), 0.06))
        mesh = section_mesh(leg.section, 4)
        moduli = leg_moduli(leg, mesh)
        wall, radius = 2.0 * thickness, 0.03 - thickness
        expected = 2.0 * pi * radius**3 * wall * (1.0 + wall**2 / (4.0 * radius**2)) * 46.59e9
        assert pytest.approx(expected, rel=1e-3) == composite_properties(mesh, moduli).GJ
        states = wrench_states(mesh, moduli).compliance
        couplings.append(states[0, 3] / np.sqrt(states[0, 0] * states[3, 3]))
    assert couplings[0] > 0.01
    # Half the thickness, half the coupling, and the ratio of the radii.
    assert couplings[0] / couplings[1] == pytest.approx(2.0, rel=0.05)


@pytest.mark.parametrize(
    "section",
    [
        LaminateTube(layers(0, 30, -30, ply=STEEL), 0.06),
        LaminateBox(layers(20, -20, ply=STEEL), 0.06, 0.04),
    ],
    ids=["tube", "box"],
)
def test_layers_of_steel_equal_isotropic_solid(section):
    """The matrices of a solid of steel layers are those of one solid of steel."""
    leg = leg_of(section)
    mesh = extrude(section_mesh(section, 2), stations(0.05, 1))
    solid = solid_leg(leg, mesh)
    K, M = stiffness_and_mass(mesh, Material.isotropic(2.1e11, 0.3, 7850.0))
    assert abs(solid.stiffness - K).max() < 1e-11 * abs(K).max()
    assert abs(solid.mass - on_three_components(M)).max() < 1e-12 * abs(M).max()


def test_box_of_layers_equals_thin_wall_theory():
    """Thin walls neglect the corners, an error of the order of wall 1.5 mm over side 40 mm."""
    leg = leg_of(LaminateBox(layers(45, -45, 0, 0, -45, 45), 0.06, 0.04))
    mesh = section_mesh(leg.section, 2)
    beam, thin = composite_properties(mesh, leg_moduli(leg, mesh)), leg.timoshenko
    for name, tolerance in (("EA", 1e-3), ("EIy", 1e-3), ("EIz", 1e-3), ("GJ", 0.01)):
        assert getattr(beam, name) == pytest.approx(getattr(thin, name), rel=tolerance), name
    assert beam.mu == pytest.approx(thin.mu, rel=1e-9)


def test_equal_layers_share_elements():
    """Four equal layers are one ring of elements."""
    leg = leg_of(LaminateTube(layers(45, -45, 0, 0, 0, 0, -45, 45), 0.06))
    mesh = section_mesh(leg.section, 2)
    assert set(mesh.regions) == {0, 1, 5, 6, 7}
    areas = section_quadrature(mesh).weights.sum(axis=1)
    axial = areas[mesh.regions == 5].sum()
    assert axial == pytest.approx(pi * (0.0295**2 - 0.0285**2), rel=1e-3)


@pytest.mark.parametrize("ends", ["rigid", "free"])
def test_condensed_inclined_fibres_equal_sparse_solid(ends):
    """Halves of a leg with inclined fibres are equal after half a turn, not mirror images."""
    leg = leg_of(LaminateTube(layers(45, -45, thickness=1.5e-3), 0.06))
    mesh = solid_mesh(leg, 1)
    solid = clamped_leg(solid_leg(leg, mesh), ends).compliance
    condensed = doubling.tip_compliance(condensed_leg(leg, mesh.root.mesh, mesh.slices), ends)
    size = np.sqrt(np.diag(solid))
    assert np.abs((condensed - solid) / np.outer(size, size)).max() < 1e-10
    # Tension twists the tip: a leg that is its own mirror image would not.
    assert abs(solid[0, 3]) > 0.01 * size[0] * size[3]


def test_end_effect_of_inclined_fibres_equals_solids():
    """Rigid end faces stiffen tension by 5.9 %. Slices have an error of 1.5e-5 in compliance."""
    leg = leg_of(LaminateTube(layers(45, -45, thickness=1.5e-3), 0.06))
    mesh = section_mesh(leg.section, 1)
    piece = condensed_leg(leg, mesh, 128)
    free, rigid = (doubling.tip_compliance(piece, ends) for ends in ("free", "rigid"))
    size = np.sqrt(np.diag(free))
    change = restrained_compliance(mesh, leg_moduli(leg, mesh), leg.length)
    assert np.abs((rigid - free - change) / np.outer(size, size)).max() < 1e-4
    assert change[0, 0] / free[0, 0] < -0.05
    # The fields of tension and torsion are coupled, and so are those of bending in both planes.
    assert abs(change[0, 3]) > 1e-4 * size[0] * size[3]


def test_condensed_axial_fibre_tube_has_E1_A_and_G12_J():
    """L/E1 A and L/G12 J of a tube, whose arcs are parabolas: an error of 5e-5."""
    leg = leg_of(LaminateTube(layers(0, thickness=1e-3), 0.06))
    tip = doubling.tip_compliance(condensed_leg(leg, section_mesh(leg.section, 4), 16), "free")
    area, polar = pi * (0.03**2 - 0.029**2), pi * (0.03**4 - 0.029**4) / 2.0
    assert tip[0, 0] == pytest.approx(leg.length / (CARBON["E1"] * area), rel=1e-4)
    assert tip[3, 3] == pytest.approx(leg.length / (CARBON["G12"] * polar), rel=1e-4)
    assert tip[5, 5] == pytest.approx(leg.length / (CARBON["E1"] * polar / 2.0), rel=1e-4)


@pytest.mark.slow
def test_off_axis_bar_equals_calculix():
    """Fibres at 30° in the x-y plane, same mesh: equal to the digits that CalculiX prints."""
    try:
        calculix_program()
    except CalculixMissing as missing:
        pytest.skip(str(missing))
    (layer,) = layers(30)
    leg = ConstantLeg(0.1, Rectangle(0.03, 0.02), Material(181e9, 7.17e9, 0.28, 1600.0))
    mesh = tetrahedra(leg.section, leg.length, 1)
    K, M = anisotropic_stiffness_and_mass(mesh, uniform(layer), np.full(len(mesh.cells), 1600.0))
    compliance = clamped_leg(SolidLeg(leg, mesh, K, on_three_components(M)), "rigid").compliance
    deck = leg_deck(mesh, leg.material, 0)
    c, s = cos(radians(30)), sin(radians(30))
    axes = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    (part,) = deck.parts
    part = replace(part, axes=axes, elasticity=layer_elasticity(layer))
    printed = run_calculix(replace(deck, parts=(part,))).displacements.reshape(6, 6).T
    size = np.sqrt(np.diag(compliance))
    assert np.abs((printed - compliance) / np.outer(size, size)).max() < 2e-6
    # Tension shears the bar, bending twists it.
    assert abs(compliance[3, 4]) > 0.05 * size[3] * size[4]
