"""Robot files of schema 2: what sound ones describe."""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest

from lumped.legs import ConstantLeg
from lumped.mechanism.body import ByCylinder, ByFaces, ByName, ByPlane, PartInterface, Rigid
from lumped.robot_file import load_robot
from lumped.robot_file.mechanism.build import interface_of
from lumped.robot_file.rules.tables import INTERFACE

ROCKER = Path(__file__).parents[3] / "examples" / "rocker" / "robot.toml"
GUIDE = Path(__file__).resolve().parents[3] / "docs" / "guide" / "mechanisms.md"
MANY_LINES = re.MULTILINE | re.DOTALL
PATH = "from = [-0.20, 0.45]\nto = [0.20, 0.55]\ncount = 9"


def test_a_leg_stands_where_its_points_are_with_z_upwards():
    mechanism = load_robot("delta").mechanism
    arm = mechanism.bodies["arm1"]
    assert isinstance(arm.shape, ConstantLeg)
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


def test_a_rigid_body_keeps_its_numbers():
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


def test_a_path_is_a_line_a_grid_or_a_list(tmp_path):
    text = load_robot("five-bar").text
    path = tmp_path / "path.toml"
    grid = "from = [-0.1, 0.45]\nto = [0.1, 0.5]\ncounts = [3, 2]"
    path.write_text(text.replace(PATH, grid), encoding="utf-8")
    found = load_robot(path).mechanism.poses
    expected = [[-0.1, 0.45], [-0.1, 0.5], [0.0, 0.45], [0.0, 0.5], [0.1, 0.45], [0.1, 0.5]]
    assert found == pytest.approx(np.array(expected))
    path.write_text(text.replace("[path]", "[accept]\nmodes = 2\n[path]"), encoding="utf-8")
    assert load_robot(path).requirement.modes == 2
    line = load_robot(path).mechanism.poses[[0, 4, 8]]
    assert line == pytest.approx(np.array([[-0.2, 0.45], [0.0, 0.5], [0.2, 0.55]]))


def test_two_points_of_a_slide_give_its_axis():
    mechanism = load_robot("hexapod").mechanism
    drive = next(joint for joint in mechanism.joints if joint.name == "drive1")
    leg = mechanism.reference["strut1"].rotation[:, 0]
    assert drive.axes[0] == pytest.approx(-leg, abs=1e-10)
    assert drive.drive is not None
    assert drive.drive.stiffness == 6.0e7


def numbers(mechanism):
    """Where everything is and what holds it, by name."""
    found = {"tool": [mechanism.tool.mass]}
    for name, body in mechanism.bodies.items():
        for point, place in body.interfaces.items():
            found[name, point] = (mechanism.reference[name] @ place).position
        found[name] = mechanism.reference[name].rotation
        if isinstance(body.shape, ConstantLeg):
            found[name, "beam"] = list(vars(body.shape.timoshenko).values())
    for joint in mechanism.joints:
        found[joint.name] = joint.axes
        found[joint.name, joint.kind, joint.first, joint.second, joint.drive] = (
            [] if joint.compliance is None else joint.compliance
        )
    return found


def test_the_biglide_written_out_in_the_guide_is_the_built_in_one(tmp_path):
    text = GUIDE.read_text(encoding="utf-8")
    path = tmp_path / "biglide.toml"
    path.write_text(
        re.search(r"^```toml written-out.toml\n(.*?)^```", text, MANY_LINES)[1], "utf-8"
    )
    found, expected = (numbers(load_robot(robot).mechanism) for robot in (path, "biglide"))
    assert set(found) == set(expected)
    for key, values in expected.items():
        # The guide's points are given to twelve decimals.
        assert found[key] == pytest.approx(np.array(values), rel=1e-12, abs=1e-11), key
