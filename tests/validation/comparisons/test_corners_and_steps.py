"""Legs with corners and steps: difference of beam and solid, exponent and cause, wrong beams."""

from dataclasses import replace

import numpy as np
import pytest

from fem.beams.line_beam import line_beam
from fem.beams.tapered_flanges import flange_work
from fem.bodies.solid import clamped_leg, section_twists, solid_leg, solid_mesh
from fem.couplings.grips import rigid_motions
from lumped.acceptance.requirement import DEFAULT_LIMITS
from lumped.centre_line import CentreLine, LinePiece, straight_line
from lumped.legs import ConstantLeg, LineLeg, Material, given_compliance
from lumped.models.bodies import clamped_modes
from lumped.robot_file.load import robot_of
from lumped.screws import shift, skew
from lumped.sections import Circle, HollowRectangle, ISection, Rectangle
from meshes.gmsh_session import connectivity, gmsh_model, numbered
from meshes.section.section_mesh import SectionMesh, counter_clockwise
from meshes.solid_mesh import EndFace, SolidMesh
from validation.comparisons import line_leg_vs_solid
from validation.comparisons.line_leg_vs_solid import cases
from validation.context import Context
from validation.models.leg_models import leg_compliance
from validation.references.corners_and_steps import (
    CORNERS,
    STEPS,
    frequency_changes,
    jumps,
    sections_with_jumps,
    tip_changes,
    tip_half_widths,
)
from validation.references.modal_reference import modal_steps
from validation.references.model_ladder import SOLID, WARPING_BEAMS, WITH_JUMPS
from validation.references.robot_on_path import robot_on_path
from validation.report.figures.loads_and_responses import figures
from validation.run.outcome import judge
from validation.solids.leg_meshes import formal_order, notch_order
from validation.solids.line_beams import computed_along, computed_tip, wall_distortion
from validation.solids.solid_legs import line_frequencies

STEEL = Material.isotropic(E=2.1e11, nu=0.3, rho=7850.0)
SECTION = Rectangle(0.06, 0.06)


def bent(length, degrees, section=SECTION):
    """Return a leg of two pieces of `length` (m), the second turned by `degrees` about z."""
    half = np.radians(degrees) / 2.0
    chord, rise = 2.0 * length * np.cos(half), length * np.sin(half)
    middle = (chord / 2.0, rise, 0.0)
    pieces = LinePiece((0.0, 0.0, 0.0), middle), LinePiece(middle, (chord, 0.0, 0.0))
    line = CentreLine(pieces, (0.0, 0.0, 1.0))
    return LineLeg(line, ((0.0, section), (line.length, section)), STEEL, "free")


def straight_step(first, second, length):
    """Return a straight leg with a step between two pieces of `length` (m)."""
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (2.0 * length, 0.0, 0.0)),), (0.0, 0.0, 1.0))
    stations = ((0.0, first), (length, first), (length, second), (2.0 * length, second))
    return LineLeg(line, stations, STEEL, "free")


def solid_tip(leg, divisions=1):
    return clamped_leg(solid_leg(leg, solid_mesh(leg, divisions)), "free").compliance


def test_flat_corner_gives_prism():
    """A corner of 0.2° changes the solid of a prism as its beam, up to the square of the angle."""
    leg, prism = bent(0.3, 0.2), ConstantLeg(0.6, SECTION, STEEL)
    expected = solid_tip(prism)
    of_beam = given_compliance(leg) - given_compliance(prism)
    difference = solid_tip(leg) - expected - of_beam
    sizes = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    # The chord lies beside the line: in tension the beam's change is 3e-4.
    assert np.abs(np.diag(of_beam) / np.diag(expected)).max() > 2e-4
    assert np.abs(np.diag(difference) / np.diag(expected)).max() < 1e-5
    # Tension of the chord is coupled with bending in first order of the angle, 3.5e-3.
    assert np.abs(difference / sizes).max() < 1e-3


def test_difference_of_corner_falls_with_length():
    """Beam theory is too soft in the corner by an amount that does not depend on the length.

    Relative to the tip compliance it is of first order in h/L: doubling L halves it. The solid of
    the corner alone explains more than nine tenths of it.
    """
    differences, rests = [], []
    for length in (0.6, 1.2):
        leg = bent(length, 90.0)
        beam = computed_tip(leg, 1)
        solid, change = solid_tip(leg), tip_changes(leg, 1)[CORNERS]
        differences.append(np.diag(solid) / np.diag(beam) - 1.0)
        rests.append(np.diag(solid) / np.diag(beam + change) - 1.0)
    # Tension of the chord bends both pieces most at the corner.
    assert -0.11 < differences[0][0] < -0.09
    exponents = np.log2(differences[0] / differences[1])
    assert exponents == pytest.approx(1.0, abs=0.12)
    assert (np.abs(rests[0]) < 0.13 * np.abs(differences[0])).all()


