"""Robot files of schema 2: what sound ones describe, and one line for each fault of wrong ones."""

import re
import shutil
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from lumped.errors import InputError
from lumped.mechanism.body import Given, Prism, Rigid
from lumped.robot_file import load_robot, write_template
from lumped.robot_file.load import built_in_robots
from validation import cli

ROCKER = Path(__file__).parents[3] / "examples" / "rocker" / "robot.toml"
GUIDE = Path(__file__).resolve().parents[3] / "docs" / "guide" / "mechanisms.md"
MANY_LINES = re.MULTILINE | re.DOTALL
PIN = (
    '[joints.pin]\ntype = "revolute"\nbetween = ["rod1", "rod2"]\nat = "P"\naxis = [0.0, 0.0, 1.0]'
)
SECTION = (
    'section = { shape = "hollow-rectangle", width = 0.050, height = 0.060, thickness = 0.005 }'
)
ROD1 = f'[bodies.rod1]\nfrom = "B1"\nto = "P"\n{SECTION}\nmaterial = "aluminium"'
PATH = "from = [-0.20, 0.45]\nto = [0.20, 0.55]\ncount = 9"
MOVES = 'moves = ["x", "y"]      # what'
EYE = (
    "["
    + ",".join(str([(1e-6 if i < 3 else 1e-5) * (i == j) for j in range(6)]) for i in range(6))
    + "]"
)
LOAD = (
    'moves = ["x", "y", "z"]\nmass = 1.0              # kg, the load\n\n[path]\n'
    "from = [-0.12, -0.08, -0.42]\nto = [0.12, 0.08, -0.52]\ncount = 9"
)
FEET = 'at = "B1", axes = [[0.241922, 0.970296, 0.0], '
A1 = "A1 = [-0.15, 0.0, 0.0]"


@dataclass(frozen=True)
class Wrong:
    """One edit of a sound file, and what its only fault must say."""

    old: str
    new: str
    said: tuple[str, ...]
    robot: str = "five-bar"


def five(old, new, *said):
    return Wrong(old, new, said)


def on(robot):
    return lambda old, new, *said: Wrong(old, new, said, robot)


