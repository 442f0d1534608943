"""Drives on ball screws: k = 1/(L/EA + 1/bearing + 1/nut) by hand in every posture and model."""

from pathlib import Path

import numpy as np
import pytest
from support.robots.robot_from_text import described

from lumped.errors import ComputationError, InputError
from lumped.mechanism.catalogue.ball_contact import hertz_constant
from lumped.mechanism.catalogue.ball_nut import BallNut, nut_of_size, root_diameter
from lumped.mechanism.free_twists import drive_in
from lumped.mechanism.joint import BallScrew
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.load import InterfaceLoads
from lumped.models import serial_chains
from lumped.robot_file import load_robot
from lumped.system.assembly import assemble, assembly
from lumped.system.loads import loading, tool_displacements
from lumped.system.solution import compliance, modes, solved
from lumped.system.sweep import swept

EXAMPLE = Path(__file__).parents[3] / "examples" / "catalogue-gantry" / "robot.toml"
MASS, E, DIAMETER, NUT, BEARING = 25.0, 2.06e11, 0.0278, 6.0e8, 4.0e8
EA = E * np.pi * DIAMETER**2 / 4.0
SLIDE = f"""
schema = 2
name = "slide"
points = {{ A = [0.5, 0.0, 0.0] }}
bodies.slide = {{ points = ["A"], mass = {MASS}, centre = "A" }}
tool = {{ body = "slide", point = "A", moves = ["x"] }}
path = {{ from = [0.3], to = [0.9], count = 3 }}
[joints.axis]
type = "prismatic"
between = ["ground", "slide"]
at = "A"
axis = [1.0, 0.0, 0.0]
stiffness = {{ normal = 1e12, lateral = 1e12, roll = 1e11, pitch = 1e11, yaw = 1e11 }}
drive.screw = {{ diameter = {DIAMETER}, length = 0.4, nut = {NUT}, bearing = {BEARING}MORE }}
[[loads]]
name = "push"
wrench = [800.0, 0.0, 0.0, 0.0, 0.0, 0.0]
"""


def slide_mechanism(keys="", text=SLIDE):
    return described(text.replace("MORE", keys))


def one_end(length):
    """Return the axial stiffness (N/m) of a screw whose other end is free to slide."""
    return 1.0 / (length / EA + 1.0 / BEARING + 1.0 / NUT)


@pytest.mark.parametrize("x", [0.3, 0.5, 0.9])
def test_screw_stiffness_follows_nut(x):
    """At position x the nut is x − 0.1 m from the screw's bearing."""
    mechanism = slide_mechanism()
    slide_posture = posture(mechanism, np.array([x]))
    k = one_end(x - 0.1)
    solution = solved(assemble(slide_posture, {}))
    assert compliance(solution)[0, 0] == pytest.approx(1.0 / k, rel=1e-10)
    assert serial_chains.compliance(slide_posture, {})[0, 0] == pytest.approx(1.0 / k, rel=1e-10)
    assert modes(solution, 1).frequencies[0] == pytest.approx(np.sqrt(k / MASS) / 2 / np.pi)
    load = loading(slide_posture, mechanism.loads[0], InterfaceLoads())
    assert tool_displacements(solution, [load])[0, 0] == pytest.approx(800.0 / k, rel=1e-10)


def test_screw_stiffness_at_two_positions():
    """EA = 125.0 MN; 0.2 m: 1/(1.600 + 2.500 + 1.667 nm/N) = 173 N/µm; 0.8 m: 94.6 N/µm."""
    stiffnesses = [
        1e-6 / compliance(solved(assemble(posture(slide_mechanism(), np.array([x])), {})))[0, 0]
        for x in (0.3, 0.9)
    ]
    assert stiffnesses == pytest.approx([173.4, 94.6], rel=1e-3)


def test_two_bearings_act_in_parallel():
    """The two parts of the screw, each with its bearing, act in parallel, and the nut in series."""
    mechanism = slide_mechanism(", span = 1.0")
    for x in (0.3, 0.6, 0.9):
        near, far = x - 0.1, 1.1 - x
        shaft = sum(1.0 / (part / EA + 1.0 / BEARING) for part in (near, far))
        k = 1.0 / (1.0 / shaft + 1.0 / NUT)
        axial_compliance = compliance(solved(assemble(posture(mechanism, np.array([x])), {})))[0, 0]
        assert axial_compliance == pytest.approx(1.0 / k, rel=1e-10)


