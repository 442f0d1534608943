"""Joint stiffnesses by direction: compliance in rotated axes by hand, and rigid directions."""

import numpy as np
import pytest
from support.robots.robot_from_text import described

from lumped.errors import InputError
from lumped.mechanism.catalogue.directions import joint_axes, joint_matrix
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.kinematics.postures import posture, reference_posture
from lumped.models import serial_chains
from lumped.screws import rotation_about, turn_matrix
from lumped.system.assembly import assemble
from lumped.system.joint_motion import Portion, joint_motion
from lumped.system.solution import compliance, solved

ARM = """
schema = 2
name = "arm"
points = { A = [0.1, -0.2, 0.3], P = [0.4, 0.2, 0.5] }
bodies.arm = { points = ["A", "P"], mass = 3.0, centre = "P" }
tool = { body = "arm", point = "P", moves = MOVES }
[joints.a]
between = ["ground", "arm"]
at = "A"
"""
# Vector from A to P (m), rotation of the joint's axes against the base axes, and the stiffnesses of
# a revolute joint (first line: N/m, N/m, N m/rad, N m/rad, drive N m/rad) and of a slide (N/m, N/m,
# then N m/rad).
ARM_VECTOR = np.array([0.3, 0.4, 0.2])
TURN = rotation_about(np.array([0.4, -0.7, 0.3]))
X, Y, Z = TURN.T
AXIAL, RADIAL, TILTING, TORSION, DRIVE = 2.0e8, 3.1e8, 4.0e5, 7.0e5, 5.0e4
LATERAL, NORMAL, ROLL, PITCH, YAW = 1.0e8, 2.5e8, 3.0e4, 5.0e4, 6.0e4


def joined(*lines):
    """Return an arm on a joint with these table lines; the tool moves along x if it is driven."""
    moves = '["x"]' if any("drive" in line for line in lines) else "[]"
    return described(ARM.replace("MOVES", moves) + "\n".join(lines))


def tool_compliance(mechanism, pose=None):
    mechanism_posture = (
        reference_posture(mechanism) if pose is None else posture(mechanism, np.array(pose))
    )
    return compliance(solved(assemble(mechanism_posture, {})))


def by_hand(springs, arm=ARM_VECTOR):
    """Return the 6×6 compliance at P of an arm on springs at A, as a sum over the springs.

    A force F and a moment M at P stretch a spring along n by n·F/k and twist a spring about n by
    n·(r × F + M)/k; the tool then moves by n, or moves by n × r and rotates by n.
    """
    total = np.zeros((6, 6))
    for component, stiffness in springs.items():
        n = (X, Y, Z)[component % 3]
        turned = np.append(np.cross(n, arm), n)
        screw = turned if component >= 3 else np.append(n, np.zeros(3))
        total += np.outer(screw, screw) / stiffness
    return total


def along(x, y, z):
    """Return stiffnesses (N/m) along the joint's x, y and z axes, keyed by component 0 to 2."""
    return {0: x, 1: y, 2: z}


def about(x, y, z):
    """Return rotational stiffnesses (N m/rad) about the joint's axes, keyed by component 3 to 5."""
    return {3: x, 4: y, 5: z}


def direction(vector):
    return str(vector.tolist())


REVOLUTE = (
    'type = "revolute"',
    f"axis = {direction(X)}",
    f"drive = {{ stiffness = {DRIVE} }}",
    f"stiffness = {{ axial = {AXIAL}, radial = {RADIAL}, tilting = {TILTING} }}",
)
SLIDE = (
    'type = "prismatic"',
    f"axis = {direction(X)}",
    f"up = {direction(Z + 0.3 * X)}",
    "drive = { stiffness = 6.0e7 }",
    f"stiffness = {{ normal = {NORMAL}, lateral = {LATERAL}, roll = {ROLL}, pitch = {PITCH}, "
    f"yaw = {YAW} }}",
)
CASES = {
    "revolute": (
        REVOLUTE,
        along(AXIAL, RADIAL, RADIAL) | about(DRIVE, TILTING, TILTING),
    ),
    "prismatic": (
        SLIDE,
        along(6.0e7, LATERAL, NORMAL) | about(ROLL, PITCH, YAW),
    ),
    "fixed": (
        (
            'type = "fixed"',
            f"up = {direction(2.0 * X)}",
            f"stiffness = {{ axial = {AXIAL}, radial = {RADIAL}, torsion = {TORSION}, "
            f"tilting = {TILTING} }}",
        ),
        along(AXIAL, RADIAL, RADIAL) | about(TORSION, TILTING, TILTING),
    ),
}


@pytest.mark.parametrize("kind", CASES)
def test_joint_compliance_rotates_with_axes(kind):
    """Rounding errors of the 6×6 sums are below 1e-14 of the largest term."""
    lines, springs = CASES[kind]
    mechanism = joined(*lines)
    expected = by_hand(springs)
    size = np.sqrt(np.outer(np.diag(expected), np.diag(expected)))
    for computed in (tool_compliance(mechanism), chain_compliance(mechanism)):
        assert (np.abs(computed - expected) <= 1e-11 * size).all()


