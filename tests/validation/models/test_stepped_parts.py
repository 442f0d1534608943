"""CAD parts as stepped legs: a hollow wedge against its sections, and a channel."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import quad
from support.oracles.compliance_difference import scaled_difference
from support.robots.crane import write_overlapping_crane
from support.robots.drawn_parts import meshed, plane_ends, written

from lumped.errors import InputError
from lumped.legs import Material
from lumped.mechanism.body import Body, Frame, Part
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.mechanism.placing import leg_frame
from lumped.robot_file import load_robot
from lumped.screws import shift
from validation.adequacy.judged_models import JUDGED, why_unable
from validation.models import reduced_parts
from validation.models.leg_models import leg_matrices
from validation.models.options import ModelOptions
from validation.models.part_legs import placed_leg
from validation.models.robot_models import answers
from validation.models.stepped_parts import stepped
from validation.references.reference_parts import part_kinds

pytestmark = pytest.mark.usefixtures("coarse_parts")
STEEL = Material.isotropic(2.1e11, 0.3, 7850.0)


def body_of(file, length, coupling=None, unit="mm"):
    """CAD part with two plane ends, `length` (m) apart along x."""
    points = {"A": Frame(), "B": Frame(np.array([length, 0.0, 0.0]))}
    return Body("arm", Part(file, STEEL, plane_ends(length, coupling), unit), points)


def test_channel_twists_about_shear_centre(tmp_path):
    """Channel of 60 × 40 mm, 300 mm long, 8 mm thick, open along y.

    A force along z on its web twists it. Ends are coupled by averages and free to warp, so that
    only Saint-Venant's torsion occurs.
    """

    def draw(occ):
        outer, inner = occ.addBox(0, 0, -30, 300, 40, 60), occ.addBox(-10, 8, -22, 320, 40, 44)
        occ.cut([(3, outer)], [(3, inner)])

    channel = body_of(written(tmp_path / "channel.step", draw), 0.3, "average", None)
    identified, leg = reduced_parts.identified(channel, 6_000, 0), stepped(channel, 4)
    scale = np.sqrt(np.diag(identified.compliance))
    unit = np.outer(scale, scale)

    def distance(leg):
        return (compliance(leg) - identified.compliance) / unit

    # Thin walls: e = 3b²t/(h t + 6 b t) behind the back's middle, b and h between walls' middles.
    b, h = 0.036, 0.052
    (piece, *_) = leg.pieces
    beam = piece.properties
    shear_centre = piece.start[1:] + piece.axes[1:, 1:] @ np.array([beam.centre_y, beam.centre_z])
    assert shear_centre == pytest.approx([0.004 - 3.0 * b**2 / (h + 6.0 * b), 0.0], abs=1.5e-3)
    # What the solid's mesh of walls leaves open, in torsion most; and 0.3 % where forces enter
    # evenly instead of as shear flows. Moments that do bend the walls at the ends.
    stated = identified.compliance_refinement / unit
    stated[3, 3] = 0.05
    assert (np.abs(distance(leg)) <= stated + 3e-3).all()
    # The twist under that force is no small part.
    assert abs(identified.compliance[3, 2]) > 0.2 * unit[3, 2]
    centred = replace(beam, centre_y=0.0, centre_z=0.0)
    about_centroid = [replace(piece, properties=centred) for piece in leg.pieces]
    wrong = distance(replace(leg, pieces=tuple(about_centroid)))
    assert abs(wrong[3, 2]) > 5.0 * abs(distance(leg)[3, 2])


def test_part_without_pieces_has_reason(tmp_path):
    """Interfaces that overlap along the line between them; the condensed model remains."""
    write_overlapping_crane(tmp_path)
    mechanism = load_robot(tmp_path / "robot.toml").mechanism
    part_posture = posture(mechanism, mechanism.poses[0])
    why = why_unable((part_posture,), JUDGED["segments-stepped"])
    assert why.startswith(
        "bodies.arm: the interfaces of the part overlap along the line between them"
    )
    assert why_unable((part_posture,), JUDGED["segments-condensed"]) == ""
    assert part_kinds(mechanism) == ("condensed",)


def bar(occ, width=60, height=40, begin=0, end=400):
    return 3, occ.addBox(begin, -width / 2, -height / 2, end - begin, width, height)


def bore(occ, x, radius, along="z"):
    extent = [200 if along == axis else 0 for axis in "xyz"]
    start = [x - extent[0] / 2, -extent[1] / 2, -extent[2] / 2]
    return 3, occ.addCylinder(*start, *extent, radius)


def tube(occ):
    return occ.cut([bar(occ)], [bar(occ, 48, 28, -10, 410)])[0]


# Outer sections of 60 × 40 mm, 400 mm long, ten pieces of 40 mm: stations at 20, 60, 100, ...
REFUSED = {
    "a hole through both flanges, between stations": (
        lambda occ: occ.cut(tube(occ), [bore(occ, 200, 12)]),
        r"section 0\.\d* m from the first interface consists of 2 separate areas",
    ),
    "a hole in one flange opens the tube": (
        lambda occ: occ.cut(tube(occ), [(3, occ.addCylinder(180, 0, 0, 0, 0, 50, 15))]),
        r"area inside the outline is \d[.\d]* times smaller than that of",
    ),
    "a neck": (
        lambda occ: occ.fuse(
            [bar(occ, end=180), bar(occ, begin=200)], [bar(occ, 30, 40, 170, 210)]
        ),
        r"second moment of area is 4.5 times smaller than that of cross-sections within 0\.02 m",
    ),
    "a collar at a station": (
        lambda occ: occ.fuse([bar(occ)], [bar(occ, 90, 70, 175, 185)]),
        r"0\.18 m from the first interface is not prismatic: "
        r"its second moment of area is [\d.]+ times larger",
    ),
}
# And their smaller area (m²).
PRISMS = {
    "a step at a station": (
        lambda occ: occ.fuse([bar(occ, end=180)], [bar(occ, 40, 30, begin=180)]),
        1200e-6,
    ),
    "compartments longer than the section": (
        lambda occ: occ.cut([bar(occ)], [bar(occ, 48, 28, 82, 198), bar(occ, 48, 28, 206, 370)]),
        2400e-6 - 48e-3 * 28e-3,
    ),
}


def hollow_wedge(occ):
    """Draw a wedge 400 × 40 mm, 60 to 40 mm high, with a hole of 20 × 16 mm along it."""
    corners = [(0, -30), (400, -20), (400, 20), (0, 30)]
    points = [occ.addPoint(x, -20, z) for x, z in corners]
    lines = [occ.addLine(points[i], points[(i + 1) % 4]) for i in range(4)]
    face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    solid = [entity for entity in occ.extrude([(2, face)], 0, 40, 0) if entity[0] == 3]
    occ.cut(solid, [(3, occ.addBox(-400, -10, -8, 1200, 20, 16))])
    occ.remove([(2, face)], recursive=True)


@pytest.mark.parametrize(("draw", "why"), REFUSED.values(), ids=REFUSED)
def test_section_varying_along_part_is_refused(tmp_path, draw, why):
    """Holes, a neck or a collar within one piece: one line with the position of the section."""
    with pytest.raises(InputError, match=why) as error:
        stepped(body_of(meshed(tmp_path / "part.msh", draw, 20.0, 12.0), 0.4))
    (line,) = error.value.faults
    assert line.startswith("bodies.arm: the cross-section 0.")


@pytest.mark.parametrize(("draw", "remaining"), PRISMS.values(), ids=PRISMS)
def test_long_uniform_sections_become_pieces(tmp_path, draw, remaining):
    """A bar with a step, or with hollow compartments: each piece has one of the two sections."""
    leg = stepped(body_of(meshed(tmp_path / "part.msh", draw, 20.0), 0.4))
    areas = np.array([piece.properties.mu for piece in leg.pieces]) / STEEL.rho
    # Of the bar, of what is left of it, and nothing between: a plane in a step's face is on one
    # side of it.
    assert np.isclose(areas[:, None], [2400e-6, remaining], rtol=1e-6).any(axis=1).sum() == 10


@pytest.fixture(scope="module")
def legs(tmp_path_factory):
    """The hollow wedge in 4 and 8 pieces."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("FLEXPROOF_CACHE", "off")
        file = meshed(tmp_path_factory.mktemp("wedge") / "wedge.msh", hollow_wedge, 30.0)
        return {count: stepped(body_of(file, 0.4), count) for count in (4, 8)}


