"""Loads and harmonic responses of a robot file: tables [[loads]] and [[responses]].

A CSV file can contain a wrench for each pose of the path.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from lumped.acceptance.quantities import TEST_RESPONSE
from lumped.arrays import Array
from lumped.errors import InputError, collect_faults
from lumped.mechanism.body import Rigid
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.load import AppliedLine, Excitation, LineLoad, Load, Pressure
from lumped.mechanism.mechanism import GROUND, MOVES, Mechanism
from lumped.models.bodies import legs_of
from lumped.robot_file.mechanism.build import selection_of
from lumped.robot_file.reading import TableRow, number_or_text, table_rows
from lumped.robot_file.rules.relations import NO_DIRECTION, interface_faults, named_twice
from lumped.robot_file.rules.rule import Number
from lumped.robot_file.rules.tables import COORDINATE, FORCE, MOST_POSES
from lumped.text import did_you_mean, shown

# Smallest speed (m/s) and acceleration (m/s²). Squares of smaller numbers are round-off.
_SMALLEST = 1e-12
_LOAD_KEYS = ("wrench", "gravity", "acceleration", "speed")
_KINDS = (*_LOAD_KEYS, "file", "lines", "pressures")
_COMPONENTS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
_NUMBER = "pose"
# Excess over the length of a leg that is rounding of its points.
_ROUND_OFF = 1e-9


def loads_of(read: Sequence[Mapping[str, Any]], robot: Mechanism, folder: Path) -> tuple[Load, ...]:
    """Loads described by tables without faults. Paths of files are relative to `folder`."""
    return tuple(
        Load(
            table["name"],
            _body_of(table, robot) or robot.tool.body,
            table["at"] or robot.tool.point,
            **{key: np.array(table[key]) for key in _LOAD_KEYS if table[key] is not None},
            path_wrenches=_wrenches_over(folder / table["file"], robot) if table["file"] else None,
            lines=tuple(_line_of(line, robot) for line in table["lines"] or ()),
            pressures=tuple(
                Pressure(on_faces["body"], selection_of(on_faces), on_faces["pressure"])
                for on_faces in table["pressures"] or ()
            ),
        )
        for table in read
    )


def load_faults(read: Sequence[Mapping[str, Any]], robot: Mechanism, folder: Path) -> Iterator[str]:
    """Faults of tables [[loads]] whose keys have been checked, one line each."""
    yield from _names_twice(read, "loads")
    for number, table in enumerate(read, start=1):
        key = f"loads[{number}]"
        if all(table[key_name] is None for key_name in _KINDS):
            yield f"{key}: has no load; must have one of {', '.join(_KINDS)}"
        for line_number, line in enumerate(table["lines"] or (), start=1):
            yield from _line_faults(line, f"{key}.lines[{line_number}]", robot)
        for pressure_number, on_faces in enumerate(table["pressures"] or (), start=1):
            yield from _pressure_faults(on_faces, f"{key}.pressures[{pressure_number}]", robot)
        if table["file"] is not None:
            if table["wrench"] is not None:
                yield f"{key}.wrench: must be left out, because a file of wrenches is given"
            faults = collect_faults(
                lambda file: _wrenches_over(folder / file, robot), [table["file"]]
            )[1]
            yield from (f"{key}.file: {fault}" for fault in faults)
        for key_name in ("at", "body"):
            if table[key_name] is not None and table["wrench"] is None and table["file"] is None:
                yield f"{key}.{key_name}: must be left out if no wrench acts there"
        yield from _point_faults(table, key, "at", robot)
        for key_name in ("acceleration", "speed"):
            for axis, value in zip(MOVES, table[key_name] or (), strict=False):
                if value and axis not in robot.tool.moves:
                    yield (
                        f"{key}.{key_name} = {list(table[key_name])}: the tool does not move "
                        f"along {axis}; must be 0 there"
                    )
                elif 0.0 < abs(value) < _SMALLEST:
                    required = f"must be 0 or at least {_SMALLEST:g} in size along {axis}"
                    yield f"{key}.{key_name} = {list(table[key_name])}: {required}"


def _line_of(table: Mapping[str, Any], robot: Mechanism) -> AppliedLine:
    """Load along a leg from a table without faults."""
    length = float(legs_of(robot)[table["leg"]].length)
    first = np.array(table["wrench"])
    last = first if table["end_wrench"] is None else np.array(table["end_wrench"])
    start, stop = table["from"] or 0.0, length if table["to"] is None else table["to"]
    return AppliedLine(
        table["leg"], LineLoad(start, min(stop, length), first, last), table["axes"] == "base"
    )


def _line_faults(table: Mapping[str, Any], key: str, robot: Mechanism) -> Iterator[str]:
    """Faults of a load along a leg."""
    legs = legs_of(robot)
    leg = legs.get(table["leg"])
    if leg is None:
        advice = did_you_mean(table["leg"], legs, otherwise=f": {', '.join(legs) or 'none'}")
        yield (
            f"{key}.leg = {shown(table['leg'])}: must be a leg of constant section, or with a "
            f"6×6{advice}"
        )
        return
    start, stop = table["from"] or 0.0, leg.length if table["to"] is None else table["to"]
    lengths = robot.lengths
    if stop > leg.length * (1.0 + _ROUND_OFF):
        yield (
            f"{key}.to = {lengths.of(stop)!r}: must be at most the leg's length, "
            f"{lengths.shown(leg.length)}"
        )
    elif start >= stop:
        yield f"{key}.from = {lengths.of(start)!r}: must be below {lengths.shown(stop)}, its end"


def _pressure_faults(table: Mapping[str, Any], key: str, robot: Mechanism) -> Iterator[str]:
    """Faults of a pressure on faces of a part."""
    name, parts = table["body"], robot.parts
    if name not in parts:
        body = robot.bodies.get(name)
        instead = "wrench" if body is not None and isinstance(body.shape, Rigid) else "lines"
        reason = "" if body is None else f"; this body has no faces, load it by {instead}"
        advice = did_you_mean(name, parts, otherwise=f": {', '.join(parts) or 'none'}")
        yield f"{key}.body = {shown(name)}: must be a CAD part (step or mesh){advice}{reason}"
    yield from interface_faults(dict(table), key)


def _point_faults(
    table: Mapping[str, Any], key: str, point_key: str, robot: Mechanism
) -> Iterator[str]:
    """Faults of a point under `point_key`, and of the `body` to which the point belongs."""
    name, owner = table[point_key], table["body"]
    if name is None:
        if owner is not None:
            yield (
                f"{key}.body: must be left out without `{point_key}`, because it names the "
                "body of that point"
            )
    elif _body_of(table, robot, point_key) is None:
        bodies = robot.bodies if owner is None else {owner: None}
        points = dict.fromkeys(
            p for body in bodies if body in robot.bodies for p in robot.bodies[body].interfaces
        )
        advice = did_you_mean(name, points, otherwise=f": {', '.join(points) or 'none'}")
        yield f"{key}.{point_key} = {shown(name)}: must be a point of {owner or 'a body'}{advice}"


def _body_of(table: Mapping[str, Any], robot: Mechanism, point_key: str = "at") -> str | None:
    """Name of the body that has the point of a table. None if no body has such a point.

    The body is the one named in the table, otherwise the body of the tool, otherwise the first body
    in the file that has the point.
    """
    first = (robot.tool.body, *(name for name in robot.bodies if name != GROUND))
    names = first if table["body"] is None else (table["body"],)
    point = table[point_key] or robot.tool.point
    interfaces = {name: robot.bodies[name].interfaces for name in names if name in robot.bodies}
    return next((name for name, points in interfaces.items() if point in points), None)


def excitations_of(read: Sequence[Mapping[str, Any]], robot: Mechanism) -> tuple[Excitation, ...]:
    """Excitations described by tables without faults."""
    excitations = []
    for table in read:
        force, motion = _force_of(table), _motion_of(table)
        loaded = None if force["at"] is None else (_body_of(force, robot) or "", force["at"])
        moved_point = loaded
        if motion["point"] is not None:
            moved_point = _body_of(motion, robot, "point") or "", motion["point"]
        tool = robot.tool.body, robot.tool.point
        direction = motion["direction"]
        excitations.append(
            Excitation(
                table["name"],
                _unit(table["direction"]),
                table["from"],
                table["to"],
                table["count"],
                at=_frequency_of(table),
                loaded=None if loaded == tool else loaded,
                moved=None if moved_point == tool else moved_point,
                moved_direction=None if direction is None else _unit(direction),
            )
        )
    return tuple(excitations)


def _unit(direction: Sequence[float]) -> Array:
    vector = np.array(direction)
    return np.asarray(vector / np.linalg.norm(vector))


def _force_of(table: Mapping[str, Any]) -> Mapping[str, Any]:
    """Point and body on which the force of a response acts.

    The key `at` is a point, or a frequency if it is a number.
    """
    point = table["at"] if isinstance(table["at"], str) else None
    return {"at": point, "body": table["body"]}


def _motion_of(table: Mapping[str, Any]) -> Mapping[str, Any]:
    """Point, body and direction of the displacement of a response."""
    motion = table["of"]
    return (
        motion
        if isinstance(motion, Mapping)
        else {"point": motion, "body": None, "direction": None}
    )


def _frequency_of(table: Mapping[str, Any]) -> float | None:
    """Frequency (Hz) at which a response is judged, besides its peak."""
    number = table["at"] if isinstance(table["at"], float) else None
    return number if table["frequency"] is None else table["frequency"]


def response_faults(read: Sequence[Mapping[str, Any]], robot: Mechanism) -> Iterator[str]:
    """Faults of tables [[responses]] whose keys have been checked, one line each."""
    yield from _names_twice(read, "responses")
    for number, table in enumerate(read, start=1):
        key = f"responses[{number}]"
        if table["name"] == TEST_RESPONSE:
            yield f"{key}.name = {shown(table['name'])}: must differ; modal tests have this name"
        directions = {
            "direction": table["direction"],
            "of.direction": _motion_of(table)["direction"],
        }
        for name, direction in directions.items():
            if direction is not None and np.linalg.norm(direction) < NO_DIRECTION:
                yield f"{key}.{name} = {list(direction)}: must not be zero"
        yield from _point_faults(_force_of(table), key, "at", robot)
        if isinstance(table["of"], str):
            yield from _point_faults({"of": table["of"], "body": None}, key, "of", robot)
        elif table["of"] is not None:
            yield from _point_faults(table["of"], f"{key}.of", "point", robot)
        frequency = _frequency_of(table)
        name = "at" if table["frequency"] is None else "frequency"
        if isinstance(table["at"], float) and table["frequency"] is not None:
            yield f"{key}.at = {table['at']!r}: must be a point, because {key}.frequency is given"
        if table["to"] <= table["from"]:
            yield f"{key}.to = {table['to']!r}: must be above {key}.from, {table['from']!r} Hz"
        elif frequency is not None and not table["from"] <= frequency <= table["to"]:
            yield f"{key}.{name} = {frequency!r}: must be between {key}.from and {key}.to"
    if read and not robot.is_damped:
        yield (
            "responses: nothing damps them, their peaks have no bound; must have [damping] ratio, "
            "or loss of a material, a joint or a drive, or damping of a joint or a drive"
        )


def _names_twice(read: Sequence[Mapping[str, Any]], array_name: str) -> Iterator[str]:
    for fault in named_twice([table["name"] for table in read], f"{array_name}[{{}}].name"):
        yield f"{fault}; must be named once"


def _wrenches_over(path: Path, robot: Mechanism) -> Array:
    """Wrenches (p×6, in N and N m, base axes) for all p poses of the robot's path, from a CSV file.

    The columns of the file are Fx Fy Fz Mx My Mz, and either `pose` (number of the pose along the
    path, from 1) or the coordinates of the pose under the names of the tool's moves. Other columns
    are ignored. Raises InputError with one line per fault.
    """
    rows = table_rows(path, "a CSV file of wrenches", _COMPONENTS, MOST_POSES)
    headings = rows[0].cells
    by_number = {_NUMBER: Number(least=1, most=len(robot.poses), whole=True)}
    coordinate = COORDINATE.in_unit(robot.lengths, robot.tool.moves)
    pose_columns = by_number if _NUMBER in headings else dict.fromkeys(robot.tool.moves, coordinate)
    if missing := [name for name in pose_columns if name not in headings]:
        raise InputError(
            f"{path}: lacks the column {_NUMBER} (numbers of poses), or {', '.join(missing)}"
        )
    wrenches: dict[int, Array] = {}
    _, faults = collect_faults(partial(_store_wrench, wrenches, robot, pose_columns), rows)
    numbers = [robot.pose_number(pose) for pose in robot.poses]
    faults = faults or [
        f"{path}: no wrench for pose {position}, {shown_pose(robot, pose)}; must have one for "
        "every pose of the path"
        for position, (number, pose) in enumerate(zip(numbers, robot.poses, strict=True), start=1)
        if number not in wrenches
    ]
    if faults:
        raise InputError(faults)
    return np.array([wrenches[number] for number in numbers if number is not None])


def _store_wrench(
    wrenches: dict[int, Array], robot: Mechanism, pose_columns: Mapping[str, Number], row: TableRow
) -> None:
    """Store the wrench of a CSV row under its pose.

    Raises InputError if a different wrench of this pose is stored already.
    """
    rules = {**pose_columns, **dict.fromkeys(_COMPONENTS, FORCE)}
    values = {name: number_or_text(row.cells[name]) for name in rules}
    if faults := [
        fault
        for name, rule in rules.items()
        for fault in rule.faults(values[name], f"{row.place}, column {name}")
    ]:
        raise InputError(faults)
    typed = np.array([values[name] for name in pose_columns], dtype=float)
    numbered = _NUMBER in pose_columns
    pose = robot.poses[int(values[_NUMBER]) - 1] if numbered else robot.in_metres(typed)
    number, pose_text = robot.pose_number(pose), shown_pose(robot, pose)
    if number is None:
        raise InputError(f"{row.place}: {pose_text}: must be a pose of the path")
    wrench = np.array([values[name] for name in _COMPONENTS], dtype=float)
    if (wrenches.setdefault(number, wrench) != wrench).any():
        raise InputError(f"{row.place}: {pose_text}: differs from the wrench of an earlier line")
