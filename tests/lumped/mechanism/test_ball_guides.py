"""Profile rail guides: stiffness of four rows of balls by hand, and joints on such guides."""

import numpy as np
import pytest
from support.robots.robot_from_text import described

from lumped.errors import InputError
from lumped.mechanism.catalogue.ball_contact import hertz_constant
from lumped.mechanism.catalogue.ball_guide import BallGuide
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


FAULTS = {
    SLIDE.replace("UP", ""): (
        "joints.a.up: missing; must be the direction of the normal of joints.a.guide"
    ),
    SLIDE.replace("UP", "up = [0, 0, 1]").replace(f"spacing = {SPACING}", "spacing = 0.003"): (
        "joints.a.guide.spacing: must be at least the diameter of the balls"
    ),
}


@pytest.mark.parametrize("text", FAULTS, ids=["up", "spacing"])
def test_invalid_guide_is_refused(text):
    """Without `up`, or with balls that are closer than their diameter: one line each."""
    with pytest.raises(InputError) as error:
        described(text)
    assert error.value.faults == (FAULTS[text],)
