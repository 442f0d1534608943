"""A robot from the text of its file."""

from pathlib import Path

from lumped.robot_file import RobotFile, load_robot


def robot_of(text: str, folder: Path) -> RobotFile:
    """The robot that the text describes, written into the folder and read."""
    path = folder / "robot.toml"
    path.write_text(text, encoding="utf-8")
    return load_robot(path)
