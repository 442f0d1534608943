"""The designer's own loads and responses, [[loads]] and [[responses]]: read, or what is wrong.

Wrenches over the path come from a CSV file, one for every pose.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from lumped.acceptance.quantities import TEST_RESPONSE
from lumped.arrays import Array
from lumped.errors import InputError, collect_faults
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.load import Excitation, Load
from lumped.mechanism.mechanism import GROUND, MOVES, Mechanism
from lumped.robot_file.reading import TableRow, number_or_text, table_rows
from lumped.robot_file.rules.relations import NO_DIRECTION, named_twice
from lumped.robot_file.rules.rule import Number
from lumped.robot_file.rules.tables import COORDINATE, FORCE, MOST_POSES
from lumped.text import did_you_mean, shown

# m/s, m/s²: squares of smaller numbers are lost to rounding.
_SMALLEST = 1e-12
_WHAT = ("wrench", "gravity", "acceleration", "speed")
_COMPONENTS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
_NUMBER = "pose"


def loads_of(read: Sequence[Mapping[str, Any]], robot: Mechanism, folder: Path) -> tuple[Load, ...]:
    """The loads that tables without faults describe; their files lie in `folder`."""
    return tuple(
        Load(
            one["name"],
            _body_of(one, robot) or robot.tool.body,
            one["at"] or robot.tool.point,
            **{key: np.array(one[key]) for key in _WHAT if one[key] is not None},
            path_wrenches=_wrenches_over(folder / one["file"], robot) if one["file"] else None,
        )
        for one in read
    )


def load_faults(read: Sequence[Mapping[str, Any]], robot: Mechanism, folder: Path) -> Iterator[str]:
    """What is wrong with loads whose keys are sound, one line each."""
    yield from _names_twice(read, "loads")
    for number, one in enumerate(read, start=1):
        key = f"loads[{number}]"
        if all(one[what] is None for what in (*_WHAT, "file")):
            yield f"{key}: has no load; must have one of {', '.join(_WHAT)}, file"
        if one["file"] is not None:
            if one["wrench"] is not None:
                yield f"{key}.wrench: must be left out beside a file of wrenches"
            faults = collect_faults(
                lambda file: _wrenches_over(folder / file, robot), [one["file"]]
            )[1]
            yield from (f"{key}.file: {fault}" for fault in faults)
        for what in ("at", "body"):
            if one[what] is not None and one["wrench"] is None and one["file"] is None:
                yield f"{key}.{what}: must be left out without a wrench, which acts there"
        if one["at"] is not None and _body_of(one, robot) is None:
            bodies = robot.bodies if one["body"] is None else {one["body"]: None}
            held = dict.fromkeys(
                p for name in bodies if name in robot.bodies for p in robot.bodies[name].interfaces
            )
            advice = did_you_mean(one["at"], held, otherwise=f": {', '.join(held) or 'none'}")
            of = f"{one['body']}" if one["body"] else "a body"
            yield f"{key}.at = {shown(one['at'])}: must be a point of {of}{advice}"
        elif one["body"] is not None and one["at"] is None:
            yield f"{key}.body: must be left out without `at`, the point of it"
        for what in ("acceleration", "speed"):
            for axis, value in zip(MOVES, one[what] or (), strict=False):
                if value and axis not in robot.tool.moves:
                    yield (
                        f"{key}.{what} = {list(one[what])}: the tool does not move along {axis}; "
                        "must be 0 there"
                    )
                elif 0.0 < abs(value) < _SMALLEST:
                    said = f"must be 0 or at least {_SMALLEST:g} in size along {axis}"
                    yield f"{key}.{what} = {list(one[what])}: {said}"


def _body_of(one: Mapping[str, Any], robot: Mechanism) -> str | None:
    """The body that a load takes hold of; None where none has such a point.

    The one that is named, else the tool's, else the first in the file.
    """
    first = (robot.tool.body, *(name for name in robot.bodies if name != GROUND))
    names = first if one["body"] is None else (one["body"],)
    point = one["at"] or robot.tool.point
    held = {name: robot.bodies[name].interfaces for name in names if name in robot.bodies}
    return next((name for name, points in held.items() if point in points), None)


def excitations_of(read: Sequence[Mapping[str, Any]]) -> tuple[Excitation, ...]:
    """The excitations that tables without faults describe."""
    return tuple(
        Excitation(
            one["name"],
            np.array(one["direction"]) / np.linalg.norm(one["direction"]),
            *(one[key] for key in ("from", "to", "count", "at")),
        )
        for one in read
    )


def response_faults(read: Sequence[Mapping[str, Any]], robot: Mechanism) -> Iterator[str]:
    """What is wrong with responses of a robot whose keys are sound, one line each."""
    yield from _names_twice(read, "responses")
    for number, one in enumerate(read, start=1):
        key = f"responses[{number}]"
        if one["name"] == TEST_RESPONSE:
            yield f"{key}.name = {shown(one['name'])}: must be another; modal tests are called so"
        if np.linalg.norm(one["direction"]) < NO_DIRECTION:
            yield f"{key}.direction = {list(one['direction'])}: must not be zero"
        if one["to"] <= one["from"]:
            yield f"{key}.to = {one['to']!r}: must be above {key}.from, {one['from']!r} Hz"
        elif one["at"] is not None and not one["from"] <= one["at"] <= one["to"]:
            yield f"{key}.at = {one['at']!r}: must be between {key}.from and {key}.to"
    if read and not robot.is_damped:
        yield (
            "responses: nothing damps them, their peaks have no bound; must have [damping] ratio, "
            "or loss of a material, a joint or a drive"
        )


def _names_twice(read: Sequence[Mapping[str, Any]], table: str) -> Iterator[str]:
    for fault in named_twice([one["name"] for one in read], f"{table}[{{}}].name"):
        yield f"{fault}; must be named once"


def _wrenches_over(path: Path, robot: Mechanism) -> Array:
    """A wrench (p×6, N and N m, base axes) for every pose of the robot's path.

    Columns Fx Fy Fz Mx My Mz; `pose`, its number along the path from 1, or its coordinates under
    the names of the tool's moves. Others are left alone. Raises InputError with one line per fault.
    """
    rows = table_rows(path, "a CSV file of wrenches", _COMPONENTS, MOST_POSES)
    headings = rows[0].cells
    by_number = {_NUMBER: Number(least=1, most=len(robot.poses), whole=True)}
    coordinate = COORDINATE.in_unit(robot.lengths, robot.tool.moves)
    where = by_number if _NUMBER in headings else dict.fromkeys(robot.tool.moves, coordinate)
    if lacking := [name for name in where if name not in headings]:
        raise InputError(
            f"{path}: lacks the column {_NUMBER} (numbers of poses), or {', '.join(lacking)}"
        )
    found: dict[int, Array] = {}
    _, faults = collect_faults(partial(_take, found, robot, where), rows)
    numbers = [robot.pose_number(pose) for pose in robot.poses]
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
    typed = np.array([values[name] for name in where], dtype=float)
    numbered = _NUMBER in where
    pose = robot.poses[int(values[_NUMBER]) - 1] if numbered else robot.in_metres(typed)
    number, said = robot.pose_number(pose), shown_pose(robot, pose)
    if number is None:
        raise InputError(f"{row.place}: {said}: must be a pose of the path")
    wrench = np.array([values[name] for name in _COMPONENTS], dtype=float)
    if (found.setdefault(number, wrench) != wrench).any():
        raise InputError(f"{row.place}: {said}: differs from the wrench of an earlier line")
