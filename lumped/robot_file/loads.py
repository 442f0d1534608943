"""Loads and harmonic responses of a robot file: tables [[loads]] and [[responses]].

A CSV file can contain a wrench for each pose of the path.
"""

from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path

import numpy as np

from lumped.acceptance.quantities import TEST_RESPONSE
from lumped.arrays import Array
from lumped.errors import InputError, collect_faults
from lumped.legs import is_bent, line_length
from lumped.mechanism.body import Rigid
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.load import AppliedLine, Excitation, LineLoad, Load, Pressure
from lumped.mechanism.mechanism import GROUND, MOVES, Mechanism
from lumped.models.bodies import legs_of
from lumped.robot_file.mechanism.build import selection_of
from lumped.robot_file.mechanism.relations import interface_faults, named_twice
from lumped.robot_file.reading import TableRow, number_or_text, table_rows
from lumped.robot_file.rules.rule import NO_DIRECTION, Number
from lumped.robot_file.rules.tables.requests import (
    FORCE,
    LineEntry,
    LoadEntry,
    PressureEntry,
    ResponseEntry,
)
from lumped.robot_file.rules.tables.values import COORDINATE, MOST_POSES, Triple
from lumped.text import did_you_mean, shown

# Smallest speed (m/s) and acceleration (m/s²). Squares of smaller numbers are round-off.
_SMALLEST = 1e-12
_KINDS = ("wrench", "gravity", "acceleration", "speed", "file", "lines", "pressures")
_COMPONENTS = ("Fx", "Fy", "Fz", "Mx", "My", "Mz")
_NUMBER = "pose"
# Excess over the length of a leg that is rounding of its points.
_ROUND_OFF = 1e-9


def loads_of(entries: Sequence[LoadEntry], robot: Mechanism, folder: Path) -> tuple[Load, ...]:
    """Loads of a robot from the tables [[loads]] of its file, which have no faults.

    Paths of files are relative to `folder`.
    """
    return tuple(
        Load(
            entry.name,
            _body_of(entry.at, entry.body, robot) or robot.tool.body,
            entry.at or robot.tool.point,
            **{
                name: np.array(vector)
                for name, vector in (
                    ("wrench", entry.wrench),
                    ("gravity", entry.gravity),
                    ("acceleration", entry.acceleration),
                    ("speed", entry.speed),
                )
                if vector is not None
            },
            path_wrenches=_wrenches_over(folder / entry.file, robot) if entry.file else None,
            lines=tuple(_line_of(line, robot) for line in entry.lines or ()),
            pressures=tuple(
                Pressure(on_faces.body, selection_of(on_faces), on_faces.pressure)
                for on_faces in entry.pressures or ()
            ),
        )
        for entry in entries
    )


def load_faults(entries: Sequence[LoadEntry], robot: Mechanism, folder: Path) -> Iterator[str]:
    """Faults of tables [[loads]] whose keys have been checked, one line each."""
    yield from _names_twice(entries, "loads")
    for number, entry in enumerate(entries, start=1):
        key = f"loads[{number}]"
        if all(getattr(entry, kind) is None for kind in _KINDS):
            yield f"{key}: has no load; must have one of {', '.join(_KINDS)}"
        for line_number, line in enumerate(entry.lines or (), start=1):
            yield from _line_faults(line, f"{key}.lines[{line_number}]", robot)
        for pressure_number, on_faces in enumerate(entry.pressures or (), start=1):
            yield from _pressure_faults(on_faces, f"{key}.pressures[{pressure_number}]", robot)
        if entry.file is not None:
            if entry.wrench is not None:
                yield f"{key}.wrench: must be left out, because a file of wrenches is given"
            faults = collect_faults(
                lambda file: _wrenches_over(folder / file, robot), [entry.file]
            )[1]
            yield from (f"{key}.file: {fault}" for fault in faults)
        for key_name, value in (("at", entry.at), ("body", entry.body)):
            if value is not None and entry.wrench is None and entry.file is None:
                yield f"{key}.{key_name}: must be left out if no wrench acts there"
        yield from _point_faults(entry.at, entry.body, key, "at", robot)
        yield from _motion_faults(entry.acceleration, f"{key}.acceleration", robot)
        yield from _motion_faults(entry.speed, f"{key}.speed", robot)


