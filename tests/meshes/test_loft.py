"""Solid meshes of legs along a line: volume, walls and ends; legs that cannot be meshed."""

import numpy as np
import pytest

from fem.elasticity import stiffness_and_mass
from lumped.centre_line import CentreLine, LinePiece
from lumped.errors import InputError
from lumped.legs import LineLeg, Material
from lumped.sections import (
    Channel,
    Circle,
    HollowRectangle,
    ISection,
    Polygon,
    Rectangle,
    SectionProperties,
    Tube,
)
from meshes.loft import loft, why_no_loft

STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
UP = (0.0, 0.0, 1.0)
STRAIGHT = CentreLine((LinePiece((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),), UP)
ARC = CentreLine((LinePiece((0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.5, 0.3, 0.0)),), UP)
BENT = CentreLine(
    (LinePiece((0.0, 0.0, 0.0), (0.5, 0.2, 0.0)), LinePiece((0.5, 0.2, 0.0), (1.0, 0.0, 0.0))), UP
)
TAPERS = {
    "rectangle": (Rectangle(0.10, 0.06), Rectangle(0.05, 0.08)),
    "hollow-rectangle": (HollowRectangle(0.10, 0.08, 0.008), HollowRectangle(0.06, 0.08, 0.004)),
    "i-section": (ISection(0.08, 0.10, 0.008, 0.006), ISection(0.06, 0.07, 0.004, 0.006)),
    "channel": (Channel(0.05, 0.10, 0.008, 0.006), Channel(0.04, 0.07, 0.006, 0.005)),
}


def tapered(line, first, last, material=STEEL):
    return LineLeg(line, ((0.0, first), (line.length, last)), material)


@pytest.mark.parametrize("shape", TAPERS)
def test_flat_taper_mesh_has_exact_volume(shape):
    """Tapered sections with flat walls: mass and size of the ends are those of the leg."""
    leg = tapered(STRAIGHT, *TAPERS[shape])
    mesh = loft(leg, 1, 4)
    _, mass = stiffness_and_mass(mesh, STEEL)
    # Exact hexahedra: round-off alone.
    assert mass.sum() == pytest.approx(leg.mass, rel=1e-10)
    for face, section in ((mesh.root, leg.stations[0][1]), (mesh.tip, leg.stations[-1][1])):
        assert np.ptp(face.mesh.nodes, axis=0) == pytest.approx(section.extent, rel=1e-9)


def test_tapered_tube_keeps_wall_thickness():
    """Wall of 20 mm at the root, 5 mm at the tip: radii of the nodes on both ends."""
    leg = tapered(STRAIGHT, Tube(0.1, 0.02), Tube(0.06, 0.005))
    mesh = loft(leg, 4, 4)
    for face, (inner, outer) in ((mesh.root, (0.03, 0.05)), (mesh.tip, (0.025, 0.03))):
        radii = np.linalg.norm(face.mesh.nodes, axis=1)
        assert [radii.min(), radii.max()] == pytest.approx([inner, outer], rel=1e-9)


def test_cone_mesh_volume_has_order_four():
    """Arcs are parabolas: halving the elements leaves 1/16 of the error."""
    leg = tapered(STRAIGHT, Circle(0.10), Circle(0.05))
    errors = []
    for divisions in (2, 4):
        _, mass = stiffness_and_mass(loft(leg, divisions, 4), STEEL)
        errors.append(1.0 - mass.sum() / leg.mass)
    # Parabolas in place of arcs: fourth order in the angle of one.
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.15)
    assert abs(errors[1]) < 1e-3


def test_arc_mesh_has_volume_and_plane_ends():
    """Constant section along an arc: volume of the leg, ends normal to the line."""
    leg = tapered(ARC, Rectangle(0.08, 0.06), Rectangle(0.08, 0.06))
    mesh = loft(leg, 1, 12)
    _, mass = stiffness_and_mass(mesh, STEEL)
    # Quadratic elements along the arc: 2.2e-6 with 12 slices.
    assert mass.sum() == pytest.approx(leg.mass, rel=1e-5)
    for face, position in ((mesh.root, 0.0), (mesh.tip, ARC.length)):
        centres, axes = ARC.frames(np.array([position]))
        offsets = (mesh.nodes[face.nodes] - centres[0]) @ axes[0]
        assert offsets[:, 0] == pytest.approx(0.0, abs=1e-12)
        assert offsets[:, 1:] == pytest.approx(face.mesh.nodes, abs=1e-12)
    assert mesh.length == 1.0


def test_unmeshable_tapered_leg_is_refused():
    """Section by constants, corners, jumps, and a tapered polygon, each with its reason."""
    square, small = Rectangle(0.06, 0.06), Rectangle(0.04, 0.04)
    constants = SectionProperties(1e-3, 1e-7, 1e-7, 1e-7)
    stepped = LineLeg(STRAIGHT, ((0.0, square), (0.4, square), (0.4, small), (1.0, small)), STEEL)
    cubic = Material(E=2.1e11, G=9e10, nu=0.3, rho=7850.0)
    triangle = [Polygon(((0.0, 0.0), (size, 0.0), (0.0, size))) for size in (0.06, 0.05)]
    reasons = {
        "no shape": tapered(STRAIGHT, constants, constants),
        "corners (at 0.5385 m along it)": tapered(BENT, square, square),
        "jumps at 0.4 m": stepped,
        "independent G": tapered(ARC, square, square, cubic),
        "tapered polygon": tapered(STRAIGHT, *triangle),
    }
    for reason, leg in reasons.items():
        assert reason in why_no_loft(leg)
        with pytest.raises(InputError, match="a leg: "):
            loft(leg, 1, 4)
    assert why_no_loft(tapered(ARC, square, small)) == ""
    assert why_no_loft(tapered(STRAIGHT, square, small, cubic)) == ""
