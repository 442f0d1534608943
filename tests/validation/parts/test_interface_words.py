"""One name for a point of an interface: read, shown by `faces`, in the guide and in messages."""

import re
from pathlib import Path

import numpy as np
import pytest

from lumped.errors import InputError
from lumped.robot_file import load_robot
from meshes.part.interfaces import find_interfaces
from meshes.part.reading.read import read_part
from validation.parts.face_list import as_text
from validation.parts.request import interfaces_of

HOME = Path(__file__).resolve().parents[3]
ROCKER = HOME / "examples" / "rocker"


@pytest.fixture(scope="module")
def part():
    return read_part(ROCKER / "rocker.step")


def found(part, choice):
    wanted, points = interfaces_of([f"A = {choice}"])
    (interface,) = find_interfaces(part, wanted, points)
    return interface


def test_what_faces_prints_can_be_pasted(part):
    said = as_text(part)
    choices = re.findall(r"\{ (?:cylinder|faces) = .*? \}(?: \})?", said)
    by_cylinder, by_number = (found(part, choice) for choice in choices)
    assert set(by_number.faces) <= set(by_cylinder.faces)
    np.testing.assert_allclose(by_cylinder.on_axis, by_number.on_axis, atol=1e-9)


def test_every_choice_of_the_guide_is_read():
    guide = (HOME / "docs" / "guide" / "parts.md").read_text(encoding="utf-8")
    choices = re.findall(r"^\| `(\{.*\})` \|", guide, re.MULTILINE)
    assert len(choices) == 4
    for choice in choices:
        wanted, points = interfaces_of([f"A = {choice[:-1]}, point = [0.1, 0.2, 0.3] }}"])
        assert list(wanted) == ["A"]
        np.testing.assert_array_equal(points["A"], [0.1, 0.2, 0.3])


def test_a_point_beside_the_cylinder_tells_bores_of_one_radius_apart(part):
    """Both small bores of the rocker have 16 mm; the point is the interface's, too."""
    with pytest.raises(InputError, match=r"on different axes; say point = \[x, y, z\]"):
        found(part, "{ cylinder = { radius = 0.016 } }")
    for point in ([0.26, 0.0, 0.01], [0.09, 0.18, 0.01]):
        interface = found(part, f"{{ cylinder = {{ radius = 0.016 }}, point = {point} }}")
        np.testing.assert_array_equal(interface.point, point)
        np.testing.assert_allclose(interface.on_axis[:2], point[:2], atol=1e-9)


def test_another_name_is_refused_by_the_right_one(part, tmp_path):
    with pytest.raises(InputError, match=r"at.*point"):
        found(part, "{ cylinder = { radius = 0.016 }, at = [0.26, 0.0, 0.0] }")
    text = (ROCKER / "robot.toml").read_text(encoding="utf-8")
    own = "A = { cylinder = { radius = 0.022 }"
    assert own in text
    (tmp_path / "rocker.step").write_bytes((ROCKER / "rocker.step").read_bytes())
    robot = tmp_path / "robot.toml"
    robot.write_text(text.replace(own, f"{own}, point = [0.0, 0.0, 0.0]"), encoding="utf-8")
    with pytest.raises(InputError, match=r"interfaces\.A\.point: does not belong here"):
        load_robot(robot)