def _motion_faults(vector: Triple | None, key: str, robot: Mechanism) -> Iterator[str]:
    """Faults of an acceleration or a speed of the tool."""
    for axis, value in zip(MOVES, vector or (), strict=False):
        typed = f"{key} = {list(vector or ())}"
        if value and axis not in robot.tool.moves:
            yield f"{typed}: the tool does not move along {axis}; must be 0 there"
        elif 0.0 < abs(value) < _SMALLEST:
            yield f"{typed}: must be 0 or at least {_SMALLEST:g} in size along {axis}"


def _line_of(line: LineEntry, robot: Mechanism) -> AppliedLine:
    """Distributed load along a leg, from a table without faults."""
    length = line_length(legs_of(robot)[line.leg])
    first = np.array(line.wrench)
    last = first if line.end_wrench is None else np.array(line.end_wrench)
    start, stop = line.from_ or 0.0, length if line.to is None else line.to
    return AppliedLine(
        line.leg, LineLoad(start, min(stop, length), first, last), line.axes == "base"
    )


def _line_faults(line: LineEntry, key: str, robot: Mechanism) -> Iterator[str]:
    """Faults of a load along a leg."""
    legs = legs_of(robot)
    leg = legs.get(line.leg)
    if leg is None:
        advice = did_you_mean(line.leg, legs, otherwise=f": {', '.join(legs) or 'none'}")
        yield (
            f"{key}.leg = {shown(line.leg)}: must be a leg with a section, or with a "
            f"6×6 compliance{advice}"
        )
        return
    length = line_length(leg)
    start, stop = line.from_ or 0.0, length if line.to is None else line.to
    lengths = robot.lengths
    if stop > length * (1.0 + _ROUND_OFF):
        along = " along its line" if is_bent(leg) else ""
        yield (
            f"{key}.to = {lengths.of(stop)!r}: must be at most the leg's length{along}, "
            f"{lengths.shown(length)}"
        )
    elif start >= stop:
        yield f"{key}.from = {lengths.of(start)!r}: must be below {lengths.shown(stop)}, its end"


def _pressure_faults(entry: PressureEntry, key: str, robot: Mechanism) -> Iterator[str]:
    """Faults of a pressure on faces of a part."""
    name, parts = entry.body, robot.parts
    if name not in parts:
        body = robot.bodies.get(name)
        instead = "wrench" if body is not None and isinstance(body.shape, Rigid) else "lines"
        reason = "" if body is None else f"; {shown(name)} has no faces, load the body by {instead}"
        advice = did_you_mean(name, parts, otherwise=f": {', '.join(parts) or 'none'}")
        yield f"{key}.body = {shown(name)}: must be a CAD part (step or mesh){advice}{reason}"
    yield from interface_faults(entry, key)


def _point_faults(
    point: str | None, owner: str | None, key: str, point_key: str, robot: Mechanism
) -> Iterator[str]:
    """Faults of a `point` that a load or response refers to, and of its body `owner`.

    `key` is the location of the table, and `point_key` the key of the point in it. None stands for
    a point or body that is left out.
    """
    if point is None:
        if owner is not None:
            yield (
                f"{key}.body: must be left out without `{point_key}`, because it names the "
                "body of that point"
            )
    elif _body_of(point, owner, robot) is None:
        bodies = robot.bodies if owner is None else {owner: None}
        points = dict.fromkeys(
            p for body in bodies if body in robot.bodies for p in robot.bodies[body].interfaces
        )
        advice = did_you_mean(point, points, otherwise=f": {', '.join(points) or 'none'}")
        yield f"{key}.{point_key} = {shown(point)}: must be a point of {owner or 'a body'}{advice}"


