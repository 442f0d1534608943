"""Solid meshes of legs along a line: volume, walls and ends; legs that cannot be meshed."""

from itertools import chain, pairwise

import numpy as np
import pytest

from fem.bodies.solid import section_twists
from fem.couplings.grips import rigid_motions
from fem.elasticity import stiffness_and_mass
from lumped.centre_line import CentreLine, LinePiece
from lumped.errors import InputError
from lumped.legs import LineLeg, Material
from lumped.screws import shift
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
ARC_TO_CORNER = CentreLine(
    (
        LinePiece((0.0, 0.0, 0.0), (0.6, 0.0, 0.0), (0.3, 0.06, 0.0)),
        LinePiece((0.6, 0.0, 0.0), (1.0, 0.0, 0.0)),
    ),
    UP,
)
TWO_ARCS = CentreLine(
    (ARC_TO_CORNER.pieces[0], LinePiece((0.6, 0.0, 0.0), (1.0, 0.0, 0.0), (0.8, 0.03, 0.0))), UP
)
# Two arcs of 35 mm radius: the mitre of their corner is longer than their inner fibres.
TIGHT = CentreLine(
    (
        LinePiece((0.0, 0.0, 0.0), (0.05, 0.0, 0.0), (0.025, -0.0105, 0.0)),
        LinePiece((0.05, 0.0, 0.0), (0.05, 0.05, 0.0), (0.0395, 0.025, 0.0)),
    ),
    UP,
)
LEANING = CentreLine(BENT.pieces, (0.5, 1.0, 1.0))
SHORT = CentreLine(
    (
        LinePiece((0.0, 0.0, 0.0), (0.0, 0.5, 0.0)),
        LinePiece((0.0, 0.5, 0.0), (0.05, 0.5, 0.0)),
        LinePiece((0.05, 0.5, 0.0), (0.05, 0.0, 0.0)),
    ),
    UP,
)
TAPERS = {
    "rectangle": (Rectangle(0.10, 0.06), Rectangle(0.05, 0.08)),
    "hollow-rectangle": (HollowRectangle(0.10, 0.08, 0.008), HollowRectangle(0.06, 0.08, 0.004)),
    "i-section": (ISection(0.08, 0.10, 0.008, 0.006), ISection(0.06, 0.07, 0.004, 0.006)),
    "channel": (Channel(0.05, 0.10, 0.008, 0.006), Channel(0.04, 0.07, 0.006, 0.005)),
}


def tapered(line, first, last, material=STEEL):
    return LineLeg(line, ((0.0, first), (line.length, last)), material)


def stepped(first, second, last=None):
    """Return a straight leg with a step at 0.4 m, and a taper to `last` beyond it."""
    stations = ((0.0, first), (0.4, first), (0.4, second), (1.0, last or second))
    return LineLeg(STRAIGHT, stations, STEEL)


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


@pytest.mark.parametrize("shape", [*TAPERS, "tube"])
def test_mitred_leg_passes_patch_test(shape):
    """Mitres cut as much off one side as they add on the other, and elements are conforming.

    A linear displacement has the energy of its constant stresses in the volume of the leg. The tube
    turns out of the plane of its first corner, with `up` inclined to both planes.
    """
    section, line, divisions = TAPERS.get(shape, (None,))[0], BENT, 1
    if shape == "tube":
        section, divisions = Tube(0.06, 0.01), 4
        points = [(0.0, 0.0, 0.0), (0.4, 0.2, 0.0), (0.6, 0.0, 0.3), (1.0, 0.0, 0.0)]
        pieces = tuple(LinePiece(*ends) for ends in pairwise(points))
        line = CentreLine(pieces, (0.2, 0.3, 1.0))
    leg = LineLeg(line, ((0.0, section), (line.length, section)), STEEL)
    # The cross-section of a tube is that of its mesh.
    assert_patch(leg, divisions, 3e-3 if shape == "tube" else 1e-10)


