"""The `section` table of a leg: from a shape's name and sizes to a section of lumped.sections."""

from collections.abc import Mapping
from dataclasses import fields
from typing import Any

from lumped.robot_file.matrix_faults import is_finite_number
from lumped.sections import SHAPES, Section
from lumped.text import cut, did_you_mean, shown

# 1 µm: thinner than any wall that carries a load.
SMALLEST_SIZE = 1e-6


def section_faults(value: object, key: str) -> list[str]:
    """Faults of a section table, each line starting with `key`."""
    if not isinstance(value, dict):
        return [f"{key} = {shown(value)}: must be a table with a shape and its sizes in m"]
    shapes = ", ".join(SHAPES)
    if "shape" not in value:
        return [f"{key}.shape: missing; must be one of {shapes}"]
    shape = value["shape"]
    if not isinstance(shape, str) or shape not in SHAPES:
        advice = did_you_mean(str(shape), SHAPES)
        return [f"{key}.shape = {shown(shape)}: must be one of {shapes}{advice}"]
    sizes = size_names(shape)
    faults = [
        f"{key}.{cut(name, 40)}: unknown key of a {shape}; its sizes are {', '.join(sizes)}"
        for name in value
        if name != "shape" and name not in sizes
    ]
    for name in sizes:
        if name not in value:
            faults.append(f"{key}.{name}: missing; a {shape} needs it, in m")
        elif not is_finite_number(value[name]):
            faults.append(f"{key}.{name} = {shown(value[name])}: must be a finite number above 0 m")
        elif 0.0 < value[name] < SMALLEST_SIZE:
            faults.append(f"{key}.{name} = {value[name]!r}: must be at least {SMALLEST_SIZE:g} m")
    if faults:
        return faults
    return [f"{key}.{fault}" for fault in section_of(value).faults()]


def size_names(shape: str) -> tuple[str, ...]:
    """Keys of a shape's sizes, in their usual order."""
    kind: Any = SHAPES[shape]
    return tuple(field.name for field in fields(kind))


def section_of(table: Mapping[str, Any]) -> Section:
    """The section that a table without faults describes."""
    shape = str(table["shape"])
    return SHAPES[shape](**{name: float(table[name]) for name in size_names(shape)})
