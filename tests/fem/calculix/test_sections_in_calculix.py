"""Sections without two axes of symmetry, of two materials, and bent legs, as solids in CalculiX."""

from dataclasses import replace

import numpy as np
import pytest

from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from fem.calculix.deck import ElementSet
from fem.calculix.leg import leg_deck
from fem.calculix.run import CalculixMissing, calculix_program, run_calculix
from fem.couplings.end_effects import restrained_compliance
from fem.couplings.grips import rigid_motions, unknowns
from fem.elasticity import stiffness_and_mass
from fem.sections.section_constants import beam_properties, section_constants
from lumped.beam_properties import tip_compliance
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import ConstantLeg, LineLeg, Material
from lumped.sections import Channel, Composite, CompositePart, Rectangle
from meshes.section.section_mesh import section_mesh
from meshes.solid_mesh import EndFace, SolidMesh

STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)
# Nodes of the brick of 20 nodes among those of 27: corners, edges of both faces, edges along x.
_TWENTY = [0, 1, 2, 3, 18, 19, 20, 21, 4, 5, 6, 7, 22, 23, 24, 25, 9, 10, 11, 12]


@pytest.fixture(autouse=True)
def _calculix():
    try:
        calculix_program()
    except CalculixMissing as missing:
        pytest.skip(str(missing))


def of_twenty_nodes(mesh):
    """The extruded mesh with bricks of 20 nodes, an element of CalculiX, instead of 27."""
    used, cells = np.unique(mesh.cells[:, _TWENTY], return_inverse=True)

    def face(end):
        nodes = np.searchsorted(used, np.intersect1d(end.nodes, used))
        return EndFace(nodes, end.mesh)

    cells = cells.reshape(len(mesh.cells), -1)
    ends = face(mesh.root), face(mesh.tip)
    return SolidMesh(mesh.nodes[used], cells, "hex20", *ends, slices=None)


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


def test_leg_with_corner_and_step_equals_calculix():
    """Bricks of 20 nodes on the same mesh, clamped root and rigid tip.

    Results of CalculiX have seven digits. The elements at the mitre are not affine, so that its
    integrals are inexact.
    """
    pieces = (
        LinePiece((0.0, 0.0, 0.0), (0.2, 0.2, 0.0)),
        LinePiece((0.2, 0.2, 0.0), (0.4, 0.0, 0.0)),
    )
    line = CentreLine(pieces, (0.0, 0.0, 1.0))
    thick, thin = Rectangle(0.08, 0.06), Rectangle(0.04, 0.06)
    step = 0.7 * line.length
    stations = ((0.0, thick), (step, thick), (step, thin), (line.length, thin))
    mesh = solid_mesh(LineLeg(line, stations, STEEL), 1)
    computed, _ = by_calculix(mesh, [STEEL])
    bricks = of_twenty_nodes(mesh)
    stiffness, _ = stiffness_and_mass(bricks, STEEL)
    tip, root = bricks.tip.nodes, bricks.root.nodes
    inner = np.setdiff1d(np.arange(len(bricks.nodes)), np.union1d(tip, root))
    point = np.array([bricks.length, 0.0, 0.0])
    motions = np.zeros((3 * len(bricks.nodes), 6 + 3 * len(inner)))
    motions[unknowns(tip), :6] = rigid_motions(bricks.nodes[tip], point)
    motions[unknowns(inner), 6:] = np.eye(3 * len(inner))
    expected = np.linalg.inv(motions.T @ (stiffness @ motions))[:6, :6]
    assert scaled(computed - expected, expected) < 1e-5


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
