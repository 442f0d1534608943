"""The inertia of a drive says what a rigid rotor before it does, by every model and by Ritz."""

import tomllib
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from lumped.errors import InputError
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.load import Load
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file import load_robot
from lumped.robot_file.load import described_by
from lumped.system.loads import loading
from validation.cases import ritz
from validation.models.loads.displacements import displacements, masses_of
from validation.models.mechanism import answers
from validation.models.options import ModelOptions


def described(text: str) -> Mechanism:
    return described_by(tomllib.loads(text), Path())[0]


HEAD = """
schema = 2
name = "arm"
points = { A = [0.0, 0.0, 0.0], P = [0.3, 0.4, 0.0] }
materials.steel = { E = 2.1e11, nu = 0.3, rho = 7850.0 }
bodies.arm.from = "A"
bodies.arm.to = "P"
bodies.arm.section = { shape = "rectangle", width = 0.06, height = 0.04 }
bodies.arm.material = "steel"
tool = { body = "arm", point = "P", moves = ["x"], mass = 2.0 }
"""
GIVE = f"compliance = {(1e-7 * np.diag([1.0, 2.0, 1.0, 30.0, 20.0, 90.0])).tolist()}"
WITH_KEY = """
[joints.motor]
type = "KIND"
between = ["ground", "arm"]
at = "A"
axis = AXIS
GIVE
drive = { stiffness = 5.0e4, simplified = 4.0e4, inertia = 2.0e-4, ratio = 100.0 }
"""
WITH_BODY = """
[bodies.rotor]
points = ["A"]
ROTOR
[joints.motor]
type = "KIND"
between = ["ground", "rotor"]
at = "A"
axis = AXIS
drive = { stiffness = 5.0e4, simplified = 4.0e4 }
[joints.gear]
type = "fixed"
between = ["rotor", "arm"]
at = "A"
GIVE
"""
KINDS = {
    "revolute": (
        "[0.0, 0.0, 1.0]",
        'mass = 1.0\ncentre = "A"\ninertia = [[1.0, 0, 0], [0, 1.0, 0], [0, 0, 2.0]]',
    ),
    "prismatic": ("[1.0, 0.0, 0.0]", 'mass = 2.0\ncentre = "A"'),
}


def both(kind: str, give: str = ""):
    """The arm with the key and with a body, 2 kg or kg m² both."""
    axis, rotor = KINDS[kind]
    return [
        described(
            HEAD
            + text.replace("KIND", kind)
            .replace("AXIS", axis)
            .replace("GIVE", give)
            .replace("ROTOR", rotor)
        )
        for text in (WITH_KEY, WITH_BODY)
    ]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("give", ["", GIVE])
def test_a_rotor_by_its_key_is_a_rotor_by_its_body(kind, give):
    found = []
    for arm in both(kind, give):
        pull = Load("pull", "arm", "P", acceleration=np.array([5.0, 0, 0]), speed=np.eye(3)[0])
        robot = replace(arm, loads=(pull,))
        at = posture(robot, robot.reference_pose)
        numbers = [displacements(m, [at])[0].ravel() for m in ("vjm", "links", "simplified")]
        numbers += [answers("simplified", [at], 1)[0].frequencies]
        for model in ("beam", "segments", "solid"):
            numbers += [answers(model, [at], 4, ModelOptions(divisions=2))[0].frequencies]
        found.append(np.concatenate(numbers))
        if not give:
            due = ritz.frequencies(at, 3)
            np.testing.assert_allclose(answers("beam", [at], 3)[0].frequencies, due, rtol=1e-5)
            rigid = answers("simplified", [at], 1)[0].frequencies
            np.testing.assert_allclose(rigid, ritz.on_drives(at, 1)[1], rtol=1e-9)
    np.testing.assert_allclose(found[0], found[1], rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("name", ["hexapod", "five-bar"])
def test_rotors_accelerate_as_the_coordinates_of_their_joints_do(name):
    """Second differences along x = ẋt + ẍt²/2; a hexapod's drives are within legs that swing."""
    robot = load_robot(name).mechanism
    joints = [
        replace(joint, drive=replace(joint.drive, inertia=3.0)) if joint.drive else joint
        for joint in robot.joints
    ]
    pull = Load("pull", robot.tool.body, robot.tool.point)
    pull = replace(pull, speed=np.array([0.7, 0, 0]), acceleration=np.array([3.0, 0, 0]))
    robot = replace(robot, joints=tuple(joints))
    pose, step = robot.poses[len(robot.poses) // 2], 1e-3
    along = np.array([move == "x" for move in robot.tool.moves], dtype=float)
    times = step * np.array([-1.0, 0.0, 1.0])
    before, now, after = (posture(robot, pose + along * (0.7 * t + 1.5 * t**2)) for t in times)
    found = loading(now, pull, masses_of(replace(robot, loads=(pull,)))).on_rotors
    assert len(found) == sum(joint.drive is not None for joint in joints)
    for joint, force in found.items():
        (first,), (middle,), (last,) = (one.coordinates[joint] for one in (before, now, after))
        due = (last - 2.0 * middle + first) / step**2
        assert force == pytest.approx(-3.0 * due, rel=1e-4, abs=1e-4)


@pytest.mark.parametrize(
    ("drive", "fault"),
    [
        ('stiffness = "rigid", inertia = 0.1', "drive.inertia: the rotor of a rigid drive stands"),
        ("stiffness = 1e5, ratio = 5.0", "drive.ratio: must be left out without `inertia`"),
    ],
)
def test_rotors_that_would_change_nothing_are_refused(drive, fault):
    text = WITH_KEY.replace("KIND", "revolute").replace("AXIS", "[0, 0, 1]").replace("GIVE", "")
    before, _ = text.split("drive = ")
    with pytest.raises(InputError, match=fault):
        described(f"{HEAD}{before}drive = {{ {drive} }}")