@pytest.mark.parametrize(("thickness", "left"), [(0.004, 0.006), (0.002, 0.02)])
def test_corner_of_tube_explains_distortion(thickness, left):
    """Walls of a mitred square tube bend near the corner, far into the arms of the frame.

    With walls of 4 mm they are 23 % of the motion across the plane. A stub of two heights explains
    26 % (the walls bend at its free ends), one of four 23.6 %. The half-width covers the rest.
    """
    leg = bent(0.3, 90.0, HollowRectangle(0.06, 0.06, thickness))
    beam, solid = computed_tip(leg, 1)[2, 2], solid_tip(leg)[2, 2]
    change, half_width = tip_changes(leg, 1)[CORNERS][2, 2], tip_half_widths(leg, 1)[2]
    assert solid / beam > 1.2
    rest = solid - beam - change
    assert abs(rest) < left * solid
    assert abs(rest) < half_width < 0.5 * change
    # Nothing is known of a corner whose arms are shorter than long stubs, solid sections apart.
    short = bent(0.2, 90.0, HollowRectangle(0.06, 0.06, thickness))
    assert tip_half_widths(short, 1)[2] == pytest.approx(tip_changes(short, 1)[CORNERS][2, 2])
    assert not tip_half_widths(bent(0.3, 90.0), 1).any()


def test_difference_of_step_falls_with_length():
    """A step is softer than its beam, since stresses spread into the thicker side over its height.

    Doubling the length halves the relative difference: in the limit, compliances are those of two
    prisms in series. Torsion (entry 3) is stiffer, because each side hinders the other's warping.
    """
    thick, thin = Rectangle(0.08, 0.06), Rectangle(0.04, 0.06)
    others = [0, 1, 2, 4, 5]
    differences, rests = [], []
    for length in (0.25, 0.5):
        leg = straight_step(thick, thin, length)
        beam, solid = computed_tip(leg, 1), solid_tip(leg)
        differences.append(np.diag(solid) / np.diag(beam) - 1.0)
        rests.append(np.diag(solid) / np.diag(beam + tip_changes(leg, 1)[STEPS]) - 1.0)
    assert (differences[0][others] > 0.018).all()
    assert -0.005 < differences[0][3] < -0.002
    assert np.log2(differences[0] / differences[1]) == pytest.approx(1.0, abs=0.12)
    assert (np.abs(rests[0][others]) < 0.05 * differences[0][others]).all()


def test_difference_of_step_between_tapers_falls_with_length():
    """A taper, a step and a further taper: the step alone explains the difference, as of prisms.

    Doubling the length halves what beam and solid differ by, and a tenth of it is left.
    """
    tapers = [Rectangle(width, 0.06) for width in (0.08, 0.06, 0.04, 0.03)]
    differences = []
    for length in (0.4, 0.8):
        line = CentreLine((LinePiece((0.0, 0.0, 0.0), (length, 0.0, 0.0)),), (0.0, 0.0, 1.0))
        positions = (0.0, 0.5 * length, 0.5 * length, length)
        leg = LineLeg(line, tuple(zip(positions, tapers, strict=True)), STEEL, "free")
        beam = computed_tip(leg, 1)
        solid, change = np.diag(solid_tip(leg, 1)), np.diag(tip_changes(leg, 1)[STEPS])
        differences.append(solid / np.diag(beam) - 1.0)
        rest = solid / (np.diag(beam) + change) - 1.0
        # Bending about z: the step is in the width.
        assert abs(rest[5]) < 0.15 * abs(differences[-1][5])
    assert differences[0][5] > 0.005
    assert np.log2(differences[0][5] / differences[1][5]) == pytest.approx(1.0, abs=0.15)


