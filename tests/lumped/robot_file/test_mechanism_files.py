"""Robot files of schema 2: what sound ones describe."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from written_robot import robot_of

from lumped.legs import ConstantLeg
from lumped.mechanism.body import ByCylinder, ByFaces, ByName, ByPlane, PartInterface, Rigid
from lumped.robot_file import load_robot
from lumped.robot_file.mechanism.build import interface_of
from lumped.robot_file.rules.tables import INTERFACE

ROOT = Path(__file__).parents[3]
ROCKER = ROOT / "examples" / "rocker" / "robot.toml"
PATH = "from = [-0.20, 0.45]\nto = [0.20, 0.55]\ncount = 9"


def test_legs_and_rigid_bodies_stand_where_their_points_are():
    mechanism = load_robot("delta").mechanism
    arm, frame = mechanism.bodies["arm1"], mechanism.reference["arm1"]
    assert isinstance(arm.shape, ConstantLeg)
    assert arm.shape.length == pytest.approx(0.24, rel=1e-11)
    assert frame.position == pytest.approx([0.18, 0.0, 0.0])
    # 20° below the level, z upwards.
    c, s = np.cos(np.radians(20.0)), np.sin(np.radians(20.0))
    axes = np.array([[c, 0.0, -s], [0.0, 1.0, 0.0], [s, 0.0, c]])
    assert pytest.approx(axes, abs=1e-11) == frame.rotation.T
    rod = mechanism.reference["rod1l"].position - [0.0, 0.05, 0.0]
    assert (frame @ arm.interfaces["E1"]).position == pytest.approx(rod, abs=1e-11)
    platform = mechanism.bodies["platform"]
    assert isinstance(platform.shape, Rigid)
    assert (platform.shape.mass, platform.shape.inertia[2, 2]) == (0.6, 1.3e-3)
    # From the body's origin, which is its first point.
    at_tool = platform.interfaces["P"].position
    assert platform.shape.centre == pytest.approx(at_tool, abs=1e-15)
    assert np.linalg.norm(at_tool) > 0.01


def test_a_part_lies_where_it_is_placed(tmp_path):
    """File axes x and y along base y and −x, y not quite square to x, origin at B."""
    text = ROCKER.read_text(encoding="utf-8")
    place = 'place = { at = "B", x = [0.0, 2.0, 0.0], y = [-1.0, 0.1, 0.0] }\n'
    shutil.copy(ROCKER.with_name("rocker.step"), tmp_path)
    step = 'step = "rocker.step"\n'
    mechanism = robot_of(text.replace(step, step + place), tmp_path).mechanism
    frame, body = mechanism.reference["rocker"], mechanism.bodies["rocker"]
    assert frame.position == pytest.approx([0.26, 0.0, 0.0])
    axes = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    assert pytest.approx(axes, abs=1e-15) == frame.rotation.T
    # C at (0.09, 0.18) in base axes.
    assert body.interfaces["C"].position == pytest.approx([0.18, 0.17, 0.0])


@pytest.mark.parametrize(
    ("table", "expected"),
    [
        ({"faces": [3, 5], "coupling": "pin"}, PartInterface(ByFaces((3, 5)), "pin")),
        ({"name": "bore"}, PartInterface(ByName("bore"))),
        (
            {"cylinder": {"radius": 0.02, "axis": [0, 0, 1], "tolerance": 1e-3}},
            PartInterface(ByCylinder(0.02, (0.0, 0.0, 1.0), None, 1e-3)),
        ),
        (
            {"plane": {"normal": [1, 0, 0], "point": [0, 0, 2]}, "coupling": "average"},
            PartInterface(ByPlane((1.0, 0.0, 0.0), (0.0, 0.0, 2.0)), "average"),
        ),
    ],
)
def test_faces_are_taken_hold_of_in_four_ways(table, expected):
    assert interface_of(INTERFACE.read(table)) == expected


def test_a_path_is_a_line_or_a_grid(tmp_path):
    text = load_robot("five-bar").text.replace("[path]", "[accept]\nmodes = 2\n[path]")
    line = robot_of(text, tmp_path)
    assert line.requirement.modes == 2
    expected = np.array([[-0.2, 0.45], [0.0, 0.5], [0.2, 0.55]])
    assert line.mechanism.poses[[0, 4, 8]] == pytest.approx(expected)
    grid = text.replace(PATH, "from = [-0.1, 0.45]\nto = [0.1, 0.5]\ncounts = [3, 2]")
    found = robot_of(grid, tmp_path).mechanism.poses
    expected = [[-0.1, 0.45], [-0.1, 0.5], [0.0, 0.45], [0.0, 0.5], [0.1, 0.45], [0.1, 0.5]]
    assert found == pytest.approx(np.array(expected))


def test_two_points_of_a_slide_give_its_axis():
    mechanism = load_robot("hexapod").mechanism
    drive = next(joint for joint in mechanism.joints if joint.name == "drive1")
    leg = mechanism.reference["strut1"].rotation[:, 0]
    assert drive.axes[0] == pytest.approx(-leg, abs=1e-10)
    assert drive.drive.stiffness == 6.0e7


def numbers(mechanism):
    """Where everything is and what holds it, by name."""
    found = {"tool": [mechanism.tool.mass]}
    for name, body in mechanism.bodies.items():
        found[name] = mechanism.reference[name].rotation
        for point, place in body.interfaces.items():
            found[name, point] = (mechanism.reference[name] @ place).position
        if isinstance(body.shape, ConstantLeg):
            found[name, "beam"] = list(vars(body.shape.timoshenko).values())
    for joint in mechanism.joints:
        found[joint.name] = joint.axes
        key = (joint.name, joint.kind, joint.first, joint.second, joint.drive)
        found[key] = [] if joint.compliance is None else joint.compliance
    return found


def test_the_biglide_written_out_in_the_guide_is_the_built_in_one(tmp_path):
    guide = (ROOT / "docs" / "guide" / "mechanisms.md").read_text(encoding="utf-8")
    text = re.search(r"(?ms)^```toml written-out.toml\n(.*?)^```", guide)[1]
    robots = (robot_of(text, tmp_path), load_robot("biglide"))
    found, expected = (numbers(robot.mechanism) for robot in robots)
    assert set(found) == set(expected)
    for key, values in expected.items():
        # The guide's points are given to twelve decimals.
        assert found[key] == pytest.approx(np.array(values), rel=1e-12, abs=1e-11), key
