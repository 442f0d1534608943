"""Commands `kinematics`, `check` and `new` on mechanisms: text, JSON, picture, exit codes."""

import re

import matplotlib.image
import numpy as np
import pytest

from lumped.robot_file import load_robot
from validation import cli

# Mobility, idle motions, constraints and redundant constraints, counted by hand (Kutzbach).
COUNTS = {"delta": (9, 6, 69, 0), "biglide": (2, 0, 31, 3)}


@pytest.mark.parametrize("robot", COUNTS)
def test_json_has_mobility_and_loops(robot, command):
    """Numbers of free and idle motions, constraints and redundant ones; loops close to 1e-12."""
    document = command.json("kinematics", robot)
    names = ("mobility", "idle", "constraints", "redundant")
    assert tuple(document["reference"][name] for name in names) == COUNTS[robot]
    residuals, at_limit = (
        [result[key] for result in document["results"]] for key in ("residual", "at_limit")
    )
    assert max(residuals) <= 1e-12
    assert at_limit == [robot == "biglide" and i in {0, 8} for i in range(9)]


@pytest.mark.parametrize(
    ("robot", "joint", "pose", "pose_text", "factor", "unit"),
    [
        ("five-bar", "motor1", "-0.1,0.5", "x = -0.1 m, y = 0.5 m", 180.0 / np.pi, "°"),
        ("biglide", "drive1", "0.2", "x = 0.2 m", 1e3, " mm"),
    ],
)
def test_text_has_degrees_and_millimetres(robot, joint, pose, pose_text, factor, unit, command):
    """Joint coordinates of the JSON output (rad, m), times 180/π or 1000."""
    arguments = ("kinematics", robot, "--pose", pose)
    (value,) = command.json(*arguments)["results"][0]["coordinates"][joint]
    assert abs(value) > 1e-3
    text = command.output(*arguments)
    assert f"pose 1: {pose_text}" in text
    (joint_line,) = (line for line in text.splitlines() if f"  {joint} " in f"{line} ")
    assert f"{factor * value:+.3f}{unit}" in joint_line


def test_invalid_poses_have_messages(capsys):
    """Wrong number of coordinates and no numbers: one line each."""
    assert cli.main(["kinematics", "five-bar", "--pose", "1,2,3", "--pose", "a,b"]) == 2
    faults = capsys.readouterr().err.splitlines()
    assert len(faults) == 2
    assert "--pose 1,2,3: must be x,y as finite numbers separated by commas" in faults[0]


def test_many_poses_have_time_estimate(monkeypatch, capsys):
    """Before long computations, on stderr."""
    monkeypatch.setattr("validation.kinematics.poses._SILENT_SECONDS", 0.0)
    assert cli.main(["kinematics", "five-bar", *["--pose=0,0.5"] * 11]) == 0
    assert capsys.readouterr().err.startswith("flexproof: 11 poses, about ")


@pytest.mark.parametrize(
    "robot", ["biglide", "five-bar", "3-rrr", "delta", "orthoglide", "hexapod"]
)
def test_new_keeps_existing_robot_file(robot, tmp_path, command):
    """A new file is valid, with comments, and its path is within reach."""
    path = tmp_path / "a\nforged.toml"
    (line,) = command.output("new", "--type", robot, path).splitlines()
    assert "a\\nforged.toml written" in line
    content = path.read_text(encoding="utf-8")
    assert "#" in content
    report = command.output("check", path)
    assert re.search("(?s)valid.*all 9 poses of its path within reach", report)
    assert "exists already" in command.error_line("new", path)
    assert path.read_text(encoding="utf-8") == content


def test_picture_has_leg_and_drive_colours(tmp_path, command):
    """Shares of blue, red and white pixels."""
    path = tmp_path / "robot.png"
    pose = ",".join(f"{value:g}" for value in load_robot("five-bar").mechanism.reference_pose)
    command.output("kinematics", "five-bar", f"--pose={pose}", "--picture", path)
    pixels = matplotlib.image.imread(path)[:, :, :3]
    # Blue legs and orange drives each cover a part of the picture. Most of it is white.
    red, _, blue = np.moveaxis(pixels, 2, 0)
    assert (blue > red + 0.05).mean() > 0.01
    assert (red > blue + 0.4).mean() > 0.0005
    assert (pixels.min(axis=2) > 0.99).mean() > 0.4