@pytest.mark.parametrize(
    ("length", "sections", "effect"),
    [
        (
            0.7,
            [ISection(0.08, height, 0.008, 0.008) for height in (0.1, 0.07)]
            + 2 * [ISection(0.08, 0.07, 0.012, 0.008)],
            -0.195,
        ),
        (
            0.4,
            [HollowRectangle(0.1, height, 0.006) for height in (0.1, 0.06)]
            + 2 * [HollowRectangle(0.1, 0.06, 0.012)],
            0.217,
        ),
    ],
    ids=["flanges", "walls"],
)
def test_torsion_of_taper_at_step_counts_once(length, sections, effect):
    """A taper before a step in torsion: its flanges or distorted walls change the tip by a fifth.

    The stubs are as long as the leg, and their solid has this change, too. It belongs to the taper.
    """
    positions = (0.0, 0.5 * length, 0.5 * length, length)
    leg = LineLeg(straight_line(length), tuple(zip(positions, sections, strict=True)), STEEL)
    beam = computed_tip(leg, 1)[3, 3]
    taper = flange_work(leg, np.ones_like) + wall_distortion(leg, 1)
    assert taper / beam == pytest.approx(effect, abs=1e-3)
    assert abs(tip_changes(leg, 1)[STEPS][3, 3]) < 0.005 * beam


def test_step_from_square_to_round_explains_difference():
    """Round bar of 48 mm on a square one of 60 mm: the beam is 0.9 to 2.2 % too stiff."""
    leg = straight_step(Rectangle(0.06, 0.06), Circle(0.048), 0.12)
    beam, solid = np.diag(computed_tip(leg, 2)), np.diag(solid_tip(leg, 2))
    change = np.diag(tip_changes(leg, 2)[STEPS])
    assert (solid / beam - 1.0 > 0.01).all()
    assert (np.abs(solid - beam - change) < 0.03 * (solid - beam)).all()


def test_square_and_round_bar_of_equal_area_lie_between_prisms():
    """A square bar with a round one of equal area: bending and torsion between both prisms'."""
    square, disc = Rectangle(0.06, 0.06), Circle(0.06 * np.sqrt(4.0 / np.pi))
    solid = np.diag(solid_tip(straight_step(square, disc, 0.07), 2))
    first, second = (
        np.diag(given_compliance(ConstantLeg(0.14, section, STEEL))) for section in (square, disc)
    )
    lower, upper = np.minimum(first, second), np.maximum(first, second)
    # The corners of the square, which stick out at the step, are 0.6 % of the tension.
    assert solid[0] == pytest.approx(first[0], rel=0.01)
    assert (lower[1:] < solid[1:]).all()
    assert (solid[1:] < upper[1:]).all()


def fused_bars(width, height, diameter, length):
    """Return a mesh of 10-node tetrahedra of a box and a cylinder fused by the CAD kernel."""
    with gmsh_model("fused bars") as gmsh:
        occ, half = gmsh.model.occ, length / 2.0
        box = occ.addBox(0.0, -width / 2.0, -height / 2.0, half, width, height)
        cylinder = occ.addCylinder(half, 0.0, 0.0, half, 0.0, 0.0, diameter / 2.0)
        occ.fuse([(3, box)], [(3, cylinder)])
        occ.synchronize()
        field = gmsh.model.mesh.field
        size = field.add("MathEval")
        field.setString(size, "F", f"0.01 + 0.01*Min(1, Abs(x - {half})/0.03)")
        field.setAsBackgroundMesh(size)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        tagged = connectivity(gmsh, "tet10")
        tags, nodes = numbered(gmsh, tagged)
        ends = []
        for x in (0.0, length):
            box = (x - 1e-6, -1.0, -1.0, x + 1e-6, 1.0, 1.0)
            ((_, face),) = gmsh.model.getEntitiesInBoundingBox(*box, 2)
            ends.append(np.searchsorted(tags, connectivity(gmsh, "tri6", face)))
    faces = []
    for triangles, x in zip(ends, (0.0, length), strict=True):
        numbers, local = np.unique(triangles, return_inverse=True)
        nodes[numbers, 0] = x
        cells = counter_clockwise(nodes[numbers, 1:], local.reshape(triangles.shape), "tri6")
        faces.append(EndFace(numbers, SectionMesh(nodes[numbers, 1:], cells, "tri6")))
    return SolidMesh(nodes, np.searchsorted(tags, tagged), "tet10", *faces, slices=None)


def test_round_bar_on_rectangular_bar_equals_fused_tetrahedra():
    """Disc across the sides of a rectangle: hexahedra of one mesh, and tetrahedra of a CAD union.

    The step softens bending and tension by 1 to 3 %. Both solids agree within 0.2 %, in torsion
    within 0.3 %.
    """
    leg = straight_step(Rectangle(0.06, 0.045), Circle(0.055), 0.1)
    tetrahedra = clamped_leg(solid_leg(leg, fused_bars(0.06, 0.045, 0.055, 0.2)), "free")
    solid, other = np.diag(solid_tip(leg, 2)), np.diag(tetrahedra.compliance)
    beam = np.diag(computed_tip(leg, 2))
    assert (solid / beam - 1.0)[[0, 1, 2, 4, 5]].min() > 9e-3
    assert np.abs(solid / other - 1.0)[[0, 1, 2, 4, 5]].max() < 2e-3
    assert solid[3] == pytest.approx(other[3], rel=3e-3)


