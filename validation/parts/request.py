"""Interfaces and a material as typed at the command line: the tables of a robot file."""

import tomllib
from collections.abc import Sequence
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import Material
from lumped.mechanism.body import Body, PartInterface
from lumped.robot_file import RobotFile
from lumped.robot_file.mechanism.build import interface_of, isotropic_of
from lumped.robot_file.rules.relations import interface_faults, material_faults
from lumped.robot_file.rules.tables import INTERFACE, MATERIAL

FEWEST_UNKNOWNS, MOST_UNKNOWNS = 1000, 10_000_000
# More than any mesh of three that fits into memory resolves.
MOST_MODES = 100
_EXAMPLE = "A = { cylinder = { radius = 0.04 } }"


def faults_of_numbers(unknowns: int | None, modes: int | None) -> list[str]:
    """A line for each number out of its range; None is the default."""
    faults = []
    if unknowns is not None and not FEWEST_UNKNOWNS <= unknowns <= MOST_UNKNOWNS:
        allowed = f"from {FEWEST_UNKNOWNS} to {MOST_UNKNOWNS}"
        faults.append(f"--unknowns = {unknowns}: must be {allowed}")
    if modes is not None and not 0 <= modes <= MOST_MODES:
        faults.append(f"--modes = {modes}: must be from 0 to {MOST_MODES}")
    return faults


def part_of(robot_file: RobotFile, body: str) -> Body:
    """The part that a body of the robot is; raises InputError if it is none."""
    parts = robot_file.mechanism.parts
    if body not in parts:
        known = ", ".join(parts) or "none"
        raise InputError(
            f"--body {body}: is not a part from a file; the parts of {robot_file.source}: {known}"
        )
    return parts[body]


def interfaces_of(texts: Sequence[str]) -> tuple[dict[str, PartInterface], dict[str, Array]]:
    """Interfaces and the points given, from texts such as the example.

    Raises InputError, all faults at once.
    """
    faults: list[str] = []
    wanted: dict[str, PartInterface] = {}
    points: dict[str, Array] = {}
    for text in texts:
        tables = _table(text, "--interface", _EXAMPLE)
        if not tables:
            faults.append(f"--interface {text!r}: names none; must be like {_EXAMPLE}")
        for name, table in tables.items():
            key = f"--interface {name}"
            if name in wanted:
                faults.append(f"{key}: given twice")
                continue
            if not isinstance(table, dict):
                faults.append(f"{key}: must be a table, {_EXAMPLE}")
                continue
            own = INTERFACE.faults_within(table, f"{key}.")
            read = {} if own else INTERFACE.read(table)
            own = own or [*interface_faults(read, key)]
            if not own:
                wanted[name] = interface_of(read)
                if read["point"] is not None:
                    points[name] = np.array(read["point"])
            faults += own
    if not texts:
        faults.append(f"--interface: missing; must be given, {_EXAMPLE!r} say")
    if faults:
        raise InputError(faults)
    return wanted, points


def material_of(text: str) -> Material:
    """The isotropic material of a text { E = …, nu = …, rho = … }; raises InputError."""
    example = "{ E = 2.1e11, nu = 0.3, rho = 7850.0 }"
    tables = _table(f"material = {text}", "--material", example)
    table = tables["material"]
    if not isinstance(table, dict) or len(tables) > 1:
        raise InputError(f"--material: must be a table, {example}")
    faults = MATERIAL.faults_within(table, "--material ")
    read = {} if faults else MATERIAL.read(table)
    if faults := faults or [*material_faults(read, "--material ")]:
        raise InputError(faults)
    return isotropic_of(read)


def _table(text: str, option: str, example: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{option} {text!r}: not TOML ({error}); must be like {example}"
        ) from error
