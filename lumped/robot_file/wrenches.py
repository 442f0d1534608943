"""Wrenches over the path from a CSV file, one for every pose, or what is wrong with the file."""

from collections.abc import Mapping
from functools import partial
from pathlib import Path

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError, each
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import Mechanism
from lumped.robot_file.reading import TableRow, number_or_text, table_rows
from lumped.robot_file.rules.rule import Number
from lumped.robot_file.rules.tables import COORDINATE, FORCE, MOST_POSES

_COMPONENTS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
_NUMBER = "pose"


def wrenches_over(path: Path, robot: Mechanism) -> Array:
    """A wrench (p×6, N and N m, base axes) for every pose of the robot's path.

    Columns Fx Fy Fz Mx My Mz; `pose`, its number along the path from 1, or its coordinates under
    the names of the tool's moves. Others are left alone. Raises InputError with one line per fault.
    """
    rows = table_rows(path, "a CSV file of wrenches", _COMPONENTS, MOST_POSES)
    headings = rows[0].cells
    by_number = {_NUMBER: Number(least=1, most=len(robot.poses), whole=True)}
    where = by_number if _NUMBER in headings else dict.fromkeys(robot.tool.moves, COORDINATE)
    if lacking := [name for name in where if name not in headings]:
        raise InputError(
            f"{path}: lacks the column {_NUMBER} (numbers of poses), or {', '.join(lacking)}"
        )
    found: dict[int, Array] = {}
    _, faults = each(partial(_take, found, robot, where), rows)
    numbers = [robot.number_of(pose) for pose in robot.poses]
    faults = faults or [
        f"{path}: no wrench for pose {place}, {shown_pose(robot, pose)}; must have one for every "
        "pose of the path"
        for place, (number, pose) in enumerate(zip(numbers, robot.poses, strict=True), start=1)
        if number not in found
    ]
    if faults:
        raise InputError(faults)
    return np.array([found[number] for number in numbers if number is not None])


def _take(
    found: dict[int, Array], robot: Mechanism, where: Mapping[str, Number], row: TableRow
) -> None:
    """Put the wrench of a row with that of its pose; raises InputError where there is another."""
    rules = {**where, **dict.fromkeys(_COMPONENTS, FORCE)}
    values = {name: number_or_text(row.cells[name]) for name in rules}
    if faults := [
        fault
        for name, rule in rules.items()
        for fault in rule.faults(values[name], f"{row.place}, column {name}")
    ]:
        raise InputError(faults)
    pose = np.array([values[name] for name in where], dtype=float)
    if _NUMBER in where:
        pose = robot.poses[int(values[_NUMBER]) - 1]
    number, said = robot.number_of(pose), shown_pose(robot, pose)
    if number is None:
        raise InputError(f"{row.place}: {said}: must be a pose of the path")
    wrench = np.array([values[name] for name in _COMPONENTS], dtype=float)
    if (found.setdefault(number, wrench) != wrench).any():
        raise InputError(f"{row.place}: {said}: differs from the wrench of an earlier line")