def test_screw_stiffens_towards_bearing():
    """`positive = "shorter"`: at x the nut is 0.9 − x from a bearing on the other side."""
    tool_compliance = compliance(
        solved(assemble(posture(slide_mechanism(', positive = "shorter"'), np.array([0.7])), {}))
    )
    assert tool_compliance[0, 0] == pytest.approx(1.0 / one_end(0.2), rel=1e-10)


def test_each_pose_has_its_screw_stiffness():
    """Compliances and frequencies of a slide in three poses, with k by hand."""
    mechanism = slide_mechanism()
    postures = [posture(mechanism, pose) for pose in mechanism.poses]
    result = swept(assembly(mechanism, {}), postures, 1)
    expected = [1.0 / one_end(x - 0.1) for x in (0.3, 0.6, 0.9)]
    np.testing.assert_allclose(result.compliances[:, 0, 0], expected, rtol=1e-10)
    speeds = 1.0 / np.sqrt(np.array(expected) * MASS)
    np.testing.assert_allclose(2.0 * np.pi * result.frequencies[:, 0], speeds, rtol=1e-10)


def test_screw_rotor_adds_mass():
    """The rotor's inertia J (2π/lead)² is added to the mass; both vibrate on one spring."""
    ratio = 2.0 * np.pi / 0.01
    text = SLIDE.replace("[[loads]]", f"drive.inertia = 2.0e-4\ndrive.ratio = {ratio}\n[[loads]]")
    solution = solved(assemble(posture(slide_mechanism("", text), np.array([0.9])), {}))
    mass = MASS + 2.0e-4 * ratio**2
    expected = np.sqrt(one_end(0.8) / mass) / (2.0 * np.pi)
    assert modes(solution, 1).frequencies[0] == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("load", "expected"),
    [
        # At the load of the table, 0.8 of its stiffness.
        ("preload = 2.5e3", 0.8 * NUT),
        ("preload = 1.25e3, share = 0.05", 0.8 * NUT),
        ("load = 7.5e3", 0.8 * NUT),
        # Of balls in grooves, Q = c δ^1.5: dQ/dδ at an eighth of the load is half as large.
        ("preload = 312.5", 0.4 * NUT),
        ("load = 60.0e3", 1.6 * NUT),
    ],
)
def test_nut_stiffness_follows_its_table(load, expected):
    """0.8 K (F/0.1 C)^⅓ with preload F and load rating C; 0.8 K (F/0.3 C)^⅓ with play."""
    table = f"{{ rigidity = {NUT}, load_rating = 2.5e4, {load} }}"
    mechanism = slide_mechanism("", SLIDE.replace(f"nut = {NUT}", f"nut = {table}"))
    axial_compliance = compliance(solved(assemble(posture(mechanism, np.array([0.5])), {})))[0, 0]
    assert axial_compliance == pytest.approx(0.4 / EA + 1.0 / BEARING + 1.0 / expected, rel=1e-10)


def test_screw_stiffness_equals_hiwin():
    """HIWIN, Ballscrew, Technical Information S99TE20-1610, example 4.5-5 (kgf/µm).

    Shaft 20.5, nut 46 under a preload of 250 kgf, both 14.18, with a bearing of 105 12.35. The
    catalogue's 16.8 d²/L is E = 2.10e5 N/mm². It has rounded 14.18 to 14 before the last step.
    """
    kgf_per_micrometre = 9.80665e6
    load_rating = 5370 * 9.80665
    nut = BallNut(74 * kgf_per_micrometre, load_rating, 0.1).stiffness(250 * 9.80665)
    assert nut / kgf_per_micrometre == pytest.approx(46.0, abs=0.2)
    axial = 2.10e11 * np.pi * 0.03491**2 / 4.0
    assert axial / kgf_per_micrometre == pytest.approx(20.5, rel=3e-3)
    bearing = 1.0 / (105 * kgf_per_micrometre)
    for bearing_compliance, expected in ((0.0, 14.18), (bearing, 1.0 / (1 / 14.18 + 1 / 105))):
        screw = BallScrew(axial, 1.0, 1.0, None, bearing_compliance, 1.0 / nut)
        assert screw.stiffness(0.0) / kgf_per_micrometre == pytest.approx(expected, rel=3e-3)


