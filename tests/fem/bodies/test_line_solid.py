"""Legs along a line as solids against beams, and against solutions of elasticity."""

import numpy as np
import pytest

from fem.beams.line_beam import line_beam
from fem.bodies.solid import clamped_leg, section_twists, solid_leg, solid_mesh
from fem.couplings.grips import rigid_motions
from fem.sections.section_constants import beam_properties, section_constants
from lumped.centre_line import CentreLine, LinePiece
from lumped.legs import ConstantLeg, LineLeg, Material
from lumped.models.bodies import clamped_modes
from lumped.screws import shift
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle
from meshes.section.section_mesh import section_mesh

STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
UP = (0.0, 0.0, 1.0)
STRAIGHT = CentreLine((LinePiece((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),), UP)


def tapered(line, first, last, material=STEEL):
    return LineLeg(line, ((0.0, first), (line.length, last)), material)


def clamped(leg, divisions, ends="free"):
    return clamped_leg(solid_leg(leg, solid_mesh(leg, divisions)), ends)


def test_equal_sections_give_prism_solid():
    """A line leg with equal end sections has the tip compliance of the prism's solid."""
    section = Rectangle(0.06, 0.10)
    line, prism = tapered(STRAIGHT, section, section), ConstantLeg(1.0, section, STEEL)
    for ends in ("free", "rigid"):
        expected = clamped(prism, 1, ends).compliance
        compliance = clamped(line, 1, ends).compliance
        assert np.abs(compliance - expected).max() < 1e-9 * np.abs(expected).max()


def test_slender_cone_solid_equals_beam():
    """Ends are free to warp. The mesh lacks 8e-4 of the cone's volume and of its stiffness.

    With section constants of that mesh, deflections differ only by the fourth power of the slope.
    Without the shear stresses across the force, they differed by 0.03 %.
    """
    leg = tapered(STRAIGHT, Circle(0.10), Circle(0.05))
    solid = clamped(leg, 4)
    beam = leg.sections("timoshenko")
    computed = leg.sections_by(
        lambda prism: beam_properties(section_constants(section_mesh(prism.section, 4), 0.3), STEEL)
    )
    assert np.diag(solid.compliance)[1:3] == pytest.approx(
        np.diag(computed.tip_compliance)[1:3], rel=5e-5
    )
    ratios = np.diag(solid.compliance) / np.diag(beam.tip_compliance) - 1.0
    assert np.abs(ratios).max() < 2.5e-3
    expected = clamped_modes(line_beam(beam, 20), 4).frequencies
    assert solid.modes(4).frequencies == pytest.approx(expected, rel=2e-3)


def test_slender_tapered_solid_equals_beam():
    """Taper 2:1 in height: bending and frequencies within 0.15 % of the beam, torsion 1 %."""
    leg = tapered(STRAIGHT, Rectangle(0.06, 0.10), Rectangle(0.06, 0.05))
    solid = clamped(leg, 2)
    beam = leg.sections("timoshenko")
    ratios = np.diag(solid.compliance) / np.diag(beam.tip_compliance) - 1.0
    bending = ratios[[0, 1, 2, 4, 5]]
    assert np.abs(bending).max() < 1.5e-3
    # Two elements across are too stiff in torsion, by 0.9 %; four by 0.1 %.
    assert abs(ratios[3]) < 0.01
    expected = clamped_modes(line_beam(beam, 20), 4).frequencies
    assert solid.modes(4).frequencies == pytest.approx(expected, rel=1.5e-3)


@pytest.mark.parametrize(
    ("first", "last", "largest"),
    [
        (HollowRectangle(0.1, 0.08, 0.004), HollowRectangle(0.06, 0.05, 0.004), 0.0012),
        (ISection(0.05, 0.10, 0.006, 0.006), ISection(0.05, 0.06, 0.006, 0.006), 0.003),
    ],
    ids=["box", "i-section"],
)
def test_thin_tapered_solid_equals_beam(first, last, largest):
    """Walls that converge carry shear. End loads along their fibres do not bend them.

    With parallel fibres in the beam, and end loads of the solid along the line of the leg, errors
    were 2.0 % and 1.3 %; without the shear stresses across the force in flanges, 0.6 % and 0.3 %.
    The remaining errors are those of this mesh (0.05 %) and of the thin-wall κ.
    """
    length = 0.4 if isinstance(first, HollowRectangle) else 0.8
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (length, 0.0, 0.0)),), UP)
    leg = tapered(line, first, last)
    beam = leg.sections("timoshenko").tip_compliance
    ratios = np.diag(clamped(leg, 1).compliance) / np.diag(beam) - 1.0
    # Torsion of thin shapes whose sides converge is no matter of beam theory.
    assert np.abs(ratios[[0, 1, 2, 4, 5]]).max() < largest


def test_ring_solid_equals_elasticity():
    """Radial load on the free end: Timoshenko and Goodier, Theory of Elasticity, §33."""
    inner, outer, thickness = 4.12, 4.32, 0.1
    chord, rise = 4.22 * np.sqrt(2.0), 4.22 * (1.0 - np.sqrt(0.5))
    line = CentreLine(
        (LinePiece((0.0, 0.0, 0.0), (chord, 0.0, 0.0), (chord / 2.0, rise, 0.0)),), UP
    )
    section = Rectangle(outer - inner, thickness)
    material = Material.isotropic(E=1e7, nu=0.25, rho=1.0)
    solid = clamped(tapered(line, section, section, material), 1)
    squares = inner**2 + outer**2
    denominator = inner**2 - outer**2 + squares * np.log(outer / inner)
    expected = np.pi * squares / (material.E * thickness * denominator)
    radial = np.array([np.sqrt(0.5), np.sqrt(0.5), 0.0])
    in_plane = float(radial @ solid.compliance[:3, :3] @ radial)
    # The section may contract, plane stress throughout; coarse mesh: 1e-3.
    assert in_plane == pytest.approx(expected, rel=1e-3)
    # MacNeal and Harder (1985) list 0.08734 and, out of plane, 0.5022.
    assert in_plane == pytest.approx(0.08734, rel=0.02)
    assert solid.compliance[2, 2] == pytest.approx(0.5022, rel=0.02)


def test_section_twist_is_rigid_motion():
    """If a curved leg moves rigidly, the mean twist of each section is that of the motion."""
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, 0.3, 0.1)),), UP)
    leg = tapered(line, Rectangle(0.06, 0.10), Rectangle(0.05, 0.04))
    mesh = solid_mesh(leg, 1)
    stations = mesh.positions[[0, 5, len(mesh.positions) - 1]]
    motions = section_twists(mesh, stations) @ rigid_motions(mesh.nodes, np.zeros(3))
    points, _ = line.frames(stations)
    # On planes of nodes, without interpolation between them.
    assert motions == pytest.approx(shift(points).reshape(-1, 6), abs=1e-12)
