"""Units of length in robot files and messages. All other units are SI."""

from collections.abc import Mapping
from dataclasses import dataclass

# Unit of a coordinate of a pose: a length or an angle, depending on the moves of the tool.
COORDINATES = "m or rad"
# Power of the length in each unit that occurs in the rules of robot files.
POWERS: Mapping[str, int] = {
    COORDINATES: 1,
    **{unit: power for power, unit in enumerate(("m", "m²", "m³", "m⁴", "m⁵", "m⁶"), start=1)},
}
# Significant digits after conversion from a file's unit to metres and back.
_DIGITS = 12


@dataclass(frozen=True)
class UnitOfLength:
    """A unit of length with its `name` and the number of such units `per_metre`."""

    name: str
    per_metre: float

    def of(self, metres: float) -> float:
        """Length in this unit from a length in `metres`, rounded to twelve significant digits.

        Rounding recovers the digits of a length that was typed in this unit.
        """
        return float(f"{metres * self.per_metre:.{_DIGITS}g}")

    def shown(self, metres: float, digits: int = 6) -> str:
        """Text of a length, given in metres, in this unit and with its name."""
        return f"{metres * self.per_metre:.{digits}g} {self.name}"


METRE = UnitOfLength("m", 1.0)
LENGTH_UNITS = {unit.name: unit for unit in (METRE, UnitOfLength("mm", 1000.0))}
