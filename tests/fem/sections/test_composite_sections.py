"""Composite sections by finite elements, against closed forms, boundary elements and solids."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest

from fem.bodies.doubling import condensed_leg
from fem.bodies.doubling import tip_compliance as solid_compliance
from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from fem.couplings.end_effects import restrained_compliance
from fem.couplings.section_fields import section_fields
from fem.elasticity import composite_stiffness_and_mass, stiffness_and_mass
from fem.sections.composite import composite_properties, composite_rod, wrench_states
from fem.sections.moduli import leg_moduli, part_moduli
from fem.sections.nonuniform_torsion import warping_rod
from fem.sections.saint_venant import section_quadrature
from fem.sections.section_constants import beam_properties, section_constants
from lumped.beam_properties import tip_compliance
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Material
from lumped.screws import move_compliance
from lumped.sections import (
    Channel,
    Circle,
    Composite,
    CompositePart,
    HollowRectangle,
    Rectangle,
    Tube,
)
from meshes.prism import extrude, stations
from meshes.section.section_mesh import section_mesh

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
# Two rectangles without an axis of symmetry, of one Poisson's ratio.
STEPPED = Composite(
    (
        CompositePart(Rectangle(0.05, 0.02), E=2.1e11, nu=0.3, rho=2000.0),
        CompositePart(Rectangle(0.03, 0.04), E=3.5e10, nu=0.3, rho=7000.0, at=(-0.01, 0.03)),
    )
)


def states_of(section, divisions=4):
    leg = ConstantLeg(1.0, section, Material(*section.mean_material))
    mesh = section_mesh(section, divisions)
    return wrench_states(mesh, leg_moduli(leg, mesh))


def per_length(properties):
    """Return the 6×6 strains per length of a beam under unit wrenches on its section."""
    length = 1e-6 * np.sqrt(properties.EIy / properties.EA)
    return properties.piece_compliance(length) / length


def scaled(difference, compliance):
    size = np.sqrt(np.diag(compliance))
    return np.abs(difference / np.outer(size, size)).max()


def test_one_material_equals_saint_venant():
    """Formulations by stress potentials and by displacements agree on one mesh."""
    mesh = section_mesh(Channel(0.05, 0.1, 0.02, 0.02), 4)
    expected = per_length(beam_properties(section_constants(mesh, STEEL.nu), STEEL))
    assert (
        scaled(wrench_states(mesh, part_moduli(mesh, [STEEL])).compliance - expected, expected)
        < 1e-8
    )


def test_two_materials_equal_boundary_elements():
    """Both materials have one ν; the difference, 3e-3 on the coarsest mesh, falls by refinement."""
    leg = ConstantLeg(1.0, STEPPED, Material(*STEPPED.mean_material))
    expected = per_length(leg.timoshenko)
    coarse, fine = (
        scaled(states_of(STEPPED, divisions).compliance - expected, expected)
        for divisions in (4, 8)
    )
    assert fine < 2e-3
    assert fine < 0.5 * coarse
    # The couplings are not small: shear, shear centre.
    assert scaled(np.triu(expected, 1), expected) > 0.05


@pytest.mark.slow
@pytest.mark.parametrize(("inner", "outer"), [(0.45, 0.1), (0.1, 0.45)])
def test_filled_tube_equals_hashin(inner, outer):
    """A core of the share c is bonded into a tube with a free surface.

    Then E = c E_f + (1 − c) E_m + 4c(1 − c)(ν_f − ν_m)² / (c/k_m + (1 − c)/k_f + 1/μ_m), with plane
    strain bulk moduli k: Z. Hashin, B. W. Rosen, J. Appl. Mech. 31 (1964) 223 (R. M. Christensen,
    Mechanics of Composite Materials, §3.2). Circles are polygons of 64 sides (1e-4 of the extra
    term).
    """
    tube, core = Tube(0.08, 0.015), Circle(0.05)
    E_m, E_f = 7.0e10, 2.0e10
    section = Composite(
        (CompositePart(tube, E_m, outer, 2700.0), CompositePart(core, E_f, inner, 1200.0))
    )
    c = core.area / (core.area + tube.area)
    k_m, k_f = (E / (2.0 * (1.0 + nu) * (1.0 - 2.0 * nu)) for E, nu in ((E_m, outer), (E_f, inner)))
    mu_m = E_m / (2.0 * (1.0 + outer))
    extra = 4.0 * c * (1.0 - c) * (inner - outer) ** 2
    extra /= c / k_m + (1.0 - c) / k_f + 1.0 / mu_m
    mixed = c * E_f + (1.0 - c) * E_m
    area = pi * 0.04**2
    stiffness = 1.0 / states_of(section).compliance[0, 0] / area
    assert extra > 0.004 * mixed
    assert stiffness - mixed == pytest.approx(extra, rel=2e-3)


def test_composite_of_one_material_equals_plain_solid():
    """Stiffness and mass of a stepped section with two parts, both of steel."""
    mesh = extrude(section_mesh(STEPPED, 4), stations(0.1, 3))
    plain = stiffness_and_mass(mesh, STEEL)
    parted = composite_stiffness_and_mass(mesh, mesh.regions, [STEEL, STEEL])
    for composite_matrix, plain_matrix in zip(parted, plain, strict=True):
        assert abs(composite_matrix - plain_matrix).max() < 1e-12 * abs(plain_matrix).max()


def test_composite_solid_equals_beam():
    """Ends are free to warp; slices as long as elements are wide have an error of 1e-4.

    The mass is the sum of both parts.
    """
    length = 0.2
    leg = ConstantLeg(length, STEPPED, Material(*STEPPED.mean_material))
    solid = solid_leg(leg, solid_mesh(leg, 2))
    translation = np.zeros(3 * len(solid.mesh.nodes))
    translation[::3] = 1.0
    mass = sum(part.rho * part.section.area * length for part in STEPPED.parts)
    assert translation @ (solid.mass @ translation) == pytest.approx(mass, rel=1e-9)
    section = states_of(STEPPED, 2).compliance
    beam = np.zeros((6, 6))
    points, weights = np.polynomial.legendre.leggauss(3)
    for point, weight in zip(points, weights, strict=True):
        lever = length * (0.5 - 0.5 * point)
        beam += 0.5 * length * weight * move_compliance(section, np.array([lever, 0.0, 0.0]))
    tip = clamped_leg(solid, "free").compliance
    assert scaled(tip - beam, beam) < 1e-4
    # A force along z through the centroid twists the leg about its shear centre.
    assert abs(beam[3, 2]) > 1e-3 * np.sqrt(beam[3, 3] * beam[2, 2])


def test_composite_beam_has_section_compliance():
    """The beam has all couplings of its section's 6×6 compliance by finite elements.

    The section is unsymmetric, with one Poisson's ratio. Mass, its centre and rotary inertia are
    those of the section's exact formulas.
    """
    mesh = section_mesh(STEPPED, 4)
    leg = ConstantLeg(1.0, STEPPED, Material(*STEPPED.mean_material))
    beam = composite_properties(mesh, leg_moduli(leg, mesh))
    states = states_of(STEPPED).compliance
    assert scaled(per_length(beam) - states, states) < 1e-8
    for name in ("mu", "mass_y", "mass_z", "rho_J", "rho_Iy", "rho_Iz", "rho_Iyz"):
        assert getattr(beam, name) == pytest.approx(getattr(leg.timoshenko, name), rel=1e-9), name


def test_one_material_warps_as_saint_venant():
    """Torsion, shear, bimoment and inertia of warping of a channel, by both formulations."""
    mesh = section_mesh(Channel(0.05, 0.1, 0.02, 0.02), 4)
    rod = composite_rod(mesh, part_moduli(mesh, [STEEL]))
    expected = warping_rod(section_constants(mesh, STEEL.nu), STEEL)
    for name in ("twist", "shear", "bimoment", "rotary", "warping"):
        assert getattr(rod, name) == pytest.approx(getattr(expected, name), rel=1e-8), name


def sandwich(upper):
    """Leg with aluminium faces, the upper one of modulus `upper` (Pa), and a soft core."""
    faces, core = Rectangle(0.04, 0.01), Rectangle(0.04, 0.02)
    section = Composite(
        (
            CompositePart(faces, 7e10, 0.3, 2700.0, at=(0.0, -0.015)),
            CompositePart(core, 3e9, 0.1, 300.0),
            CompositePart(faces, upper, 0.3, 2700.0, at=(0.0, 0.015)),
        )
    )
    return ConstantLeg(0.2, section, Material(*section.mean_material))


def test_sandwich_rigid_ends_equal_decaying_fields():
    """The soft core lets the faces warp, so that rigid ends reduce the twist by 22 %.

    At edges of rigid faces the stress is singular: an error of 0.04 % on this mesh, 0.001 % on one
    four times as fine.
    """
    leg = sandwich(7e10)
    mesh = section_mesh(leg.section, 2)
    moduli = leg_moduli(leg, mesh)
    # Two axes of symmetry, of materials too.
    assert len(section_fields(mesh, moduli)) == 4
    beam = tip_compliance(composite_properties(mesh, moduli), leg.length)
    change = restrained_compliance(mesh, moduli, leg.length)
    piece = condensed_leg(leg, mesh, 32)
    assert scaled(solid_compliance(piece, "free") - beam, beam) < 2e-6
    rigid = np.diag(solid_compliance(piece, "rigid"))
    assert rigid == pytest.approx(np.diag(beam + change), rel=1e-3)
    assert change[3, 3] < -0.2 * beam[3, 3]


def test_unequal_faces_couple_tension_and_bending():
    """The nodes of this mesh are mirror images of each other, its materials are not."""
    leg = sandwich(7.1e10)
    mesh = section_mesh(leg.section, 2)
    centred = replace(mesh, nodes=mesh.nodes - 0.5 * (mesh.nodes.max(0) + mesh.nodes.min(0)))
    names = [fields.name for fields in section_fields(centred, leg_moduli(leg, centred))]
    assert names == ["tension with bending y", "torsion with bending z"]


def test_filled_box_has_structured_mesh():
    """Box and core share one structured mesh. As two polygons they had 6459 unknowns."""
    box, core = HollowRectangle(0.06, 0.08, 0.004), Rectangle(0.052, 0.072)
    section = Composite(
        (CompositePart(box, 2e11, 0.3, 7850.0), CompositePart(core, 3e10, 0.2, 2300.0))
    )
    mesh = section_mesh(section, 4)
    assert 3 * len(mesh.nodes) < 600
    weights = section_quadrature(mesh).weights
    areas = [weights[mesh.regions == number].sum() for number in range(2)]
    assert areas == pytest.approx([box.area, core.area], rel=1e-9)


def test_uniform_section_formula_refuses_composite():
    with pytest.raises(InputError, match="takes sections of one material"):
        section_constants(section_mesh(STEPPED, 4), 0.3)


@pytest.mark.soak
def test_composite_equals_sectionproperties():
    """Another finite element code, weighted by E: van Leeuwen, sectionproperties.

    Both materials have the same Poisson's ratio. The shear centre by Trefftz, which that code
    computes, is then the one by energy.
    """
    library = pytest.importorskip("sectionproperties.pre.library")
    analysis = pytest.importorskip("sectionproperties.analysis")
    pre = pytest.importorskip("sectionproperties.pre")
    geometry = None
    for number, part in enumerate(STEPPED.parts):
        width, height = (1e3 * size for size in part.section.extent)
        material = pre.Material(str(number), part.E / 1e9, part.nu, 1.0, 1.0, "grey")
        shape = library.rectangular_section(d=height, b=width, material=material).shift_section(
            1e3 * part.at[0] - width / 2.0, 1e3 * part.at[1] - height / 2.0
        )
        geometry = shape if geometry is None else geometry + shape
    geometry.create_mesh([1.0])
    theirs = analysis.Section(geometry)
    theirs.calculate_geometric_properties()
    theirs.calculate_warping_properties()
    beam = ConstantLeg(1.0, STEPPED, Material(*STEPPED.mean_material)).timoshenko
    # Moduli in GPa, lengths in mm: 1e3 N and 1e-3 N m² per unit.
    assert pytest.approx(1e3 * theirs.get_ea(), rel=1e-9) == beam.EA
    moments = (beam.EIy, beam.EIz, beam.EIyz)
    assert moments == pytest.approx(1e-3 * np.array(theirs.get_eic()), rel=1e-9)
    shear = 2.0 * (1.0 + 0.3)
    assert pytest.approx(1e-3 * theirs.get_ej() / shear, rel=1e-3) == beam.GJ
    stiffnesses = np.array([beam.GAy, beam.GAz])
    assert stiffnesses == pytest.approx(1e3 * np.array(theirs.get_eas()) / shear, rel=2e-3)
    centre = 1e-3 * (np.array(theirs.get_sc_t()) - np.array(theirs.get_c()))
    assert [beam.centre_y, beam.centre_z] == pytest.approx(centre, abs=1e-5)
