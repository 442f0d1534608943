"""Interfaces and a material from the command line, where they are written as in a robot file.

Input: texts such as "A = { cylinder = { radius = 0.04 } }". Output: `PartInterface` and `Material`
records. Raises InputError with all faults.
"""

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
from lumped.robot_file.mechanism.relations import interface_faults, material_faults
from lumped.robot_file.rules.tables.bodies import INTERFACE
from lumped.robot_file.rules.tables.sections import MATERIAL

FEWEST_UNKNOWNS, MOST_UNKNOWNS = 1000, 10_000_000
# More modes than any mesh that fits into memory can resolve.
MOST_MODES = 100
_EXAMPLE = "A = { cylinder = { radius = 0.04 } }"


def faults_of_numbers(unknowns: int | None, modes: int | None) -> list[str]:
    """Messages for a number of unknowns or modes out of range. None stands for the default."""
    faults = []
    if unknowns is not None and not FEWEST_UNKNOWNS <= unknowns <= MOST_UNKNOWNS:
        allowed = f"from {FEWEST_UNKNOWNS} to {MOST_UNKNOWNS}"
        faults.append(f"--unknowns = {unknowns}: must be {allowed}")
    if modes is not None and not 0 <= modes <= MOST_MODES:
        faults.append(f"--modes = {modes}: must be from 0 to {MOST_MODES}")
    return faults


def part_of(robot_file: RobotFile, body: str) -> Body:
    """CAD part named `body` in a robot file. Raises InputError if there is none."""
    parts = robot_file.mechanism.parts
    if body not in parts:
        names = ", ".join(parts) or "none"
        raise InputError(
            f"--body {body}: not a CAD part; the CAD parts of {robot_file.source} are: {names}"
        )
    return parts[body]


def interfaces_of(texts: Sequence[str]) -> tuple[dict[str, PartInterface], dict[str, Array]]:
    """Interfaces from texts, and the reference points (3, m) that some texts specify, by name.

    Raises InputError with the faults of all texts.
    """
    faults: list[str] = []
    interfaces: dict[str, PartInterface] = {}
    points: dict[str, Array] = {}
    for text in texts:
        tables = _table(text, "--interface", _EXAMPLE)
        if not tables:
            faults.append(f"--interface {text!r}: no interface found; must be like {_EXAMPLE}")
        for name, table in tables.items():
            key = f"--interface {name}"
            if name in interfaces:
                faults.append(f"{key}: given twice; leave one out")
                continue
            if not isinstance(table, dict):
                faults.append(f"{key}: must be a table, for example {_EXAMPLE}")
                continue
            table_faults = INTERFACE.faults_within(table, f"{key}.")
            if not table_faults:
                entry = INTERFACE.read(table)
                table_faults = [*interface_faults(entry, key)]
            if not table_faults:
                interfaces[name] = interface_of(entry)
                if entry.point is not None:
                    points[name] = np.array(entry.point)
            faults += table_faults
    if not texts:
        faults.append(f"--interface: missing; add one, for example {_EXAMPLE!r}")
    if faults:
        raise InputError(faults)
    return interfaces, points


def material_of(text: str) -> Material:
    """Isotropic material from a text { E = …, nu = …, rho = … }.

    Raises InputError with all faults of the text.
    """
    example = "{ E = 2.1e11, nu = 0.3, rho = 7850.0 }"
    tables = _table(f"material = {text}", "--material", example)
    table = tables["material"]
    if not isinstance(table, dict) or len(tables) > 1:
        raise InputError(f"--material: must be a table, for example {example}")
    if faults := MATERIAL.faults_within(table, "--material "):
        raise InputError(faults)
    material = MATERIAL.read(table)
    if faults := [*material_faults(material, "--material ")]:
        raise InputError(faults)
    return isotropic_of(material)


def _table(text: str, option: str, example: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise InputError(
            f"{option} {text!r}: not TOML ({error}); must be like {example}"
        ) from error