delta, hexapod = on("delta"), on("hexapod")
WRONG = {
    # the file as a whole
    "misspelt key": five('body = "rod1"', 'bodie = "rod1"\nbody = "rod1"', 'did you mean "body"?'),
    # points
    "point in mm": five(A1, "A1 = [-150.0, 0.0, 0.0]", "points.A1[1] = -150.0", "in mm?"),
    "name of a point": five(A1, '"A.9" = [0.0, 0.0, 0.0]\n' + A1, "points.A.9", "letters"),
    "point used by nobody": five(A1, A1 + "\nZ = [1.0, 1.0, 0.0]", "points.Z: used by no body"),
    # materials
    "unknown material": five(
        'to = "P"\n' + SECTION + '\nmaterial = "aluminium"\n\n# fixed',
        'to = "P"\n' + SECTION + '\nmaterial = "aluminum"\n\n# fixed',
        'bodies.rod2.material = "aluminum"',
        'did you mean "aluminium"?',
    ),
    "density nowhere": five(
        "nu = 0.33, rho = 2700.0 }\n\n# A leg",
        "nu = 0.33 }\nlight = { E = 1e10, nu = 0.3, rho = 100.0 }\n\n# A leg",
        "rho: missing",
    ),
    # bodies
    "unknown point": five(
        'from = "B2"', 'from = "B3"', 'bodies.rod2.from = "B3"', "A1, A2, B1, B2, P"
    ),
    "leg to where it begins": five(
        'from = "B2"\nto = "P"', 'from = "B2"\nto = "B2"', "bodies.rod2.to", "must be apart"
    ),
    "leg without an end": five('from = "B2"\nto = "P"', 'from = "B2"', "bodies.rod2.to: missing"),
    "body of nothing": five(
        ROD1, "[bodies.rod1]\nmass = 1.0", "bodies.rod1: must be a leg", "rigid body", "part"
    ),
    "interfaces no table": five(
        ROD1,
        '[bodies.rod1]\nstep = "rod.step"\ninterfaces = 3\nmaterial = "aluminium"',
        "bodies.rod1.interfaces = 3: must be a table of named entries",
    ),
    "leg and rigid body": five(ROD1, ROD1 + '\npoints = ["B1"]', "bodies.rod1: must be a leg"),
    "leg along its up": five(ROD1, ROD1 + "\nup = [0.35, 0.3, 0.0]", "bodies.rod1.up", "along"),
    "up of zero": five(ROD1, ROD1 + "\nup = [0.0, 0.0, 0.0]", "bodies.rod1.up"),
    "centre of a leg": five(ROD1, ROD1 + '\ncentre = "P"', "bodies.rod1.centre", "belong to a leg"),
    "section in mm": five(
        ROD1, ROD1.replace("width = 0.050", "width = 50.0"), "bodies.rod1.section.width", "in mm?"
    ),
    "leg without a material": five(
        ROD1, ROD1.removesuffix('\nmaterial = "aluminium"'), "bodies.rod1.material: missing"
    ),
    "section and compliance": five(
        ROD1, f"{ROD1}\nmass = 1.0\ncompliance = {EYE}", "bodies.rod1", "both given"
    ),
    "mass and density": five(ROD1, ROD1 + "\nmass = 3.0", "bodies.rod1.mass and materials.alumin"),
    "leg of no mass": five(
        ROD1, f'[bodies.rod1]\nfrom = "B1"\nto = "P"\nmass = 0.0\ncompliance = {EYE}', "above 0 kg"
    ),
    "ends of a leg": five(ROD1, ROD1 + '\nends = "loose"', "bodies.rod1.ends", '"rigid" or "free"'),
    "ground as a body": five(
        ROD1,
        f'[bodies.ground]\npoints = ["P"]\n{ROD1}',
        "bodies.ground: the base",
    ),
    "rigid body without points": delta(
        'bar1 = { points = ["E1", "E1l", "E1r"]', "bar1 = { points = []", "bodies.bar1.points"
    ),
    "point of a rigid body unknown": delta(
        'bar1 = { points = ["E1", "E1l", "E1r"]',
        'bar1 = { points = ["E1", "E1l", "E1r", "E9"]',
        'bodies.bar1.points[4] = "E9"',
    ),
    "point named twice": delta(
        'bar1 = { points = ["E1", "E1l", "E1r"]',
        'bar1 = { points = ["E1", "E1l", "E1r", "E1"]',
        "named twice",
    ),
    "mass without its centre": delta(
        'mass = 0.25, centre = "E1" }', "mass = 0.25 }", "bodies.bar1.centre: missing"
    ),
    "centre unknown": delta('centre = "E1" }', 'centre = "E0" }', 'bodies.bar1.centre = "E0"'),
    "centre without mass": delta(
        'mass = 0.25, centre = "E1" }', 'centre = "E1" }', "bodies.bar1.mass: missing"
    ),
    "inertia not symmetric": delta("[[7.0e-4, 0.0,", "[[7.0e-4, 1e-4,", "must be equal"),
    "material of a rigid body": delta(
        'mass = 0.25, centre = "E1" }',
        'mass = 0.25, centre = "E1", material = "steel" }',
        "bodies.bar1.material: does not belong to a rigid body",
    ),
    "interface used by nobody": delta(
        'points = ["C1l",', 'points = ["A1", "C1l",', "bodies.platform: nothing takes hold", '"A1"'
    ),
    "body without joint": five(
        "# fixed, revolute",
        '[bodies.spare]\nfrom = "A1"\nto = "A2"\nsection = { shape = "circle", diameter = 0.02 }\n'
        'material = "steel"\n# fixed, revolute',
        "bodies.spare: no joint holds it",
    ),
    # joints
    "unknown kind": five(PIN, PIN.replace("revolute", "hinge"), "joints.pin.type", "cylindrical"),
    "unknown body": five(PIN, PIN.replace("rod2", "rod3"), "joints.pin.between[2]", "did you mean"),
    "same body": five(
        PIN, PIN.replace('"rod1", "rod2"', '"rod1", "rod1"'), 'joints.pin.between: "rod1" twice'
    ),
    "three bodies": five(
        PIN, PIN.replace('"rod2"]', '"rod2", "crank1"]'), "joints.pin.between", "2 texts"
    ),
    "joint nowhere": five(PIN, PIN.replace('"P"', '"Q"'), 'joints.pin.at = "Q"'),
    "points apart that a joint joins": five(
        PIN, PIN.replace('at = "P"', 'at = ["B1", "B2"]'), "joints.pin.at", "one point of both"
    ),
    "point of another body": five(
        PIN, PIN.replace('at = "P"', 'at = "A1"'), "joints.pin.at", "a point of rod1", "of rod2"
    ),
    "axis of zero": five(PIN, PIN.replace("1.0]", "0.0]"), "joints.pin.axis", "not be zero"),
    "axis missing": five(
        PIN, PIN.removesuffix("\naxis = [0.0, 0.0, 1.0]"), "joints.pin.axis: missing"
    ),
    "axis of a ball joint": delta(
        'at = "E1l" }', 'at = "E1l", axis = [0.0, 0.0, 1.0] }', "joints.elbow1l.axis", "have none"
    ),
    "one axis of a universal joint": hexapod(
        'at = "B1", axes = [', 'at = "B1", axis = [0.0, 0.0, 1.0], axes = [', "joints.foot1.axis"
    ),
    "parallel axes": hexapod(
        FEET,
        FEET + "[0.483844, 1.940592, 0.0]] }\n#",
        "joints.foot1.axes = [[0.241922, 0.970296, 0.0], [0.483844, 1.940592, 0.0]]: must not be",
    ),
    "axis across two points": hexapod(
        'at = ["S1", "R1"],', 'at = ["S1", "R1"], axis = [1.0, 0.0, 0.0],', "joints.drive1.axis"
    ),
    "the same point twice": hexapod(
        'at = ["S1", "R1"],', 'at = ["S1", "S1"], axis = [0.0, 0.0, 1.0],', "joints.drive1.at"
    ),
    "drive of a ball joint": delta(
        'at = "E1l" }', 'at = "E1l", drive = { stiffness = 1e5 } }', "joints.elbow1l.drive"
    ),
    "drive of no stiffness": five(
        'drive = { stiffness = 8.0e4 }       # N m/rad; "rigid" holds it',
        'drive = { stiffness = 0.0 }         # N m/rad; "rigid" holds it',
        "joints.motor1.drive.stiffness = 0.0",
        "above 0",
    ),
    "compliance of a joint": five(
        PIN, f"{PIN}\ncompliance = {EYE.replace('[1e-06', '[-1e-06', 1)}", "joints.pin"
    ),
    # tool
    "tool on ground": five('body = "rod1"\npoint', 'body = "ground"\npoint', "tool.body", "moves"),
    "tool on nothing": five('body = "rod1"\npoint', 'body = "rod5"\npoint', 'tool.body = "rod5"'),
    "tool beside its body": five('point = "P"', 'point = "A2"', 'tool.point = "A2"', "rod1"),
    "moves unknown": five(MOVES, 'moves = ["x", "w"]      # what', "tool.moves[2]"),
    "moves twice": five(MOVES, 'moves = ["x", "x"]      # what', "tool.moves[2]", "named twice"),
    # motion
    "moves that the mobility does not allow": five(
        MOVES, 'moves = ["x", "z"]      # what', "tool.moves", "along z", "free to"
    ),
    "axis typed with three digits": five(
        PIN,
        PIN.replace("axis = [0.0, 0.0, 1.0]", "axis = [0.0, 0.001, 1.0]"),
        "the joints do not let the tool move along",
        "are parallel axes given with all their digits?",
    ),
    "moves that leave a motion open": delta(
        LOAD,
        'moves = ["x", "y"]',
        "tool.moves",
        "translate along z",
    ),
    "a drive too few": five(
        'drive = { stiffness = 8.0e4 }       # N m/rad; "rigid" holds it',
        '# N m/rad; "rigid" holds it',
        "joints: with all drives held the tool is free to",
    ),
    "stretched in the reference": five(
        "P = [0.0, 0.55, 0.0]",
        "P = [-0.55, 0.5, 0.0]",
        "points: the reference posture is singular, drives motor1",
    ),
    # path
    "pose of three numbers": five(
        PATH, PATH.replace("0.55]", "0.55, 0.1]"), "path.to: 3 numbers; must be 2", "x, y"
    ),
    "path without an end": five(PATH, "from = [0.0, 0.5]\ncount = 3", "path.to: missing"),
    "line and grid": five(PATH, PATH + "\ncounts = [3, 3]", "path.count: must be given"),
    "no count": five(PATH, PATH.replace("count = 9", ""), "path.count: must be given"),
    "count of zero": five(PATH, PATH.replace("= 9", "= 0"), "path.count = 0: must be at least 1"),
    "poses beside a line": five(
        PATH, PATH + "\nposes = [[0.0, 0.5]]", "must not be given beside path.poses"
    ),
    "no poses": five(PATH, "poses = []", "path.poses = []: must hold at least one pose"),
    "pose out of reach": five(
        PATH,
        "poses = [[0.0, 0.5], [0.9, 0.9], [0.1, 0.5]]",
        "path, pose 2, x = 0.9 m, y = 0.9 m: cannot be reached: joint",
        "the way from the reference posture ends after",
    ),
    # what is asked
    "accepted in percent": five(
        "[path]", "[accept]\ndeflection = 5.0\n[path]", "accept.deflection"
    ),
}
# Edits that are wrong in several ways at once: as many lines as there are faults.
SEVERAL = {
    "point of another body": 2,
    "moves that the mobility does not allow": 2,
    "density nowhere": 2,
    "poses beside a line": 3,
}