def chain_compliance(mechanism):
    """Return the tool's compliance by the virtual joint method."""
    return serial_chains.compliance(reference_posture(mechanism), {})


def test_slide_axes_turn_with_first_body():
    """The crank at 90° rotates the axes of the slide, which is the only elastic joint."""
    text = """
    schema = 2
    name = "crank"
    points = { A = [0.0, 0.0, 0.0], B = [0.3, 0.0, 0.0], P = [0.7, 0.0, 0.0] }
    bodies.crank = { points = ["A", "B"], mass = 1.0, centre = "A" }
    bodies.arm = { points = ["B", "P"], mass = 3.0, centre = "P" }
    tool = { body = "arm", point = "P", moves = ["x", "y"] }
    [joints.motor]
    type = "revolute"
    between = ["ground", "crank"]
    at = "A"
    axis = [0.0, 0.0, 1.0]
    drive = { stiffness = "rigid" }
    [joints.slide]
    type = "prismatic"
    between = ["crank", "arm"]
    at = "B"
    axis = [1.0, 0.0, 0.0]
    up = [0.0, 0.0, 1.0]
    drive = { stiffness = "rigid" }
    stiffness = { normal = 2.5e8, lateral = 1.0e8, roll = "rigid", pitch = 5.0e4, yaw = "rigid" }
    """
    mechanism = described(text)
    # With the tool on the y axis at 0.8 m the slide has moved by 0.1 m. The compliance acts at the
    # slide's point on the crank, 0.3 m from the motor and 0.5 m from the tool.
    computed = tool_compliance(mechanism, (0.0, 0.8))
    expected = np.zeros((6, 6))
    expected[0, 0] = 1.0 / 1.0e8
    expected[2, 2] = 1.0 / 2.5e8 + 0.5**2 / 5.0e4
    expected[3, 3], expected[2, 3] = 1.0 / 5.0e4, 0.5 / 5.0e4
    expected[3, 2] = expected[2, 3]
    # The pose is solved to 1e-12 of the mechanism's size.
    assert np.abs(computed - expected).max() <= 1e-10 * expected[3, 3]


@pytest.mark.parametrize("rigid", ["axial", "radial", "tilting"])
def test_rigid_direction_is_limit_of_stiffness(rigid):
    """The difference from the rigid joint falls as 1/k: to 1e-3 at 1e3 k and to 1e-6 at 1e6 k."""
    values = {"axial": AXIAL, "radial": RADIAL, "tilting": TILTING}

    def with_value(value):
        entries = ", ".join(f"{name} = {k}" for name, k in {**values, rigid: value}.items())
        return tool_compliance(joined(*REVOLUTE[:3], f"stiffness = {{ {entries} }}"))

    limit = with_value('"rigid"')
    kilo, mega = (np.abs(with_value(factor * values[rigid]) - limit).max() for factor in (1e3, 1e6))
    soft = np.abs(with_value(values[rigid]) - limit).max()
    assert kilo == pytest.approx(1e-3 * soft, rel=1e-6)
    # Rounding error of the compliance is 1e-16 of 1e-5 m/N, the differences are about 1e-15 m/N.
    assert mega == pytest.approx(1e-6 * soft, rel=1e-3)


def test_all_rigid_directions_give_rigid_joint():
    """`stiffness` with "rigid" in all directions is a joint without compliance."""
    lines = (*REVOLUTE[:3], 'stiffness = { axial = "rigid", radial = "rigid", tilting = "rigid" }')
    assert joined(*lines).joints[0].compliance is None


def test_ball_joint_yields_along_rod():
    """A rigid rod between ball joints carries only an axial force.

    Each joint is displaced by n·C n per unit force along the rod's direction n.
    """
    stiffness = f"{{ axial = {AXIAL}, radial = {RADIAL} }}"
    mechanism = described(f"""
    schema = 2
    name = "rod"
    points = {{ A = [0.0, 0.0, 0.0], B = [0.5, 0.0, 0.0] }}
    bodies.rod = {{ points = ["A", "B"], mass = 1.0, centre = "A" }}
    bodies.head = {{ points = ["B"], mass = 1.0, centre = "B" }}
    tool = {{ body = "head", point = "B", moves = [] }}
    [joints.slide]
    type = "prismatic"
    between = ["ground", "head"]
    at = "B"
    axis = [1.0, 0.0, 0.0]
    [joints.foot]
    type = "spherical"
    between = ["ground", "rod"]
    at = "A"
    up = {direction(X)}
    stiffness = {stiffness}
    [joints.ball]
    type = "spherical"
    between = ["rod", "head"]
    at = "B"
    up = {direction(Y)}
    stiffness = {stiffness}
    """)
    shares = np.array([X[0] ** 2, Y[0] ** 2])
    expected = np.sum(shares / AXIAL + (1.0 - shares) / RADIAL)
    computed = tool_compliance(mechanism)
    assert computed[0, 0] == pytest.approx(expected, rel=1e-12)
    computed[0, 0] = 0.0
    assert np.abs(computed).max() <= 1e-20


