"""Interfaces and a material as typed at the command line: the tables of a robot file."""

import tomllib
from collections.abc import Sequence
from typing import Any

import numpy as np

from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import Material
from lumped.mechanism.body import PartInterface
from lumped.robot_file.mechanism.build import interface_of, isotropic_of
from lumped.robot_file.rules.relations import interface_faults, material_faults
from lumped.robot_file.rules.tables import INTERFACE, MATERIAL

_EXAMPLE = "A = { cylinder = { radius = 0.04 } }"


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