@pytest.mark.parametrize("line", [ARC_TO_CORNER, TWO_ARCS])
@pytest.mark.parametrize("section", [Rectangle(0.08, 0.06), Tube(0.06, 0.01)])
def test_mitred_arc_passes_patch_test(line, section):
    """The mitre of an arc cuts off as much as it adds, and elements are conforming.

    All planes are plane and centred on the line. The arc has a chord of ten heights.
    """
    is_round = isinstance(section, Tube)
    divisions, error = (4, 3e-3) if is_round else (1, 1e-6)
    corner = line.corners[0] * (1.0 + 1e-15)
    stations = ((0.0, section), (corner, section), (line.length, section))
    assert_patch(LineLeg(line, stations, STEEL), divisions, error, 24)


STEPS = {
    "overlapping rectangles": (Rectangle(0.08, 0.06), Rectangle(0.06, 0.08), 2),
    "box onto solid": (HollowRectangle(0.08, 0.08, 0.008), Rectangle(0.07, 0.06), 2),
    "I onto channel": (ISection(0.08, 0.1, 0.008, 0.006), Channel(0.05, 0.1, 0.008, 0.006), 2),
    "tube onto circle": (Tube(0.06, 0.01), Circle(0.05), 4),
    "tubes": (Tube(0.06, 0.01), Tube(0.05, 0.01), 4),
    "tube onto plate": (Tube(0.06, 0.01), Rectangle(0.1, 0.08), 4),
    "tube through walls of box": (Tube(0.14, 0.01), HollowRectangle(0.15, 0.15, 0.01), 4),
    "circle across sides": (Circle(0.068), Rectangle(0.06, 0.06), 4),
    "circle through corners": (Circle(0.05), Rectangle(0.04, 0.03), 4),
}


@pytest.mark.parametrize("step", STEPS)
def test_stepped_leg_passes_patch_test(step):
    """Both sides of a step have common nodes; each section has its own area.

    The ends are the sections' meshes, and twists of sections are those of rigid motions.
    """
    first, second, divisions = STEPS[step]
    leg = stepped(first, second)
    mesh = assert_patch(leg, divisions, 1e-3 if isinstance(first, Circle | Tube) else 1e-10)
    for face, section in ((mesh.root, first), (mesh.tip, second)):
        assert np.ptp(face.mesh.nodes, axis=0) == pytest.approx(section.extent, rel=1e-9)
    motions = section_twists(mesh, mesh.positions) @ rigid_motions(mesh.nodes, np.zeros(3))
    points, _ = mesh.line.frames(mesh.positions)
    assert motions == pytest.approx(shift(points).reshape(-1, 6), abs=1e-10)


TAPERED_STEPS = {
    # Sections at both ends of each of three tapers.
    "rectangles": (
        (Rectangle(0.06, 0.08), Rectangle(0.04, 0.08)),
        (Rectangle(0.08, 0.06), Rectangle(0.05, 0.09)),
        (Rectangle(0.03, 0.03), Rectangle(0.06, 0.06)),
    ),
    "boxes and I-section": (
        (HollowRectangle(0.08, 0.1, 0.01), HollowRectangle(0.06, 0.1, 0.01)),
        (ISection(0.06, 0.1, 0.01, 0.02), ISection(0.08, 0.06, 0.01, 0.02)),
        (Rectangle(0.06, 0.06), Rectangle(0.05, 0.06)),
    ),
    "tubes and shaft": (
        (Tube(0.06, 0.01), Tube(0.05, 0.01)),
        (Circle(0.05), Circle(0.04)),
        (Tube(0.04, 0.01), Tube(0.03, 0.005)),
    ),
    "cone, box and tapered shaft": (
        (Circle(0.05), Circle(0.068)),
        (Rectangle(0.06, 0.06), Rectangle(0.06, 0.06)),
        (Tube(0.068, 0.014), Tube(0.056, 0.01)),
    ),
}