# Designations of double nuts: diameter of the balls (mm), lead (mm), turns of balls in each nut.
DOUBLE_NUTS = {
    "R25-10T3-FDI": (4.763, 10.0, 3),
    "R32-10T3-FDI": (6.350, 10.0, 3),
    "R40-10T4-FDI": (6.350, 10.0, 4),
    "R50-10T4-FDI": (6.350, 10.0, 4),
}


@pytest.mark.parametrize("size", DOUBLE_NUTS)
def test_published_nut_stiffness_is_below_hertz(size):
    """Rigid threads with all balls loaded are 1.5 to 1.7 times as stiff as the table's K.

    K of a preloaded double nut is 2^1.5 F/δ with the approach δ of one nut under the preload F:
    under a load of 2^1.5 F the second nut is free. The grooves have 0.54 of the ball's diameter.
    """
    ball, lead, turns = DOUBLE_NUTS[size]
    D, lead, groove, alpha = 1e-3 * ball, 1e-3 * lead, 0.54, np.radians(45.0)
    pitch_circle = root_diameter(size) + D
    slope = np.arctan(lead / (np.pi * pitch_circle))
    balls = turns * np.pi * pitch_circle / (np.cos(slope) * D)
    gamma = D * np.cos(alpha) / pitch_circle
    compliance_of_ball = sum(
        hertz_constant((2.0 / D, 2.0 / D, 2.0 / D * along, -1.0 / (groove * D))) ** (-2.0 / 3.0)
        for along in (gamma / (1.0 - gamma), -gamma / (1.0 + gamma))
    )
    nut = nut_of_size(size)
    preload = 0.1 * nut.load_rating
    axial = np.sin(alpha) * np.cos(slope)
    approach = compliance_of_ball * (preload / (balls * axial)) ** (2.0 / 3.0) / axial
    assert 1.5 < 2.0**1.5 * preload / approach / nut.rigidity < 1.7


SIZED = "{ length = 0.4, nut = { size = 'R32-10T3-FDI', preload = 1000.0 }, bearing = 'ZKLF2068' }"


def sized_mechanism(screw):
    lines = [line for line in SLIDE.splitlines() if "screw" not in line]
    text = "\n".join(lines).replace("[[loads]]", f"drive.screw = {screw}\n[[loads]]")
    return described(text)


def test_screw_of_size_has_table_stiffness():
    """R32-10T3-FDI: root 26.91 mm, K 680 N/µm under 2539 N; bearing ZKLF2068: 650 N/µm."""
    axial_compliance = compliance(
        solved(assemble(posture(sized_mechanism(SIZED), np.array([0.5])), {}))
    )[0, 0]
    nut = 0.8 * 680e6 * (1000.0 / 2539.0) ** (1.0 / 3.0)
    shaft = 0.4 / (E * np.pi * 0.02691**2 / 4.0)
    assert axial_compliance == pytest.approx(shaft + 1.0 / nut + 1.0 / 650e6, rel=1e-10)


SIZE_FAULTS = {
    SIZED.replace("length", "diameter = 0.03, length"): (
        "joints.axis.drive.screw.diameter: must be left out, because joints.axis.drive.screw.nut."
        "size determines it"
    ),
    SIZED.replace("preload", "load"): (
        "joints.axis.drive.screw.nut.load: R32-10T3-FDI is preloaded; must be "
        "joints.axis.drive.screw.nut.preload"
    ),
    SIZED.replace("preload", "rigidity = 1e9, preload"): (
        "joints.axis.drive.screw.nut.rigidity: must be left out, because joints.axis.drive.screw."
        "nut.size determines it"
    ),
    SIZED.replace("1000.0", "3.0e4"): (
        "joints.axis.drive.screw.nut.preload = 30000.0: must be at most the load rating, 25390 N"
    ),
    "{ diameter = 0.03, length = 0.4, nut = { rigidity = 6e8, load_rating = 26, preload = 50.0 }, "
    "bearing = 'rigid' }": (
        "joints.axis.drive.screw.nut.preload = 50.0: must be at most the load rating, 26 N"
    ),
    "{ length = 0.4, nut = 6.0e8, bearing = 'rigid' }": (
        "joints.axis.drive.screw.diameter: missing; must be given, or joints.axis.drive.screw.nut."
        "size"
    ),
}


