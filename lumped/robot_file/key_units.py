"""Units of the numbers of a robot file, by their keys."""

import re
from collections.abc import Mapping
from typing import Any

from lumped.mechanism.mechanism import UNITS_OF_MOVES

_KEY = re.compile(r"(?P<names>[^\[]+)(?:\[(?P<row>\d+)(?:,(?P<column>\d+))?\])?")
_UNITS: Mapping[str, str] = {
    **dict.fromkeys(("length", "width", "height", "diameter", "thickness", "flange", "web"), "m"),
    **dict.fromkeys(("a", "tool_offset", "centre", "radius"), "m"),
    "mass": "kg",
    "inertia": "kg m²",
    "E": "Pa",
    "G": "Pa",
    "rho": "kg/m³",
}
_TRANSLATIONS = 3
_TURNING = "revolute"


def unit_of(tables: Mapping[str, Any], key: str) -> str:
    """Unit of the number at a key like "joints.motor1.drive.stiffness"; "" where it has none."""
    found = _KEY.fullmatch(key)
    if found is None:
        return ""
    names = found["names"].split(".")
    if names[0] == "points":
        return "m"
    if names[-1] == "compliance" and found["column"]:
        turns = sum(int(found[index]) > _TRANSLATIONS for index in ("row", "column"))
        return ("m/N", "rad/N", "rad/(N m)")[turns]
    if names[-1] in {"stiffness", "simplified"}:
        turning = names[0] == "joints" and tables["joints"][names[1]]["type"] == _TURNING
        return "N m/rad" if turning else "N/m"
    if names[0] == "path" and found["row"]:
        # A list of poses has the coordinate second.
        move = tables["tool"]["moves"][int(found["column"] or found["row"]) - 1]
        return UNITS_OF_MOVES[move]
    return _UNITS.get(names[-1], "")
