"""Sections without two axes of symmetry, of two materials, and bent legs, as solids in CalculiX."""

from dataclasses import replace

import numpy as np
import pytest

from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from fem.calculix.deck import ElementSet
from fem.calculix.leg import leg_deck, mass_at_stiffness_points, of_twenty_nodes
from fem.calculix.run import CalculixMissing, calculix_program, run_calculix
from fem.couplings.end_effects import restrained_compliance
from fem.sections.section_constants import beam_properties, section_constants
from lumped.beam_properties import tip_compliance
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import ConstantLeg, LineLeg, Material
from lumped.sections import Channel, Circle, Composite, CompositePart, Rectangle
from meshes.section.section_mesh import section_mesh

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)


@pytest.fixture(autouse=True)
def _calculix():
    try:
        calculix_program()
    except CalculixMissing as missing:
        pytest.skip(str(missing))


def by_calculix(mesh, materials, modes=0):
    """Tip compliance (6×6) and frequencies, rigid end faces; one material for each region."""
    plain = of_twenty_nodes(mesh)
    regions = np.zeros(len(plain.cells), dtype=int) if mesh.regions is None else mesh.regions
    deck = leg_deck(plain, materials[0], modes)
    parts = tuple(
        ElementSet(plain.cells[regions == number], "hex20", material)
        for number, material in enumerate(materials)
    )
    results = run_calculix(replace(deck, parts=parts))
    return results.displacements.reshape(6, 6).T, results.frequencies


def scaled(difference, compliance):
    size = np.sqrt(np.diag(compliance))
    return np.abs(difference / np.outer(size, size)).max()


THICK, THIN = Rectangle(0.08, 0.06), Rectangle(0.04, 0.06)
CORNER = CentreLine(
    (
        LinePiece((0.0, 0.0, 0.0), (0.2, 0.2, 0.0)),
        LinePiece((0.2, 0.2, 0.0), (0.4, 0.0, 0.0)),
    ),
    (0.0, 0.0, 1.0),
)
STEP = 0.7 * CORNER.length
# An arc of 80° about an inclined axis.
ARC = CentreLine((LinePiece((0.0, 0.0, 0.0), (0.2, 0.0, 0.0), (0.1, 0.03, 0.02)),), (0.1, 0.0, 1.0))


@pytest.mark.parametrize(
    ("line", "stations"),
    [
        (CORNER, ((0.0, THICK), (STEP, THICK), (STEP, THIN), (CORNER.length, THIN))),
        (ARC, ((0.0, THICK), (ARC.length, Rectangle(0.03, 0.04)))),
        (ARC, ((0.0, Circle(0.05)), (ARC.length, Circle(0.03)))),
    ],
    ids=["corner-step", "tapered-arc", "round-arc"],
)
def test_leg_along_line_equals_calculix(line, stations):
    """Bricks of 20 nodes on the same mesh, clamped root and rigid tip: statics and frequencies.

    Both programs have the same 27 points of integration. CalculiX prints seven digits.
    """
    leg = LineLeg(line, stations, STEEL)
    mesh = solid_mesh(leg, 1)
    computed, frequencies = by_calculix(mesh, [STEEL], modes=4)
    solid = solid_leg(leg, of_twenty_nodes(mesh))
    assert solid.mesh.length == pytest.approx(line.chord, rel=1e-12)
    mass = mass_at_stiffness_points(solid.mesh, STEEL.rho)
    clamped = clamped_leg(replace(solid, mass=mass), "rigid")
    assert scaled(computed - clamped.compliance, clamped.compliance) < 1e-6
    assert frequencies[:4] == pytest.approx(clamped.modes(4).frequencies, rel=1e-6)


@pytest.mark.slow
def test_channel_twist_equals_calculix():
    """Twist per force along the web is −y_s L/GJ, less the restraint of warping by rigid end faces.

    Both are computed by theory on the section. Bricks as long as they are wide have an error of
    0.5 % in the compliances and 1 % in the coupling.
    """
    length, section = 0.3, Channel(0.05, 0.1, 0.02, 0.02)
    leg = ConstantLeg(length, section, STEEL)
    computed, _ = by_calculix(solid_mesh(leg, 4), [STEEL])
    mesh = section_mesh(section, 4)
    free = tip_compliance(beam_properties(section_constants(mesh, STEEL.nu), STEEL), length)
    theory = free + restrained_compliance(mesh, STEEL, length)
    assert scaled(computed - theory, theory) < 0.005
    # The shear centre lies beyond the web: the twist is far above what any error explains.
    y, _ = section.shear_centre
    unrestrained = -y * length / (STEEL.G * section.torsion_constant)
    assert y < -0.02
    # Rigid faces at both ends of a leg three times as long as it is high take half of it.
    assert 0.45 * unrestrained < computed[3, 2] < 0.65 * unrestrained
    assert computed[3, 2] == pytest.approx(theory[3, 2], rel=0.01)


@pytest.mark.slow
def test_composite_bar_equals_calculix():
    """Compliance and frequencies of two materials with different Poisson's ratios.

    Bricks of 20 nodes agree with those of 27 on one mesh within 0.5 %, and with beams corrected for
    rigid end faces within 3 %.
    """
    parts = (
        CompositePart(Rectangle(0.05, 0.02), E=2.1e11, nu=0.3, rho=7850.0),
        CompositePart(Rectangle(0.03, 0.04), E=3.5e10, nu=0.2, rho=2400.0, at=(-0.01, 0.03)),
    )
    section = Composite(parts)
    leg = ConstantLeg(0.25, section, Material(*section.mean_material))
    mesh = solid_mesh(leg, 2)
    materials = [Material.isotropic(part.E, part.nu, part.rho) for part in parts]
    computed, frequencies = by_calculix(mesh, materials, modes=3)
    clamped = clamped_leg(solid_leg(leg, mesh), "rigid")
    assert scaled(computed - clamped.compliance, clamped.compliance) < 0.005
    assert frequencies[:3] == pytest.approx(clamped.modes(3).frequencies, rel=0.005)
    beam = tip_compliance(leg.timoshenko, leg.length)
    bending = np.ix_([1, 2], [1, 2])
    assert computed[bending] == pytest.approx(beam[bending], rel=0.03)
    # The axes of bending are turned: a force along y moves the tip along z by a tenth of it.
    assert abs(computed[2, 1]) > 0.1 * computed[1, 1]
