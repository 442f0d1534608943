"""Profile rail guides: stiffness of four rows of balls by hand, and joints on such guides."""

import numpy as np
import pytest
from support.robots.robot_from_text import described

from lumped.errors import InputError
from lumped.mechanism.catalogue.ball_contact import hertz_constant
from lumped.mechanism.catalogue.ball_guide import CARRIAGES, BallGuide, carriage_stiffness
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.system.assembly import assemble
from lumped.system.solution import compliance, solved

BALLS, D, SPACING, WIDTH, HEIGHT, PRELOAD = 14, 4e-3, 4.4e-3, 0.022, 0.009, 1500.0
ALPHA = np.radians(45.0)


def guide(lines):
    return BallGuide(BALLS, D, SPACING, WIDTH, HEIGHT, ALPHA, 0.52, lines)


@pytest.mark.parametrize(("lines", "lever"), [("O", WIDTH + HEIGHT), ("X", WIDTH - HEIGHT)])
def test_guide_stiffness_is_sum_over_balls(lines, lever):
    """Each ball has k = dQ/dδ = (3/2) Q/δ along its contact line and Q/ℓ across it.

    ℓ is the distance between the centres of curvature of the two grooves, w the distance of the
    ball rows across the rail and h that above each other. At 45° both sin² and cos² are ½. In roll
    (about the rail), contact lines of type O have the lever arm (w + h)/2√2 and those of type X
    (w − h)/2√2; the directions across them have the other lever arm. In pitch and yaw the lever arm
    of a ball is its distance x along the rail.
    """
    constant = hertz_constant((2.0 / D, 2.0 / D, 0.0, -1.0 / (0.52 * D))) / 2.0**1.5
    load = PRELOAD / (2.0 * BALLS * np.sin(ALPHA))
    approach = (load / constant) ** (2.0 / 3.0)
    along, across = 1.5 * load / approach, load / (0.04 * D + approach)
    stiffness = guide(lines).stiffness(PRELOAD)
    count = 4.0 * BALLS
    stations = SPACING * (np.arange(BALLS) - 0.5 * (BALLS - 1))
    square = float(np.mean(stations**2))
    straight = count * 0.5 * (along + across)
    other = 2.0 * WIDTH - lever
    roll = count / 8.0 * (along * lever**2 + across * other**2)
    expected = [0.0, straight, straight, roll, straight * square, straight * square]
    np.testing.assert_allclose(np.diag(stiffness), expected, rtol=1e-10)
    off_diagonal = stiffness - np.diag(np.diag(stiffness))
    assert np.abs(off_diagonal).max() <= 1e-9 * straight * WIDTH


def test_steep_contact_is_stiff_along_normal():
    """Normal over lateral stiffness is sin²α/cos²α = 3 at α = 60°, less a few percent."""
    steep = BallGuide(BALLS, D, SPACING, WIDTH, HEIGHT, np.radians(60.0), 0.52, "O")
    matrix = steep.stiffness(PRELOAD)
    assert 2.8 < matrix[2, 2] / matrix[1, 1] < 3.0


SLIDE = f"""
schema = 2
name = "slide"
points = {{ A = [0.0, 0.0, 0.0], P = [0.0, 0.0, 0.2] }}
bodies.slide = {{ points = ["A", "P"], mass = 3.0, centre = "P" }}
tool = {{ body = "slide", point = "P", moves = ["y"] }}
[joints.a]
type = "prismatic"
between = ["ground", "slide"]
at = "A"
axis = [0.0, 1.0, 0.0]
UP
drive = {{ stiffness = "rigid" }}
[joints.a.guide]
balls = {BALLS}
ball_diameter = {D}
spacing = {SPACING}
width = {WIDTH}
height = {HEIGHT}
preload = {PRELOAD}
"""


def test_guide_joint_yields_as_its_carriage():
    """Rail along y: lateral displacement and roll move the tool, 0.2 m above, along x."""
    text = SLIDE.replace("UP", "up = [0.0, 0.0, 1.0]")
    tool_compliance = compliance(solved(assemble(reference_posture(described(text)), {})))
    matrix = guide("O").stiffness(PRELOAD)
    assert tool_compliance[0, 0] == pytest.approx(
        1.0 / matrix[1, 1] + 0.2**2 / matrix[3, 3], rel=1e-9
    )
    assert tool_compliance[2, 2] == pytest.approx(1.0 / matrix[2, 2], rel=1e-9)


def static_ratings(model):
    """Return the normal force and the moments in roll and pitch of the most loaded ball.

    Its contact carries the same load Q in all three cases. The load of a ball is proportional to
    its displacement along the contact line to the power 3/2, and half of the balls are loaded.
    """
    x = model.spacing * (np.arange(model.balls) - 0.5 * (model.balls - 1))
    shares = np.abs(x / x.max()) ** 1.5
    force = 2.0 * model.balls * np.sin(model.angle)
    lever = 0.5 * (model.width * np.sin(model.angle) + model.height * np.cos(model.angle))
    pitch = 2.0 * np.sum(shares * np.abs(x)) * np.sin(model.angle)
    return force, 2.0 * model.balls * lever, pitch