def sections(x):
    """Area (m²) and second moments (m⁴) about y and z of the hollow wedge at x (m)."""
    heights = 0.06 - 0.05 * x
    about_y = (0.04 * heights**3 - 0.02 * 0.016**3) / 12.0
    about_z = (heights * 0.04**3 - 0.016 * 0.02**3) / 12.0
    return 0.04 * heights - 0.02 * 0.016, about_y, about_z


def test_hollow_wedge_pieces_match_formula(legs):
    """EA and EI of eight pieces of a hollow wedge, in the middle of each."""
    exact = sections(0.4 * (np.arange(8) + 0.5) / 8.0)
    for name, values in zip(("EA", "EIy", "EIz"), exact, strict=True):
        constants = [getattr(piece.properties, name) for piece in legs[8].pieces]
        # Plane faces are cut exactly.
        assert constants == pytest.approx(list(STEEL.E * values), rel=1e-9)


def compliance(leg, model="beam", theory="timoshenko"):
    """Compliance (6×6) of the tip with the root clamped."""
    matrices = leg_matrices(model, leg, ModelOptions(elements=8, theory=theory))
    free = matrices.stiffness.toarray()[6:, 6:]
    return np.linalg.inv(free)[:6, :6]


@pytest.mark.parametrize(("component", "section"), [(0, 0), (4, 1)])
def test_pieces_converge_with_order_two(legs, component, section):
    """Tension and bending flexibility of the wedge: ∫ dx/EA and ∫ dx/EI."""
    exact = quad(lambda x: 1.0 / (STEEL.E * sections(x)[section]), 0.0, 0.4)[0]
    coarse, fine = (compliance(leg)[component, component] / exact - 1.0 for leg in legs.values())
    # Sections in the middle of the pieces: the midpoint rule.
    assert np.log2(coarse / fine) == pytest.approx(2.0, abs=0.08)
    assert abs(fine) < 0.01