def text_of(robot, tmp_path):
    path = tmp_path / "sound.toml"
    write_template(path, robot)
    return path.read_text(encoding="utf-8")


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_file_is_refused_with_one_line_for_each_fault(name, tmp_path, capsys):
    wrong = WRONG[name]
    text = text_of(wrong.robot, tmp_path)
    assert wrong.old in text
    path = tmp_path / "wrong.toml"
    path.write_text(text.replace(wrong.old, wrong.new, 1), encoding="utf-8")
    assert cli.main(["check", str(path)]) == 2
    captured = capsys.readouterr()
    lines = captured.err.splitlines()
    assert captured.out == ""
    assert len(lines) == SEVERAL.get(name, 1), captured.err
    assert all(line.startswith(f"flexproof: {path}: ") for line in lines)
    for fragment in wrong.said:
        assert fragment in captured.err


def test_all_faults_are_told_at_once(tmp_path):
    text = text_of("five-bar", tmp_path)
    for name in ("unknown point", "axis of zero", "tool on ground", "count of zero", "up of zero"):
        text = text.replace(WRONG[name].old, WRONG[name].new, 1)
    path = tmp_path / "wrong.toml"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_robot(path)
    places = [fault.split(": ")[1].split(" ")[0] for fault in caught.value.faults]
    assert sorted(places) == sorted(
        ["bodies.rod2.from", "joints.pin.axis", "tool.body", "path.count", "bodies.rod1.up"]
    )