def test_bent_universal_joint_has_torsion():
    """A unit moment about the normal of both axes rotates by 1/k at any bend angle of the joint."""
    axes = np.array([Y, Z])
    compliance = joint_matrix("universal", joint_axes("universal", axes, None), {"torsion": 1e-5})
    sides = Side("ground", "A"), Side("shaft", "A")
    joint = Joint("foot", "universal", *sides, axes, compliance=compliance)
    for angle in (0.0, 0.7):
        second = rotation_about(angle * Y) @ rotation_about(0.3 * Z)
        motion = joint_motion(joint, np.eye(3), second, 1.0)
        normal = np.append(np.zeros(3), rotation_about(angle * Y) @ X)
        assert motion.elastic == 1
        turn = normal @ motion.basis[:, -1]
        rows = motion.springs[Portion("foot", "compliance")][:, -1]
        assert turn**2 / (rows @ rows) == pytest.approx(1e-5, rel=1e-12)


FAULTS = {
    "drive = { stiffness = 5.0e4 }\nstiffness = { axial = 1.0e8, radial = 1.0e8 }": (
        'joints.a.stiffness.tilting: missing; must be a number in N m/rad, or "rigid"'
    ),
    "stiffness = { axial = 1.0e8, radial = 1.0e8, tilting = 1.0e5, roll = 1.0e5 }": (
        "joints.a.stiffness.roll: does not belong to a revolute joint; its directions are axial, "
        "radial, tilting"
    ),
    'stiffness = { axial = "stiff", radial = 1.0e8, tilting = 1.0e5 }': (
        'joints.a.stiffness.axial = "stiff": must be a number above 0 N/m and at most 1e+15 N/m '
        'or "rigid"'
    ),
    'stiffness = { axial = 0.0, radial = "rigid", tilting = "rigid" }': (
        "joints.a.stiffness.axial = 0.0: must be above 0 N/m"
    ),
    'up = [0.0, 0.0, 1.0]\nstiffness = { axial = 1.0, radial = "rigid", tilting = "rigid" }': (
        "joints.a.up: does not belong to a revolute joint, which is equal all around its axis"
    ),
    'compliance = UNIT\nstiffness = { axial = 1.0, radial = "rigid", tilting = "rigid" }': (
        "joints.a.stiffness: must be left out, because joints.a.compliance replaces it"
    ),
    "loss = 0.1": (
        "joints.a.loss: must be left out without joints.a.compliance or joints.a.stiffness, to "
        "which it belongs"
    ),
}


@pytest.mark.parametrize("lines", FAULTS)
def test_invalid_stiffness_is_refused(lines):
    """Each fault gives one line with key, value and what is allowed."""
    unit = str((1e-9 * np.eye(6)).tolist())
    with pytest.raises(InputError) as error:
        joined(*REVOLUTE[:2], *lines.replace("UNIT", unit).split("\n"))
    assert error.value.faults == (FAULTS[lines],)


SLIDE_FAULTS = {
    "": "joints.a.up: missing; must be the direction of the normal, because normal and lateral "
    "differ",
    f"up = {direction(-3.0 * X)}": (
        f"joints.a.up = {direction(-3.0 * X)}: must be a direction that does not lie along the "
        "slide"
    ),
    "up = [0.0, 0.0, 0.0]": "joints.a.up = [0.0, 0.0, 0.0]: must not be zero, it is a direction",
}


@pytest.mark.parametrize("up", SLIDE_FAULTS)
def test_invalid_slide_normal_is_refused(up):
    """`up` of a slide with stiffness: missing, zero or along the slide."""
    with pytest.raises(InputError) as error:
        joined(*SLIDE[:2], up, *SLIDE[3:])
    assert error.value.faults == (SLIDE_FAULTS[up],)


def test_copied_joint_has_rotated_stiffness():
    """A hub on three seats, 120° apart: the compliance of each is that of the first, rotated."""
    mechanism = described("""
    schema = 2
    name = "hub"
    patterns.three = { about = "z", count = 3 }
    points.A = { at = [0.3, 0.0, 0.0], pattern = "three" }
    points.P = [0.0, 0.0, 0.0]
    bodies.hub = { points = ["P", "A1", "A2", "A3"], mass = 2.0, centre = "P" }
    tool = { body = "hub", point = "P", moves = [] }
    [joints.seat]
    type = "fixed"
    between = ["ground", "hub"]
    at = "A"
    pattern = "three"
    up = [1.0, 0.0, 0.5]
    stiffness = { axial = 1.0e8, radial = 3.0e7, torsion = 2.0e4, tilting = "rigid" }
    damping = { axial = 50.0, radial = 20.0 }
    """)
    for attribute in ("compliance", "damping"):
        first, *copies = (getattr(joint, attribute) for joint in mechanism.joints)
        for number, copy in enumerate(copies, start=1):
            turned = turn_matrix(
                first, rotation_about(np.array([0.0, 0.0, number * 2 * np.pi / 3]))
            )
            assert np.abs(copy - turned).max() <= 1e-13 * np.abs(first).max()
    # Threefold symmetry.
    compliance_of_copy = tool_compliance(mechanism)
    assert compliance_of_copy[0, 0] == pytest.approx(compliance_of_copy[1, 1], rel=1e-9)
