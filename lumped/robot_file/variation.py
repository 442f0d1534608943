"""Robots that differ from a file's in one number or several, named by their keys.

A variation is typed as KEY=FROM:TO:COUNT: "bodies.rod1.section.diameter=0.02:0.06:9". A * in the
key stands for any part of a name: all numbers whose keys match take the same value.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fnmatch import fnmatchcase
from itertools import product
from math import isfinite
from typing import Any

import numpy as np

from lumped.errors import InputError, collect_faults
from lumped.robot_file.load import RobotFile
from lumped.robot_file.places import numbers_of
from lumped.text import cut, did_you_mean, shown

MOST_VALUES, MOST_ROBOTS = 1000, 10_000
_ALLOWED = "must be KEY=FROM:TO:COUNT, bodies.rod1.section.diameter=0.02:0.06:9 say"


@dataclass(frozen=True)
class Variation:
    """The values that the numbers at `keys` take together; `key` as it was typed."""

    key: str
    keys: tuple[str, ...]
    values: tuple[float, ...]


def variations_of(robot_file: RobotFile, typed: Sequence[str]) -> tuple[Variation, ...]:
    """The variations of a robot file as typed; raises InputError with one line per fault."""
    numbers = dict(numbers_of(robot_file.tables))
    found, faults = collect_faults(lambda text: _variation(text, numbers, robot_file), typed)
    keys = [key for one in found for key in one.keys]
    faults += [
        f"--vary {key}: varied twice; must be named once"
        for key in dict.fromkeys(keys)
        if keys.count(key) > 1
    ]
    count = int(np.prod([len(one.values) for one in found], dtype=float)) if found else 0
    if count > MOST_ROBOTS:
        faults.append(f"--vary: {count} robots; must be at most {MOST_ROBOTS} in all")
    if faults:
        raise InputError(faults)
    return tuple(found)


def varied(
    robot_file: RobotFile, variations: Sequence[Variation]
) -> list[tuple[tuple[float, ...], RobotFile]]:
    """Every combination of the values, with the robot file that has them.

    Raises InputError, one line, for the first robot that cannot be: one number is one cause.
    """
    robots = []
    for values in product(*(one.values for one in variations)):
        pairs = zip(variations, values, strict=True)
        changes = {key: value for one, value in pairs for key in one.keys}
        try:
            robots.append((values, robot_file.with_values(changes)))
        except InputError as error:
            place = f"--vary {told(variations, values)}"
            raise InputError(f"{place}: {error.faults[0]}") from error
    return robots


def told(variations: Sequence[Variation], values: Sequence[float]) -> str:
    """The values with their keys: "bodies.rod1.section.diameter=0.02"."""
    pairs = zip(variations, values, strict=True)
    return ", ".join(f"{one.key}={value:.6g}" for one, value in pairs)


def _variation(text: str, numbers: Mapping[str, float], robot_file: RobotFile) -> Variation:
    key, _, given = text.partition("=")
    try:
        first, last, number = given.split(":")
        start, to, count = float(first), float(last), int(number)
    except ValueError:
        raise InputError(f"--vary {cut(text, 80)}: {_ALLOWED}") from None
    if not (isfinite(start) and isfinite(to)):
        raise InputError(f"--vary {key}: FROM and TO must be finite numbers")
    if not 1 <= count <= MOST_VALUES:
        raise InputError(f"--vary {key}: COUNT = {count}: must be from 1 to {MOST_VALUES}")
    pattern = key.replace("[", "[[]")
    keys = tuple(one for one in numbers if fnmatchcase(one, pattern))
    if not keys:
        raise InputError(f"--vary {key}: {_why_not(key, numbers, robot_file)}")
    values = np.linspace(start, to, count).tolist()
    if all(isinstance(numbers[one], int) for one in keys) and all(v == round(v) for v in values):
        values = [int(value) for value in values]
    return Variation(key, keys, tuple(values))


def _why_not(key: str, numbers: Mapping[str, float], robot_file: RobotFile) -> str:
    held: Any = robot_file.tables
    for part in key.split("."):
        held = held.get(part) if isinstance(held, dict) else None
    if held is not None:
        return (
            f"{shown(held)} in {robot_file.source} is no number; must name a number "
            "(entries of a list count from 1: points.P[1], compliance[2,2])"
        )
    return f"{robot_file.source} has no such number{did_you_mean(key, numbers)}"