IDS = ["diameter", "load", "rigidity", "preload", "load rating", "shaft"]


@pytest.mark.parametrize("screw", SIZE_FAULTS, ids=IDS)
def test_invalid_size_of_screw_is_refused(screw):
    """Keys that contradict the size of a nut, and preloads above its load rating: one line each."""
    with pytest.raises(InputError) as error:
        sized_mechanism(screw)
    assert error.value.faults == (SIZE_FAULTS[screw],)


def test_nut_beyond_screw_bearing_is_refused():
    """In a pose, and as pose 1 of the path when the file is read."""
    with pytest.raises(
        ComputationError, match="the nut is 50 mm beyond a bearing of its shaft; must be between"
    ):
        assemble(posture(slide_mechanism(), np.array([0.05])), {})
    with pytest.raises(InputError) as error:
        slide_mechanism("", SLIDE.replace("from = [0.3]", "from = [0.05]"))
    assert error.value.faults == (
        "path, pose 1, x = 0.05 m: joints.axis.drive.screw: the nut is 50 mm beyond a bearing of "
        "its shaft; must be between the bearing and the shaft's other end",
    )


FAULTS = {
    ", span = 0.3": (
        "joints.axis.drive.screw.span: must be above joints.axis.drive.screw.length, the length to "
        "the nut"
    ),
    ', positive = "out"': (
        'joints.axis.drive.screw.positive = "out": must be "longer" or "shorter"'
    ),
    " }\ndrive.stiffness = 1.0e6\ndrive.loss = 0.1 #": (
        "joints.axis.drive.screw: must be left out if a stiffness is given, which it determines"
    ),
}


@pytest.mark.parametrize(
    ("load", "reason"),
    [("", "has no load"), (", preload = 1.0, load = 1.0", "has preload and load")],
)
def test_nut_needs_exactly_one_kind_of_load(load, reason):
    """`preload`, or `load` of a nut with play."""
    table = f"{{ rigidity = {NUT}, load_rating = 2.5e4{load} }}"
    with pytest.raises(InputError) as error:
        slide_mechanism("", SLIDE.replace(f"nut = {NUT}", f"nut = {table}"))
    assert error.value.faults == (
        f"joints.axis.drive.screw.nut: {reason}; must have one of preload, load (with play)",
    )


@pytest.mark.parametrize("keys", FAULTS)
def test_invalid_screw_is_refused(keys):
    """Each fault of `drive.screw` gives one line with key, value and range."""
    with pytest.raises(InputError) as error:
        slide_mechanism(keys)
    assert error.value.faults == (FAULTS[keys],)


def test_drive_without_stiffness_is_refused():
    """A drive has a stiffness, a screw, or is "rigid"."""
    lines = [line for line in SLIDE.splitlines() if "screw" not in line]
    with pytest.raises(InputError) as error:
        described("\n".join(lines).replace("[[loads]]", "drive.loss = 0.1\n[[loads]]"))
    assert error.value.faults == (
        'joints.axis.drive.stiffness: missing; must be a number in N/m or N m/rad, or "rigid"',
    )


def test_long_screw_softens_gantry():
    """At the ends of the path the nut is 200 and 400 mm from the bearing of the screw."""
    robot = load_robot(EXAMPLE).mechanism
    rail = next(joint for joint in robot.joints if joint.name == "rail_left")
    for pose, length in ((robot.poses[0], 0.2), (robot.poses[-1], 0.4)):
        drive = drive_in(posture(robot, pose), rail)
        shaft = length / (2.06e11 * np.pi * 0.02113**2 / 4.0)
        nut = 0.8 * 490e6 * (1600.0 / 1643.0) ** (1.0 / 3.0)
        assert drive.stiffness == pytest.approx(1.0 / (shaft + 1 / nut + 1 / 450e6), rel=1e-9)