def test_built_in_robots_are_one_of_each_kind_and_the_papers():
    expected = {"3-rrr", "biglide", "delta", "five-bar", "hexapod", "ifw", "orthoglide"}
    assert set(built_in_robots()) == expected


def test_a_leg_stands_where_its_points_are_with_z_upwards():
    mechanism = load_robot("delta").mechanism
    arm = mechanism.bodies["arm1"]
    assert isinstance(arm.shape, Prism)
    assert arm.shape.length == pytest.approx(0.24, rel=1e-11)
    frame = mechanism.reference["arm1"]
    assert frame.position == pytest.approx([0.18, 0.0, 0.0])
    x, y, z = frame.rotation.T
    down = np.radians(20.0)
    assert x == pytest.approx([np.cos(down), 0.0, -np.sin(down)], abs=1e-11)
    assert y == pytest.approx([0.0, 1.0, 0.0], abs=1e-11)
    assert z == pytest.approx([np.sin(down), 0.0, np.cos(down)], abs=1e-11)
    tip = frame @ arm.interfaces["E1"]
    rod = mechanism.reference["rod1l"].position - [0.0, 0.05, 0.0]
    assert tip.position == pytest.approx(rod, abs=1e-11)


def test_a_rigid_body_and_a_given_leg_keep_their_numbers(tmp_path):
    text = text_of("five-bar", tmp_path)
    given = f'[bodies.rod1]\nfrom = "B1"\nto = "P"\nmass = 3.2\ncompliance = {EYE}'
    path = tmp_path / "given.toml"
    path.write_text(text.replace(ROD1, given), encoding="utf-8")
    rod = load_robot(path).mechanism.bodies["rod1"].shape
    assert isinstance(rod, Given)
    assert (rod.mass, rod.length) == (3.2, pytest.approx(np.hypot(0.35, 0.3)))
    assert np.array_equal(np.diag(rod.compliance), [1e-6] * 3 + [1e-5] * 3)
    platform = load_robot("delta").mechanism.bodies["platform"].shape
    assert isinstance(platform, Rigid)
    assert platform.mass == 0.6
    assert platform.inertia[2, 2] == 1.3e-3
    # From the body's origin, which is its first point.
    at_tool = load_robot("delta").mechanism.bodies["platform"].interfaces["P"].position
    assert platform.centre == pytest.approx(at_tool, abs=1e-15)
    assert np.linalg.norm(at_tool) > 0.01


