"""What is asked for, checked before any mesh is made: impossible requests with their reasons."""

from lumped.errors import InputError
from lumped.sections import Rectangle, Section


def _division_faults(section: Section, divisions: int | tuple[int, int]) -> list[str]:
    if isinstance(divisions, tuple):
        if not isinstance(section, Rectangle):
            return [f"divisions = {divisions}: two numbers suit a solid rectangle alone"]
        if min(divisions) < 1:
            return [f"divisions = {divisions}: both must be at least 1"]
    elif divisions < 1:
        return [f"divisions = {divisions}: must be at least 1 element across the smaller side"]
    return []


def require_section(section: Section, divisions: int | tuple[int, int]) -> None:
    """Raise InputError with every fault of a section's shape and of its divisions."""
    faults = section.faults() + _division_faults(section, divisions)
    if faults:
        raise InputError(f"{section.shape}: {fault}" for fault in faults)


def require_leg(section: Section, length: float, divisions: int | tuple[int, int]) -> None:
    """Raise InputError with every fault of a prismatic leg of `length` (m).

    A body shorter than the larger side of its section is no leg: its two ends lie within the
    distance over which Saint-Venant's principle lets end effects decay.
    """
    require_section(section, divisions)
    if not length > 0.0:
        raise InputError(f"length = {length!r}: must be above 0 m")
    if length < max(section.extent):
        raise InputError(
            f"length = {length!r}: shorter than its {section.shape} section, "
            f"{max(section.extent):g} m; a leg must be at least as long as its section is large"
        )
