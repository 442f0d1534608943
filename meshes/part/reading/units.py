"""Units of length of a part's file: what may be said for it, and whether that can be."""

from lumped.errors import InputError
from lumped.mechanism.part import METRES

# Beyond any leg in metres; a leg of 10 cm written in millimetres has the size 100.
_LARGEST = 50.0
# Below any leg.
_SMALLEST = 1e-3


def chosen_unit(said: str | None, given: str | None, source: str) -> str:
    """The file's own unit of length, or the `given` one where it says none (then metres).

    Raises InputError where both are there and differ.
    """
    if said and given and said != given:
        raise InputError(f"{source}: is in {said}, and unit = {given!r} contradicts it")
    return said or given or "m"


def require_plausible(extent: list[float], unit: str, source: str) -> None:
    """Raise InputError where a part of the `extent` (3, m) read in `unit` cannot be a leg's."""
    size = describe(extent, unit)
    if max(extent) > _LARGEST:
        raise InputError(
            f'{source}: {size} is no part of a robot; is it in mm? then say unit = "mm"'
        )
    if max(extent) < _SMALLEST:
        raise InputError(f"{source}: {size} is no part of a robot; is its unit right?")


def describe(extent: list[float], unit: str) -> str:
    """The `extent` (3) in m written in `unit`: 905 × 170 × 210 mm."""
    sides = " × ".join(f"{side / METRES[unit]:.6g}" for side in extent)
    return f"{sides} {unit}"