def test_a_part_lies_where_it_is_placed(tmp_path):
    """File axes x and y along base y and −x, y not quite square to x, origin at B."""
    text = ROCKER.read_text(encoding="utf-8")
    place = 'place = { at = "B", x = [0.0, 2.0, 0.0], y = [-1.0, 0.1, 0.0] }\n'
    path = tmp_path / "placed.toml"
    path.write_text(text.replace('step = "rocker.step"\n', f'step = "rocker.step"\n{place}'))
    shutil.copy(ROCKER.with_name("rocker.step"), tmp_path)
    mechanism = load_robot(path).mechanism
    frame, body = mechanism.reference["rocker"], mechanism.bodies["rocker"]
    assert frame.position == pytest.approx([0.26, 0.0, 0.0])
    x, y, z = frame.rotation.T
    assert x == pytest.approx([0.0, 1.0, 0.0], abs=1e-15)
    assert y == pytest.approx([-1.0, 0.0, 0.0], abs=1e-15)
    assert z == pytest.approx([0.0, 0.0, 1.0], abs=1e-15)
    # C at (0.09, 0.18) in base axes.
    assert body.interfaces["C"].position == pytest.approx([0.18, 0.17, 0.0])


def test_a_path_is_a_line_a_grid_or_a_list(tmp_path):
    text = text_of("five-bar", tmp_path)
    path = tmp_path / "path.toml"
    grid = "from = [-0.1, 0.45]\nto = [0.1, 0.5]\ncounts = [3, 2]"
    path.write_text(text.replace(PATH, grid), encoding="utf-8")
    found = load_robot(path).mechanism.poses
    expected = [[-0.1, 0.45], [-0.1, 0.5], [0.0, 0.45], [0.0, 0.5], [0.1, 0.45], [0.1, 0.5]]
    assert found == pytest.approx(np.array(expected))
    path.write_text(text.replace("[path]", "[accept]\nmodes = 2\n[path]"), encoding="utf-8")
    assert load_robot(path).requirement.modes == 2
    assert load_robot(path).mechanism.poses[4] == pytest.approx([0.0, 0.5])


def test_two_points_of_a_slide_give_its_axis():
    mechanism = load_robot("hexapod").mechanism
    drive = next(joint for joint in mechanism.joints if joint.name == "drive1")
    leg = mechanism.reference["strut1"].rotation[:, 0]
    assert drive.axes[0] == pytest.approx(-leg, abs=1e-10)
    assert drive.drive is not None
    assert drive.drive.stiffness == 6.0e7


def test_the_biglide_written_out_in_the_guide_is_the_built_in_one(tmp_path):
    text = GUIDE.read_text(encoding="utf-8")
    path = tmp_path / "biglide.toml"
    path.write_text(
        re.search(r"^```toml written-out.toml\n(.*?)^```", text, MANY_LINES)[1], "utf-8"
    )
    found, expected = (load_robot(robot).mechanism for robot in (path, "biglide"))
    assert set(found.bodies) == set(expected.bodies)
    for name, body in expected.bodies.items():
        other = found.bodies[name]
        if isinstance(body.shape, Prism):
            for field in ("section", "material"):
                assert getattr(other.shape, field) == getattr(body.shape, field)
        assert set(other.interfaces) == set(body.interfaces)
        # The guide's points are given to twelve decimals.
        for point, place in body.interfaces.items():
            assert other.interfaces[point].position == pytest.approx(place.position, abs=1e-11)
        for part in ("position", "rotation"):
            values = getattr(expected.reference[name], part)
            assert getattr(found.reference[name], part) == pytest.approx(values, abs=1e-11)
    joints = {joint.name: joint for joint in found.joints}
    assert set(joints) == {joint.name for joint in expected.joints}
    for joint in expected.joints:
        other = joints[joint.name]
        for field in ("kind", "first", "second", "drive"):
            assert getattr(other, field) == getattr(joint, field)
        for field in ("axes", "compliance"):
            assert np.array_equal(getattr(other, field), getattr(joint, field))
    for field in ("body", "point", "mass"):
        assert getattr(found.tool, field) == getattr(expected.tool, field)
