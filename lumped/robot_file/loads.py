"""The designer's own loads, table [[loads]]: on the robot, or what is wrong with them."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from lumped.errors import each
from lumped.mechanism.load import Load
from lumped.mechanism.mechanism import GROUND, MOVES, Mechanism
from lumped.robot_file.wrenches import wrenches_over
from lumped.text import did_you_mean, shown

_WHAT = ("wrench", "gravity", "acceleration", "speed")


def loads_of(read: Sequence[Mapping[str, Any]], robot: Mechanism, folder: Path) -> tuple[Load, ...]:
    """The loads that tables without faults describe; their files lie in `folder`."""
    return tuple(
        Load(
            one["name"],
            _body_of(one, robot) or robot.tool.body,
            one["at"] or robot.tool.point,
            **{key: np.array(one[key]) for key in _WHAT if one[key] is not None},
            over_path=wrenches_over(folder / one["file"], robot) if one["file"] else None,
        )
        for one in read
    )


def load_faults(read: Sequence[Mapping[str, Any]], robot: Mechanism, folder: Path) -> Iterator[str]:
    """What is wrong with loads whose keys are sound, one line each."""
    names = [one["name"] for one in read]
    for number, one in enumerate(read, start=1):
        key = f"loads[{number}]"
        if one["name"] in names[: number - 1]:
            yield f"{key}.name = {shown(one['name'])}: named twice; must be named once"
        if all(one[what] is None for what in (*_WHAT, "file")):
            yield f"{key}: has no load; must have one of {', '.join(_WHAT)}, file"
        if one["file"] is not None:
            if one["wrench"] is not None:
                yield f"{key}.wrench: must be left out beside a file of wrenches"
            faults = each(lambda file: wrenches_over(folder / file, robot), [one["file"]])[1]
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


def _body_of(one: Mapping[str, Any], robot: Mechanism) -> str | None:
    """The body that a load takes hold of; None where none has such a point.

    The one that is named, else the tool's, else the first in the file.
    """
    first = (robot.tool.body, *(name for name in robot.bodies if name != GROUND))
    names = first if one["body"] is None else (one["body"],)
    point = one["at"] or robot.tool.point
    held = {name: robot.bodies[name].interfaces for name in names if name in robot.bodies}
    return next((name for name, points in held.items() if point in points), None)
