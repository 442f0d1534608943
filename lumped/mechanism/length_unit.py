"""Units of length in robot files and in messages. All other quantities are in SI units."""

from collections.abc import Mapping
from dataclasses import dataclass

# Unit of a coordinate of a pose, which the tool's moves make a length or an angle.
COORDINATES = "m or rad"
# Power of the length in each unit of a rule.
POWERS: Mapping[str, int] = {
    COORDINATES: 1,
    **{unit: power for power, unit in enumerate(("m", "m²", "m³", "m⁴", "m⁵", "m⁶"), start=1)},
}
# Significant digits after conversion from a file's unit to metres and back.
_DIGITS = 12


@dataclass(frozen=True)
class UnitOfLength:
    """A unit of length: its `name` and the number of units `per_metre`."""

    name: str
    per_metre: float

    def of(self, metres: float) -> float:
        """A length (m) converted to this unit, as its author typed it."""
        return float(f"{metres * self.per_metre:.{_DIGITS}g}")

    def shown(self, metres: float, digits: int = 6) -> str:
        """Text of a length (m) in this unit."""
        return f"{metres * self.per_metre:.{digits}g} {self.name}"


METRE = UnitOfLength("m", 1.0)
LENGTH_UNITS = {unit.name: unit for unit in (METRE, UnitOfLength("mm", 1000.0))}