def test_pieces_have_equal_statics_as_segments(legs):
    """Compliances of the pieces by beams and by segments agree to 1e-9."""
    for theory in ("timoshenko", "euler-bernoulli"):
        beam, segments = (compliance(legs[4], model, theory) for model in ("beam", "segments"))
        assert scaled_difference(segments, beam) < 1e-9


def test_outer_points_move_rigidly_with_part(legs):
    """A wedge of eight pieces, displaced and rotated in its body, under unit twists of the body."""
    start, along = np.array([0.1, -0.2, 0.05]), np.array([1.0, 2.0, 2.0]) / 3.0
    ends = np.array([start, start + 0.4 * along])
    leg = leg_matrices("beam", legs[8], ModelOptions(elements=8))
    model = placed_leg(leg, leg_frame(*ends), ("A", "B"))
    fields = np.zeros((model.size, 6))
    fields[:6], fields[6:12] = shift(ends[0]), shift(ends[1])
    K = model.stiffness.toarray()
    fields[12:] = -np.linalg.solve(K[12:, 12:], K[12:, :12] @ fields[:12])
    assert np.abs(K @ fields).max() < 1e-9 * np.abs(K).max()
    # Areas are linear along the wedge: sections in the middle give its mass exactly.
    mass = STEEL.rho * 0.4 * sections(0.2)[0]
    assert (fields.T @ model.mass @ fields)[0, 0] == pytest.approx(mass, rel=1e-6)
    offsets = np.array([[0, 0, 0], [0, 0, 0], [0.02, 0.05, -0.02], [0.1, 0, 0]])
    points = start + np.outer([0.13, 0.4, 0.8, -0.4], along) + offsets
    expected = np.vstack([shift(point)[:3] for point in points])
    assert model.displacements(points) @ fields == pytest.approx(expected, abs=1e-9)


