"""Check of the host's memory before a factorisation."""

from fem.machine import available_memory
from lumped.errors import ComputationError


def require_memory(peak_bytes: int, unknowns: int, part: str) -> None:
    """Raise ComputationError, with `part` in its message, if the available memory is insufficient.

    `peak_bytes` is the predicted memory of a factorisation with `unknowns` unknowns.
    """
    available = available_memory()
    if available is not None and peak_bytes > available:
        raise ComputationError(
            f"factorising {unknowns} unknowns needs about {peak_bytes / 1e9:.1f} GB and "
            f"{available / 1e9:.1f} GB are available: use fewer divisions, a shorter leg, or, "
            "for statics, condensation by doubling or --solver petsc (without a factor)",
            part=part,
        )
