"""Units of length of a part's file: what it says itself, and what may be said for it."""

import re

from lumped.errors import InputError
from lumped.mechanism.body import METRES

_ENTITY = r"#{}\s*=\s*\((.*?)\)\s*;"
_CONTEXT = re.compile(r"GLOBAL_UNIT_ASSIGNED_CONTEXT\s*\(\s*\((.*?)\)\s*\)", re.DOTALL)
_PREFIX = {"": "m", "MILLI": "mm", "CENTI": "cm"}
# Beyond any leg in metres; a leg of 10 cm written in millimetres has the size 100.
_LARGEST = 50.0
# Below any leg.
_SMALLEST = 1e-3


def step_unit(text: str, source: str) -> str:
    """Unit of length that a STEP file (ISO 10303-21) says for its shapes.

    Raises InputError where it says none, several, or one that is unknown here.
    """
    units = set()
    for context in _CONTEXT.findall(text):
        for reference in re.findall(r"#(\d+)", context):
            entity = re.search(_ENTITY.format(reference), text, re.DOTALL)
            if entity and "LENGTH_UNIT" in entity.group(1):
                units.add(_length_unit(entity.group(1), source))
    if not units:
        raise InputError(f"{source}: says no unit of length; export it anew from the CAD system")
    if len(units) > 1:
        named = " and ".join(sorted(units))
        raise InputError(f"{source}: its shapes are in {named}; export them in one unit of length")
    return units.pop()


def _length_unit(entity: str, source: str) -> str:
    conversion = re.search(r"CONVERSION_BASED_UNIT\s*\(\s*'([^']*)'", entity)
    if conversion:
        name = conversion.group(1).strip().lower()
        if name in ("inch", "in"):
            return "inch"
    else:
        si = re.search(r"SI_UNIT\s*\(\s*(?:\$|\.(\w+)\.)\s*,\s*\.METRE\.", entity)
        name = ((si.group(1) or "").upper() if si else "unknown").lower()
        if si and name.upper() in _PREFIX:
            return _PREFIX[name.upper()]
    allowed = ", ".join(METRES)
    raise InputError(f"{source}: its unit of length, {name!r}, is not known here; use {allowed}")


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
