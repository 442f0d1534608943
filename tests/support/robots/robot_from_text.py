"""A robot from the text of its file."""

import tomllib
from pathlib import Path

from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file import RobotFile, load_robot
from lumped.robot_file.load import described_by


def robot_of(text: str, folder: Path) -> RobotFile:
    """The robot that the text describes, written into the folder and read."""
    path = folder / "robot.toml"
    path.write_text(text, encoding="utf-8")
    return load_robot(path)


def described(text: str) -> Mechanism:
    """The mechanism that the text describes, no file being read."""
    return described_by(tomllib.loads(text), Path())[0]