def test_load_ratings_imply_tilting_stiffness():
    """Roll k (M/C)², pitch k L²/12 with L = 7 M/C: as the sum over many balls.

    L is the length of the rows. The small stiffness across the contact lines is left out.
    """
    model = BallGuide(200, 1e-4, 2e-4, WIDTH, HEIGHT, ALPHA, 0.52, "O")
    force, roll, pitch = static_ratings(model)
    stiffness = np.diag(model.stiffness(1e-4))
    length = 200 * 2e-4
    assert 7.0 * pitch / force == pytest.approx(length, rel=2e-2)
    assert stiffness[3] / stiffness[2] == pytest.approx((roll / force) ** 2, rel=2e-2)
    for tilting in (4, 5):
        assert stiffness[tilting] / stiffness[2] == pytest.approx(length**2 / 12.0, rel=1e-3)
    # Equal along normal and lateral at 45°.
    assert stiffness[1] == pytest.approx(stiffness[2], rel=1e-12)


# Sizes of HIWIN GmbH, Compact, section 1.1.12: C0 (N), moment in pitch (N m), length L1 of the
# steel body (mm), as printed or by the difference to the longer carriage of the size.
BODIES = {
    "HG20H": (48_840, 470, 65.2),
    "HG25C": (56_190, 510, 84.0 - (104.6 - 78.6)),
    "HG25H": (76_000, 880, 78.6),
    "HG35C": (102_870, 1200, 112.4 - (138.2 - 105.8)),
    "HG35H": (136_310, 2080, 105.8),
    "HG45C": (155_930, 2350, 97.0),
    "HG45H": (207_120, 4070, 128.8),
}


@pytest.mark.parametrize("size", BODIES)
def test_published_ratings_imply_length_of_body(size):
    """Rows as long as the steel body, 7 M/C, by the manufacturer's static ratings."""
    force, moment, length = BODIES[size]
    assert 7.0 * moment / force * 1e3 == pytest.approx(1.05 * length, rel=0.045)


@pytest.mark.parametrize("size", CARRIAGES)
def test_published_stiffness_grows_with_cube_root(size):
    """Hertz: k ∝ F^(1/3), here with preloads in the middle of their classes, 1, 6 and 11 % of C.

    Published: ZA/Z0 is 0.96 to 1.10 of that ratio, ZB/ZA 1.07 to 1.21.
    """
    light, medium, heavy = (carriage_stiffness(size, name)[2, 2] for name in ("Z0", "ZA", "ZB"))
    assert 0.95 < medium / light / 6.0 ** (1.0 / 3.0) < 1.10
    assert 1.06 < heavy / medium / (11.0 / 6.0) ** (1.0 / 3.0) < 1.21


CLASSES = SLIDE.replace("UP", "up = [0.0, 0.0, 1.0]").partition("[joints.a.guide]")[0]


def test_guide_of_size_has_table_stiffness():
    """HG25C, ZA: 539 N/µm; roll 539e6 · 0.01139² = 69.9 kN m/rad, pitch 539e6 · 0.058²/12."""
    text = f"{CLASSES}guide = {{ size = 'HG25C', preload = 'ZA' }}"
    tool_compliance = compliance(solved(assemble(reference_posture(described(text)), {})))
    assert tool_compliance[2, 2] == pytest.approx(1.0 / 539e6, rel=1e-9)
    assert tool_compliance[0, 0] == pytest.approx(1.0 / 539e6 + 0.2**2 / 69.9e3, rel=1e-3)
    assert tool_compliance[3, 3] == pytest.approx(12.0 / 539e6 / 0.058**2, rel=1e-9)


def test_guide_of_size_may_have_dashpots():
    """A guide given by its size in a catalogue, and a dashpot along its normal."""
    text = f"{CLASSES}guide = {{ size = 'HG25C', preload = 'ZA' }}\ndamping = {{ normal = 3.0e3 }}"
    (joint,) = described(text).joints
    assert joint.damping[2, 2] == pytest.approx(3.0e3)


FAULTS = {
    SLIDE.replace("UP", ""): (
        "joints.a.up: missing; must be the direction of the normal of joints.a.guide"
    ),
    SLIDE.replace("UP", "up = [0, 0, 1]").replace(f"spacing = {SPACING}", "spacing = 0.003"): (
        "joints.a.guide.spacing: must be at least the diameter of the balls"
    ),
    f"{CLASSES}guide = {{ size = 'HG25C', preload = 500.0 }}": (
        'joints.a.guide.preload = 500.0: must be "Z0" or "ZA" or "ZB", for a size'
    ),
    SLIDE.replace("UP", "up = [0, 0, 1]").replace(f"preload = {PRELOAD}", "preload = 'ZA'"): (
        'joints.a.guide.preload = "ZA": must be a force in N, without a size'
    ),
    f"{CLASSES}guide = {{ size = 'HG25C', preload = 'ZA', balls = 14 }}": (
        "joints.a.guide.balls: must be left out, because joints.a.guide.size determines it"
    ),
    SLIDE.replace("UP", "up = [0, 0, 1]").replace(f"preload = {PRELOAD}", "preload = 4000"): (
        "joints.a.guide.preload = 4000.0: must be at most 3.88e+03 N, 13 % of the static load "
        "rating of these balls; no class of catalogues has more"
    ),
    SLIDE.replace("UP", "up = [0, 0, 1]").replace(f"height = {HEIGHT}", ""): (
        "joints.a.guide.height: missing; must be given, or joints.a.guide.size"
    ),
}


@pytest.mark.parametrize(
    "text", FAULTS, ids=["up", "spacing", "class", "force", "balls", "preload", "height"]
)
def test_invalid_guide_is_refused(text):
    """Without `up`, or with balls that are closer than their diameter: one line each."""
    with pytest.raises(InputError) as error:
        described(text)
    assert error.value.faults == (FAULTS[text],)