ROCKER = Path(__file__).resolve().parents[3] / "examples" / "rocker"


@pytest.fixture
def coarse(monkeypatch, tmp_path):
    monkeypatch.setattr(reduced_parts, "UNKNOWNS", 9000)
    monkeypatch.setattr(reduced_parts.identified, "__defaults__", (9000, 2))
    monkeypatch.delenv("FLEXPROOF_CACHE", raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))


@pytest.mark.exhaustive
@pytest.mark.usefixtures("coarse")
def test_rocker_with_three_bores_has_models():
    """Statics to 2 % and f1 to 2 % of the solid. It is no link of a serial chain."""
    robot = load_robot(ROCKER / "robot.toml")
    postures = [reference_posture(robot.mechanism)]
    (links,) = answers("links", postures, 0).compliances
    condensed = answers("segments", postures, 3, ModelOptions(parts="condensed"))
    solid = answers("solid", postures, 3)
    # The rod bends nowhere here, and the rocker is one mesh: statics are those of the solid.
    assert condensed.compliances[0] == pytest.approx(links, rel=1e-6, abs=1e-14)
    assert scaled_difference(links, solid.compliances[0]) < 0.02
    # Guyan's mass lies above in frequency, by little for the first.
    assert condensed.frequencies[0, 0] == pytest.approx(solid.frequencies[0, 0], rel=0.02)
    with pytest.raises(InputError, match="3 interfaces cannot be a link of a serial chain"):
        answers("vjm", postures, 0)


@pytest.mark.parametrize(
    ("words", "old", "new", "message"),
    [
        (
            ["solve", "--model", "links"],
            *("radius = 0.022", "radius = 0.023"),
            "no cylinder of radius 0.023 m; the nearest is face",
        ),
        (["check"], 'step = "rocker.step"', 'step = "rock.step"', "rock.step: no such file"),
        (
            ["check"],
            *('step = "rocker.step"', 'mesh = "rocker.step"\nunit = "cm"'),
            "contradicts it",
        ),
    ],
)
def test_faulty_part_gives_one_error_line(tmp_path, command, words, old, new, message):
    """Wrong radius of an interface, missing file, or a unit that contradicts the file."""
    text = (ROCKER / "robot.toml").read_text("utf-8")
    assert old in text
    (tmp_path / "robot.toml").write_text(text.replace(old, new), "utf-8")
    (tmp_path / "rocker.step").write_bytes((ROCKER / "rocker.step").read_bytes())
    warning = command.error_line(words[0], tmp_path / "robot.toml", *words[1:])
    assert message in warning
    assert "bodies.rocker" in warning


def test_check_command_opens_part_files(command):
    """Size and unit of the file, and the face that each interface selects."""
    output = command.output("check", ROCKER / "robot.toml")
    assert "rocker: rocker.step, read in mm: 343 × 263 × 60 mm" in output
    for point, radius in (("A", 22), ("B", 16), ("C", 16)):
        (line,) = (row for row in output.splitlines() if row.startswith(f"  {point}: face"))
        assert f"(bore of radius {radius} mm), axis 0 mm from the point" in line
        assert line.endswith("rigid by default")


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["identify", "--body", "rod"], "the CAD parts of"),
        (
            ["solve", "--model", "links", "--body", "rocker"],
            "is a CAD part; use flexproof identify",
        ),
    ],
)
def test_single_part_is_refused_by_solve(command, words, message):
    """`solve` refers to `identify` for a CAD part; `identify` needs the name of a CAD part."""
    robot = ROCKER / "robot.toml"
    assert message in command.error_line(words[0], robot, *words[1:])
