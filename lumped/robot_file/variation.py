"""Variations of a robot: copies in which numbers of its file, given by their keys, have new values.

A variation is typed as KEY=FROM:TO:COUNT, for example "bodies.rod1.section.diameter=0.02:0.06:9". A
* in the key matches any part of a name. All numbers with matching keys get the same value.
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
_ALLOWED = "must be KEY=FROM:TO:COUNT, such as bodies.rod1.section.diameter=0.02:0.06:9"


@dataclass(frozen=True)
class Variation:
    """Variation of numbers in a robot file, which get the `values` one after the other.

    `keys` are the full keys of the numbers, which all match `key`, the key as typed.
    """

    key: str
    keys: tuple[str, ...]
    values: tuple[float, ...]


def variations_of(robot_file: RobotFile, typed: Sequence[str]) -> tuple[Variation, ...]:
    """Variations of a robot file from texts of the command line (KEY=FROM:TO:COUNT).

    Raises InputError with one line per fault.
    """
    numbers = dict(numbers_of(robot_file.tables))
    variations, faults = collect_faults(lambda text: _variation(text, numbers, robot_file), typed)
    keys = [key for variation in variations for key in variation.keys]
    faults += [
        f"--vary {key}: varied twice; must be named once"
        for key in dict.fromkeys(keys)
        if keys.count(key) > 1
    ]
    count = (
        int(np.prod([len(variation.values) for variation in variations], dtype=float))
        if variations
        else 0
    )
    if count > MOST_ROBOTS:
        faults.append(f"--vary: {count} robots; must be at most {MOST_ROBOTS} in all")
    if faults:
        raise InputError(faults)
    return tuple(variations)


def varied(
    robot_file: RobotFile, variations: Sequence[Variation]
) -> list[tuple[tuple[float, ...], RobotFile]]:
    """All combinations of the values of `variations`, each with the robot file that has them.

    Raises InputError for the first impossible robot only, because others are usually impossible for
    the same reason.
    """
    robots = []
    for values in product(*(variation.values for variation in variations)):
        pairs = zip(variations, values, strict=True)
        changes = {key: value for variation, value in pairs for key in variation.keys}
        try:
            robots.append((values, robot_file.with_values(changes)))
        except InputError as error:
            option = f"--vary {assignments(variations, values)}"
            raise InputError(f"{option}: {error.faults[0]}") from error
    return robots


def assignments(variations: Sequence[Variation], values: Sequence[float]) -> str:
    """Text of values with their keys, such as "bodies.rod1.section.diameter=0.02"."""
    pairs = zip(variations, values, strict=True)
    return ", ".join(f"{variation.key}={value:.6g}" for variation, value in pairs)


def _variation(text: str, numbers: Mapping[str, float], robot_file: RobotFile) -> Variation:
    key, _, range_text = text.partition("=")
    try:
        first, last, number = range_text.split(":")
        start, to, count = float(first), float(last), int(number)
    except ValueError:
        raise InputError(f"--vary {cut(text, 80)}: {_ALLOWED}") from None
    if not (isfinite(start) and isfinite(to)):
        raise InputError(f"--vary {key}: FROM and TO must be finite numbers")
    if not 1 <= count <= MOST_VALUES:
        raise InputError(f"--vary {key}: COUNT = {count}: must be from 1 to {MOST_VALUES}")
    pattern = key.replace("[", "[[]")
    keys = tuple(number_key for number_key in numbers if fnmatchcase(number_key, pattern))
    if not keys:
        raise InputError(f"--vary {key}: {_why_not(key, numbers, robot_file)}")
    values = np.linspace(start, to, count).tolist()
    if all(isinstance(numbers[number_key], int) for number_key in keys) and all(
        v == round(v) for v in values
    ):
        values = [int(value) for value in values]
    return Variation(key, keys, tuple(values))


def _why_not(key: str, numbers: Mapping[str, float], robot_file: RobotFile) -> str:
    value: Any = robot_file.tables
    for part in key.split("."):
        value = value.get(part) if isinstance(value, dict) else None
    if value is not None:
        return (
            f"{shown(value)} in {robot_file.source} is no number; must name a number "
            "(entries of a list count from 1: points.P[1], compliance[2,2])"
        )
    return f"{robot_file.source} has no such number{did_you_mean(key, numbers)}"