def test_orders_of_corners():
    """Williams: 0.5445 at 270°, ½ for a crack; a flat edge is regular."""
    assert notch_order(1.5 * np.pi) == pytest.approx(2.0 * 0.5445, abs=1e-4)
    assert notch_order(1.99 * np.pi) == pytest.approx(1.0, abs=1e-3)
    assert formal_order(bent(0.6, 90.0), "free") == pytest.approx(1.0890, abs=1e-4)
    assert formal_order(bent(0.6, 0.0), "free") == 4.0


def test_short_piece_has_no_computed_corner():
    """The stress field of the corner would reach the ends of the leg: nothing is explained."""
    assert jumps(bent(0.11, 90.0), 1) == []


def test_section_twist_at_mitre_is_rigid_motion():
    """If a leg with a corner moves rigidly, the twist of each plane of nodes is that motion."""
    mesh = solid_mesh(bent(0.4, 90.0), 1)
    motions = section_twists(mesh, mesh.positions) @ rigid_motions(mesh.nodes, np.zeros(3))
    points, _ = mesh.line.frames(mesh.positions)
    assert motions == pytest.approx(shift(points).reshape(-1, 6), abs=1e-12)


def cantilever(points, sections, **body):
    """Return a robot of one leg along a line, clamped at A, with its tool at B."""
    return robot_of(
        {
            "schema": 2,
            "name": "frame",
            "points": points,
            "bodies": {
                "frame": {
                    "from": "A",
                    "to": "B",
                    "sections": sections,
                    "material": {"E": 2.1e11, "nu": 0.3, "rho": 7850.0},
                    "ends": "rigid",
                    **body,
                }
            },
            "joints": {"root": {"type": "fixed", "between": ["ground", "frame"], "at": "A"}},
            "tool": {"body": "frame", "point": "B", "moves": []},
        }
    )


def rectangle(at, width, height):
    return {"at": at, "shape": "rectangle", "width": width, "height": height}


FRAME = cantilever(
    {"A": [0.0, 0.0, 0.0], "K": [0.4, 0.0, 0.0], "B": [0.4, 0.3, 0.0]},
    [rectangle(at, 0.05, 0.06) for at in (0.0, 1.0)],
    through=["K"],
)
# An arc of 30° and 0.2 m radius, seven heights in radius, and a straight piece turned by 60° more.
ARCHED = cantilever(
    {
        "A": [0.0, 0.0, 0.0],
        "M": [0.051763809, 0.006814835, 0.0],
        "K": [0.1, 0.026794919, 0.0],
        "B": [0.1, 0.106794919, 0.0],
    },
    [rectangle(at, 0.03, 0.03) for at in (0.0, 1.0)],
    through=[{"arc": "M"}, "K"],
)
STEPPED = cantilever(
    {"A": [0.0, 0.0, 0.0], "B": [0.5, 0.0, 0.0]},
    [rectangle(at, 0.06, 0.08) for at in (0.0, 0.4)]
    + [rectangle(at, 0.05, 0.05) for at in (0.4, 1.0)],
)


# Contexts by the identity of the robot and the preset: the solids of a robot are solved once.
CONTEXTS = {}


def outcome_of(robot, name, preset):
    """Return the outcome of a comparison of a robot's leg with its solid."""
    listed = {case.id: case for case in cases(mechanism=robot.mechanism, limits=DEFAULT_LIMITS)}
    case = listed[f"frame.agrees[{name}]"]
    context = CONTEXTS.setdefault((id(robot), preset), Context(robot, preset))
    return judge(case, case.measure(context), 0.0)


@pytest.mark.parametrize(
    ("robot", "name", "preset", "cause", "share"),
    [
        (FRAME, "f3", "quick", CORNERS, 0.0016),
        (STEPPED, "f2", "quick", STEPS, 0.0155),
        (ARCHED, "x", "standard", CORNERS, 0.1012),
        (FRAME, "x", "standard", CORNERS, 0.0960),
    ],
)
def test_corner_and_step_explain_difference(robot, name, preset, cause, share):
    """A frame seven sections long: the corner is 10 % of x, and less than 0.1 % is left.

    So it is at the end of an arc. In f3 the mass beside the line at the corner, 1.3 %, outweighs
    the corner's stiffness.
    """
    outcome = outcome_of(robot, f"beam-solid-{name}", preset)
    amounts = {entry.cause: entry.amount for entry in outcome.measurement.allowances}
    reference = outcome.measurement.reference
    assert amounts[cause] == pytest.approx(share * reference, rel=0.05)
    assert abs(outcome.measurement.unexplained) < 1e-3 * reference
    assert outcome.verdict == "agree"


