"""Unit of length of the file of a part, from this file or from the robot file."""

import re
from collections.abc import Iterable
from math import isclose

from lumped.errors import InputError
from lumped.mechanism.body import METRES
from meshes.part.reading.step_text import entities

_CONTEXT = re.compile(r"GLOBAL_UNIT_ASSIGNED_CONTEXT\s*\(\s*\((.*?)\)\s*\)", re.DOTALL)
# Entities for the representation of a shape, those of solids first. Views, dimensions and notes
# have other contexts, whose units are not those of the shapes.
_SHAPES = (
    re.compile(r"\w*BREP_SHAPE_REPRESENTATION\s*\("),
    re.compile(r"\bSHAPE_REPRESENTATION\s*\(|_SHAPE_REPRESENTATION\s*\("),
)
_REFERENCE = re.compile(r"#(\d+)")
_SI = re.compile(r"SI_UNIT\s*\(\s*(?:\$|\.(\w+)\.)\s*,\s*\.METRE\.")
_PREFIX = {
    "": 1.0,
    "MILLI": 1e-3,
    "CENTI": 1e-2,
    "DECI": 1e-1,
    "MICRO": 1e-6,
    "NANO": 1e-9,
    "PICO": 1e-12,
    "DECA": 1e1,
    "HECTO": 1e2,
    "KILO": 1e3,
}
_CONVERSION = re.compile(r"CONVERSION_BASED_UNIT\s*\([^#()]*#(\d+)")
_MEASURE = re.compile(r"LENGTH_MEASURE\s*\(\s*([-+.\dE]+)\s*\)\s*,\s*#(\d+)", re.IGNORECASE)
# Largest relative difference between the unit of a file and a known unit.
_SAME_UNIT = 1e-6
# Largest depth of nested conversions.
_CONVERSIONS = 4
# Largest size (m) of a part. A leg of 10 cm typed in millimetres and read in metres has 100 m.
_LARGEST = 50.0
# Smallest size (m) of a part.
_SMALLEST = 1e-3


def step_unit(content: bytes, source: str) -> str:
    """Unit of length of the shapes in a STEP file (ISO 10303-21).

    Raises InputError if there is none, if there are several, or if the unit is not supported.
    """
    by_number = entities(content)
    units = {
        _unit_of(by_number[number], by_number, source)
        for context in _contexts(by_number)
        for number in _REFERENCE.findall(context)
        if "LENGTH_UNIT" in by_number.get(number, "")
    }
    if not units:
        raise InputError(f"{source}: has no unit of length; export it again from the CAD system")
    if len(units) > 1:
        unit_names = " and ".join(sorted(units))
        raise InputError(
            f"{source}: the shapes in the file have different units of length, {unit_names}; "
            "export them in one unit"
        )
    return units.pop()


def _contexts(by_number: dict[str, str]) -> Iterable[str]:
    """Texts with the lists of units that apply to the shapes in a STEP file.

    `by_number` contains the entities of the file. A STEP file has a list of units in each context
    (of shapes, views, notes). The contexts of solids are used. If no solid has a context, the
    contexts of other shapes are used. If no shape has a context, all contexts are used.
    """
    for shape in _SHAPES:
        contexts = [
            match[1]
            for entity in by_number.values()
            if shape.search(entity)
            # The context is the last reference.
            for number in _REFERENCE.findall(entity)[-1:]
            if (match := _CONTEXT.search(by_number.get(number, "")))
        ]
        if contexts:
            return contexts
    return [match[1] for entity in by_number.values() if (match := _CONTEXT.search(entity))]


def _unit_of(entity: str, by_number: dict[str, str], source: str) -> str:
    """Name of a unit in the robot file ("mm", …), found by the size of the unit in metres.

    The name in the STEP file is not used, because exporters choose it freely. `entity` is the text
    of the unit, `by_number` contains all entities of the file. Raises InputError, with `source` in
    its message, for a unit that is not supported.
    """
    metres = _metres(entity, by_number, _CONVERSIONS)
    for name, size in METRES.items():
        if metres and isclose(metres, size, rel_tol=_SAME_UNIT):
            return name
    size_text = f" of {metres:.6g} m" if metres else ""
    raise InputError(
        f"{source}: the file's unit of length{size_text} is not supported; use {', '.join(METRES)}"
    )


def _metres(entity: str, by_number: dict[str, str], conversions: int) -> float | None:
    """Size (m) of a unit of length, which is an SI unit or a multiple of another unit.

    `entity` is the text of the unit, `by_number` contains all entities of the file. None if the
    file does not define the size, or defines it only through a chain of more than `conversions`
    units.
    """
    if si := _SI.search(entity):
        return _PREFIX.get((si[1] or "").upper())
    conversion = _CONVERSION.search(entity)
    measure = _MEASURE.search(by_number.get(conversion[1], "")) if conversion else None
    if measure is None or conversions == 0:
        return None
    other = _metres(by_number.get(measure[2], ""), by_number, conversions - 1)
    try:
        return None if other is None else float(measure[1]) * other
    except ValueError:
        return None


def chosen_unit(file_unit: str | None, specified: str | None, source: str) -> str:
    """Unit of length in the file of a part, otherwise the `specified` unit, otherwise metres.

    `file_unit` is the unit in the file. Raises InputError, with `source` in its message, if both
    units exist and differ.
    """
    if file_unit and specified and file_unit != specified:
        raise InputError(f"{source}: is in {file_unit}, and unit = {specified!r} contradicts it")
    return file_unit or specified or "m"


def require_plausible(
    extent: list[float], unit: str, source: str, *, unit_in_file: bool = False
) -> None:
    """Raise InputError if a part with the `extent` (3, in m) cannot be part of a robot.

    `unit` is the unit in which the file was read. `unit_in_file` is True if the file contains the
    unit, so that no other one can be specified.
    """
    if not _SMALLEST <= max(extent) <= _LARGEST:
        is_millimetres = unit == "m" and not unit_in_file and max(extent) > _LARGEST
        advice = 'is it in mm? Then add unit = "mm"' if is_millimetres else "is its unit right?"
        raise InputError(
            f"{source}: {describe(extent, unit)} is not the size of a robot's part; {advice}"
        )


def describe(extent: list[float], unit: str) -> str:
    """Text of the `extent` (3, in m) in `unit`, such as "905 × 170 × 210 mm"."""
    sides = " × ".join(f"{side / METRES[unit]:.6g}" for side in extent)
    return f"{sides} {unit}"