@pytest.mark.parametrize("shapes", TAPERED_STEPS)
def test_steps_between_tapers_pass_patch_test(shapes):
    """Edges of later sections are lines of the mesh at the root, moved by the tapers between."""
    sections = list(chain.from_iterable(TAPERED_STEPS[shapes]))
    stations = zip((0.0, 0.3, 0.3, 0.6, 0.6, 1.0), sections, strict=True)
    leg = LineLeg(STRAIGHT, tuple(stations), STEEL)
    is_round = isinstance(sections[0], Circle | Tube)
    # Parabolas instead of arcs.
    mesh = assert_patch(leg, 4 if is_round else 2, 1e-3 if is_round else 1e-10, 12)
    for face, section in ((mesh.root, sections[0]), (mesh.tip, sections[-1])):
        assert np.ptp(face.mesh.nodes, axis=0) == pytest.approx(section.extent, rel=1e-9)


def assert_patch(leg, divisions, mass_error, slices=6):
    """Assert that a linear displacement has the energy of its constant stresses. Return the mesh.

    `mass_error` is the relative error of the mass of the mesh.
    """
    mesh = loft(leg, divisions, slices)
    stiffness, mass = stiffness_and_mass(mesh, STEEL)
    volume = mass.sum() / STEEL.rho
    assert volume * STEEL.rho == pytest.approx(leg.mass, rel=mass_error)
    gradient = np.array([[1.0, 0.3, -0.2], [0.5, -0.4, 0.7], [0.1, 0.2, 0.6]])
    displacement = (mesh.nodes @ gradient.T).ravel()
    strain = 0.5 * (gradient + gradient.T)
    lame = STEEL.E * STEEL.nu / ((1.0 + STEEL.nu) * (1.0 - 2.0 * STEEL.nu))
    density = lame * np.trace(strain) ** 2 + 2.0 * STEEL.G * (strain**2).sum()
    energy = float(displacement @ (stiffness @ displacement))
    assert energy == pytest.approx(volume * density, rel=1e-9)
    return mesh


def test_unmeshable_leg_along_line_is_refused():
    """Section by constants, corners, jumps, and a tapered polygon, each with its reason."""
    square, small = Rectangle(0.06, 0.06), Rectangle(0.04, 0.04)
    constants = SectionProperties(1e-3, 1e-7, 1e-7, 1e-7)
    cubic = Material(E=2.1e11, G=9e10, nu=0.3, rho=7850.0)
    triangle = [Polygon(((0.0, 0.0), (size, 0.0), (0.0, size))) for size in (0.06, 0.05)]
    positions, between = (0.0, 0.3, 0.3, 0.6, 0.6, 1.0), [Circle(0.05)] * 2 + [square, small]
    between += [Circle(0.05)] * 2
    reasons = {
        "no shape": tapered(STRAIGHT, constants, constants),
        "mitres of corners are longer than the inner side": tapered(TIGHT, square, square),
        "`up` is neither in its plane nor in the plane that": tapered(LEANING, square, square),
        "mitres of corners are longer than": tapered(SHORT, square, square),
        "a step between channel, circle has no mesh": stepped(TAPERS["channel"][0], Circle(0.05)),
        "nearly touch each other, so that": stepped(square, Circle(0.0597)),
        "a taper between two steps of circle, rectangle has no mesh": LineLeg(
            STRAIGHT, tuple(zip(positions, between, strict=True)), STEEL
        ),
        "a step between rectangle, polygon has no mesh: not all": stepped(square, triangle[0]),
        "the step at 0.4 m along the line do not touch": stepped(
            HollowRectangle(0.06, 0.06, 0.005), small
        ),
        "independent G": tapered(ARC, square, square, cubic),
        "tapered polygon": tapered(STRAIGHT, *triangle),
    }
    for reason, leg in reasons.items():
        assert reason in why_no_loft(leg)
        with pytest.raises(InputError, match="a leg: "):
            loft(leg, 1, 4)
    assert why_no_loft(tapered(ARC, square, small)) == ""
    assert why_no_loft(stepped(square, Circle(0.06))) == ""
    assert why_no_loft(stepped(square, small, Rectangle(0.04, 0.03))) == ""
    assert why_no_loft(tapered(STRAIGHT, square, small, cubic)) == ""
