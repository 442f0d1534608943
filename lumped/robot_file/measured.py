"""Measured values of a robot file, or beside it."""

from dataclasses import replace
from pathlib import Path

from lumped.acceptance.measured import pose_faults, read_measured
from lumped.errors import InputError
from lumped.robot_file.load import RobotFile


def with_measured(robot_file: RobotFile, path: Path) -> RobotFile:
    """The robot file with the measured values of a CSV file after its own.

    Raises InputError with one line per fault, where the robot cannot be at a pose too.
    """
    robot, ones = robot_file.described, read_measured(path)
    faults = [
        fault
        for number, one in enumerate(ones, start=2)
        for fault in pose_faults(robot, one, f"{path}: line {number}")
    ]
    if faults:
        raise InputError(faults)
    return replace(robot_file, measured=(*robot_file.measured, *ones))
