"""Units of length of a part's file: what it says itself, and what may be said for it."""

import re
from collections.abc import Iterable
from math import isclose

from lumped.errors import InputError
from lumped.mechanism.body import METRES
from meshes.part.reading.step_text import entities

_CONTEXT = re.compile(r"GLOBAL_UNIT_ASSIGNED_CONTEXT\s*\(\s*\((.*?)\)\s*\)", re.DOTALL)
# Representations of shapes, those of solids first: views, dimensions and notes have contexts of
# their own, whose units are not the shapes'.
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
# Share by which the unit of a file may differ from the one it is taken as.
_SAME_UNIT = 1e-6
# Conversions of conversions that are followed.
_CONVERSIONS = 4
# Beyond any leg in metres; a leg of 10 cm written in millimetres has the size 100.
_LARGEST = 50.0
# Below any leg.
_SMALLEST = 1e-3


def step_unit(content: bytes, source: str) -> str:
    """Unit of length of the shapes in a STEP file (ISO 10303-21).

    Raises InputError if there is none, if there are several, or if it is unknown here.
    """
    by_number = entities(content)
    units = {
        _unit_of(by_number[number], by_number, source)
        for context in _contexts(by_number)
        for number in _REFERENCE.findall(context)
        if "LENGTH_UNIT" in by_number.get(number, "")
    }
    if not units:
        raise InputError(f"{source}: says no unit of length; export it anew from the CAD system")
    if len(units) > 1:
        named = " and ".join(sorted(units))
        raise InputError(f"{source}: its shapes are in {named}; export them in one unit of length")
    return units.pop()


def _contexts(by_number: dict[str, str]) -> Iterable[str]:
    """Lists of units of the contexts of solids, else of shapes, else of anything."""
    for shape in _SHAPES:
        contexts = [
            found[1]
            for entity in by_number.values()
            if shape.search(entity)
            # The context stands last.
            for number in _REFERENCE.findall(entity)[-1:]
            if (found := _CONTEXT.search(by_number.get(number, "")))
        ]
        if contexts:
            return contexts
    return [found[1] for entity in by_number.values() if (found := _CONTEXT.search(entity))]


def _unit_of(entity: str, by_number: dict[str, str], source: str) -> str:
    """The name of a unit by its size: names of units in files are anybody's."""
    metres = _metres(entity, by_number, _CONVERSIONS)
    for name, size in METRES.items():
        if metres and isclose(metres, size, rel_tol=_SAME_UNIT):
            return name
    said = f" of {metres:.6g} m" if metres else ""
    raise InputError(
        f"{source}: its unit of length{said} is not known here; use {', '.join(METRES)}"
    )


def _metres(entity: str, by_number: dict[str, str], conversions: int) -> float | None:
    """Size (m) of a unit of length: of SI, or a number of another one. None if it is not given."""
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


def chosen_unit(said: str | None, given: str | None, source: str) -> str:
    """The file's own unit of length, or the `given` one where it says none (then metres).

    Raises InputError where both are there and differ.
    """
    if said and given and said != given:
        raise InputError(f"{source}: is in {said}, and unit = {given!r} contradicts it")
    return said or given or "m"


def require_plausible(extent: list[float], unit: str, source: str, *, said: bool = False) -> None:
    """Raise InputError where a part of the `extent` (3, m) read in `unit` cannot be a leg's.

    `said`: the file names its unit itself, and no other can be said for it.
    """
    if not _SMALLEST <= max(extent) <= _LARGEST:
        is_millimetres = unit == "m" and not said and max(extent) > _LARGEST
        advice = 'is it in mm? then say unit = "mm"' if is_millimetres else "is its unit right?"
        raise InputError(
            f"{source}: {describe(extent, unit)} is not the size of a robot's part; {advice}"
        )


def describe(extent: list[float], unit: str) -> str:
    """The `extent` (3) in m written in `unit`: 905 × 170 × 210 mm."""
    sides = " × ".join(f"{side / METRES[unit]:.6g}" for side in extent)
    return f"{sides} {unit}"