def _body_of(point: str | None, owner: str | None, robot: Mechanism) -> str | None:
    """Name of the body that has the point `point`. None if there is no such body.

    If `point` is None, it is the point of the tool. If `owner` is None, the body of the tool is
    searched first, then all bodies in the order of the file. Otherwise only the body `owner` is
    searched.
    """
    first = (robot.tool.body, *(name for name in robot.bodies if name != GROUND))
    names = first if owner is None else (owner,)
    name = point or robot.tool.point
    interfaces = {body: robot.bodies[body].interfaces for body in names if body in robot.bodies}
    return next((body for body, points in interfaces.items() if name in points), None)


def excitations_of(entries: Sequence[ResponseEntry], robot: Mechanism) -> tuple[Excitation, ...]:
    """Harmonic forces of a robot from the tables [[responses]] of its file without faults."""
    excitations = []
    for entry in entries:
        motion = entry.motion
        loaded = None
        if entry.point is not None:
            loaded = _body_of(entry.point, entry.body, robot) or "", entry.point
        moved_point = loaded
        if motion.point is not None:
            moved_point = _body_of(motion.point, motion.body, robot) or "", motion.point
        tool = robot.tool.body, robot.tool.point
        excitations.append(
            Excitation(
                entry.name,
                _unit(entry.direction),
                entry.from_,
                entry.to,
                entry.count,
                at=entry.judged_frequency,
                loaded=None if loaded == tool else loaded,
                moved=None if moved_point == tool else moved_point,
                moved_direction=None if motion.direction is None else _unit(motion.direction),
            )
        )
    return tuple(excitations)


def _unit(direction: Sequence[float]) -> Array:
    vector = np.array(direction)
    return np.asarray(vector / np.linalg.norm(vector))


def response_faults(entries: Sequence[ResponseEntry], robot: Mechanism) -> Iterator[str]:
    """Faults of tables [[responses]] whose keys have been checked, one line each."""
    yield from _names_twice(entries, "responses")
    for number, entry in enumerate(entries, start=1):
        key, motion = f"responses[{number}]", entry.motion
        if entry.name == TEST_RESPONSE:
            yield f"{key}.name = {shown(entry.name)}: must differ; modal tests have this name"
        directions = {"direction": entry.direction, "of.direction": motion.direction}
        for name, direction in directions.items():
            if direction is not None and np.linalg.norm(direction) < NO_DIRECTION:
                yield f"{key}.{name} = {list(direction)}: must not be zero"
        yield from _point_faults(entry.point, entry.body, key, "at", robot)
        location = (key, "of") if isinstance(entry.of, str) else (f"{key}.of", "point")
        yield from _point_faults(motion.point, motion.body, *location, robot)
        frequency = entry.judged_frequency
        name = "at" if entry.frequency is None else "frequency"
        if isinstance(entry.at, float) and entry.frequency is not None:
            yield f"{key}.at = {entry.at!r}: must be a point, because {key}.frequency is given"
        if entry.to <= entry.from_:
            yield f"{key}.to = {entry.to!r}: must be above {key}.from, {entry.from_!r} Hz"
        elif frequency is not None and not entry.from_ <= frequency <= entry.to:
            yield f"{key}.{name} = {frequency!r}: must be between {key}.from and {key}.to"
    if entries and not robot.is_damped:
        yield (
            "responses: nothing damps them, their peaks have no bound; must have [damping] ratio, "
            "or loss of a material, a joint or a drive, or damping of a joint or a drive"
        )


def _names_twice(
    entries: Sequence[LoadEntry] | Sequence[ResponseEntry], array_name: str
) -> Iterator[str]:
    for fault in named_twice([entry.name for entry in entries], f"{array_name}[{{}}].name"):
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
    """Store the wrench of a CSV row in `wrenches`, under the index of its pose on the path.

    `pose_columns` are the columns that identify the pose, with the rules for their numbers. Raises
    InputError with one line per fault, also if a different wrench of this pose is stored already.
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
