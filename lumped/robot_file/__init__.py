"""Robot files: TOML in SI units, read into a robot or refused with a list of all faults.

Input: a path or the name of a built-in robot. Output: the robot, the tables of its file, and the
corrections of misprints in the source of its data.
"""

from lumped.robot_file.load import (
    RobotFile,
    as_printed,
    built_in_robots,
    load_robot,
    robot_of,
    write_template,
)

__all__ = [
    "RobotFile",
    "as_printed",
    "built_in_robots",
    "load_robot",
    "robot_of",
    "write_template",
]