@pytest.mark.parametrize(
    ("robot", "wrong", "name"),
    [
        (FRAME, {"G": 1.1}, "z"),
        (FRAME, {"G": 0.9}, "φx"),
        (FRAME, {"E": 1.05}, "x"),
        (FRAME, {"E": 1.05}, "φz"),
        (ARCHED, {"E": 1.05}, "x"),
        (ARCHED, {"E": 1.05}, "φz"),
    ],
)
def test_corner_explains_no_wrong_stiffness(robot, wrong, name, monkeypatch):
    """A beam with J × 1.1, × 0.9 (by G) or EI × 1.05 (by E) disagrees at a corner."""

    def compliance(model, leg, options):
        moduli = {key: factor * getattr(leg.material, key) for key, factor in wrong.items()}
        wrong_leg = replace(leg, material=replace(leg.material, **moduli))
        return leg_compliance(model, wrong_leg, options)

    monkeypatch.setattr(line_leg_vs_solid, "leg_compliance", compliance)
    assert outcome_of(robot, f"beam-solid-{name}", "standard").verdict == "disagree"


@pytest.mark.parametrize("section", [SECTION, HollowRectangle(0.06, 0.06, 0.004)])
def test_beam_with_corner_vibrates_as_solid(section):
    """The corner's compliance over its stubs: statics exactly, frequencies as those of the solid.

    The beam alone has frequencies 12.7 % below and 8 % above those of the two solids.
    """
    leg = bent(0.3, 90.0, section)
    beam_sections = computed_along(leg, 1)
    sections = sections_with_jumps(beam_sections, leg, 1)
    tip = beam_sections.tip_compliance + tip_changes(leg, 1)[CORNERS]
    assert sections.tip_compliance == pytest.approx(tip, rel=1e-9, abs=1e-12 * np.abs(tip).max())
    beam, with_corner = (
        clamped_modes(line_beam(along, 20), 4).frequencies for along in (beam_sections, sections)
    )
    solid = line_frequencies(leg, 1, "free", line_beam(beam_sections, 20), 4)
    assert np.abs(solid / beam - 1.0).max() > 0.07
    assert np.abs(solid / with_corner - 1.0).max() < 2.5e-3
    changes, _ = frequency_changes(leg, 1, 4)
    assert changes[CORNERS] == pytest.approx(with_corner / beam - 1.0, rel=1e-6)
    # The mass beside the line is the same for both.
    ends = np.array([0.0, leg.line.length])
    (difference,) = sections.masses(ends, np.zeros((1, 3))) - beam_sections.masses(
        ends, np.zeros((1, 3))
    )
    (jump,) = jumps(leg, 1)
    assert difference[:3, :3] == pytest.approx(0.0, abs=1e-12)
    assert difference[3:, :3] == pytest.approx(skew(jump.first_moment), abs=1e-12)


def test_corner_is_step_to_modes_of_solid_robot():
    """The corner explains 6 % of the robot's frequencies.

    What is left is below the square of half the height over the arc's radius, which beam theory
    neglects.
    """
    body = {**ARCHED.tables["bodies"]["frame"], "ends": "free"}
    context = Context(robot_of({**ARCHED.tables, "bodies": {"frame": body}}), "quick")
    robot = robot_on_path(context)
    beam, jump, solid = (
        model.modes(robot, robot.first_reading).frequencies[0, :4]
        for model in (WARPING_BEAMS, WITH_JUMPS, SOLID)
    )
    assert "jumps" in modal_steps(robot, WITH_JUMPS, WITH_JUMPS)
    assert np.abs(solid / beam - 1.0).max() > 0.05
    assert np.abs(solid / jump - 1.0).max() < (0.5 * 0.03 / 0.2) ** 2


def test_leg_in_single_pose_has_force_figure():
    """The figure shows section forces along bent and straight legs."""
    loads = [{"name": "push", "wrench": [100.0, 0.0, 0.0, 0.0, 0.0, 0.0]}]
    names = [
        [figure.id for figure in figures(robot_of({**robot.tables, "loads": loads}))]
        for robot in (FRAME, STEPPED)
    ]
    assert names == [["mechanism.forces.push"], ["mechanism.forces.push"]]
