"""Robots and mechanisms from the text of a robot file."""

import tomllib
from pathlib import Path

from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file import RobotFile, load_robot
from lumped.robot_file.load import described_by


def robot_of(text: str, folder: Path) -> RobotFile:
    """Robot file with this text, written into `folder` and read."""
    path = folder / "robot.toml"
    path.write_text(text, encoding="utf-8")
    return load_robot(path)


def described(text: str) -> Mechanism:
    """Mechanism described by the text, without a file."""
    return described_by(tomllib.loads(text), Path())[0]
