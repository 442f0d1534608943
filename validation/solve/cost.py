"""Cost of a model, estimated before it is built: unknowns, memory and time.

The counts of a solid's mesh follow from the blocks of its section. The cost of its factor was
measured on legs of all shapes. Times are for one ordinary core, within a factor of three.
"""

from dataclasses import dataclass
from math import inf

from fem.machine import available_memory
from lumped.errors import InputError
from lumped.legs import ConstantLeg
from validation.solids.solid_size import solid_unknowns

# Entries of the factor of a solid leg over n^(4/3), 9 to 14 for legs of all shapes with 3000 to
# 120 000 unknowns; bytes for each with the copies at the height of a factorisation; its flops in
# entries²/n.
_ENTRIES, _BYTES_PER_ENTRY, _FLOPS = 12.0, 23.0, 1.7
# Stiffness, mass and what their assembly takes at its height, for each unknown of a solid.
_BYTES_PER_UNKNOWN, _SECONDS_PER_UNKNOWN = 10_000.0, 8e-5
_FLOPS_PER_SECOND = 5e9
# Right-hand sides that modes are found with: Lanczos columns, besides some for each mode.
_SOLVES, _SOLVES_PER_MODE = 100, 10
# Dense models: matrices alive at once, and flops of all eigenvalues in n³.
_DENSE_COPIES, _DENSE_FLOPS = 6.0, 12.0
# Estimated seconds of one answer, and of one more mesh that --accuracy makes.
LONGEST, LONGEST_REFINEMENT = 3600.0, 600.0
_HOUR = 3600.0
# Seconds for a CAD part that is not in the cache.
PER_PART = 15.0


@dataclass(frozen=True)
class Cost:
    """`unknowns` of the largest system, `memory` (bytes) at its height, `seconds` in all."""

    unknowns: float
    memory: float
    seconds: float

    @property
    def size(self) -> str:
        """About 22 000 unknowns, 0.3 GB."""
        return f"about {self.unknowns:.2g} unknowns, {self.memory / 1e9:.2g} GB"

    def __str__(self) -> str:
        """About 22 000 unknowns, 0.3 GB and 12 s."""
        hours = self.seconds / _HOUR
        time = f"{self.seconds:.2g} s" if self.seconds < _HOUR else f"{hours:.3g} h"
        return f"{self.size} and {time}"


def solid_cost(legs: tuple[ConstantLeg, ...], divisions: int, modes: int) -> Cost:
    """Cost of solid legs, factorised together, each with its mass and the first `modes`."""
    sizes = [solid_unknowns(leg, divisions) for leg in legs]
    entries = [_ENTRIES * n ** (4.0 / 3.0) for n in sizes]
    memory = sum(
        _BYTES_PER_ENTRY * L + (_BYTES_PER_UNKNOWN + 24.0 * modes) * n
        for n, L in zip(sizes, entries, strict=True)
    )
    solves = (_SOLVES + _SOLVES_PER_MODE * modes) if modes else 12
    flops = sum(_FLOPS * L**2 / n + 4.0 * solves * L for n, L in zip(sizes, entries, strict=True))
    seconds = _SECONDS_PER_UNKNOWN * sum(sizes) + flops / _FLOPS_PER_SECOND
    return Cost(sum(sizes), memory, seconds)


def dense_cost(unknowns: int, postures: int) -> Cost:
    """Cost of a model that is solved dense, compliance and modes, at some postures."""
    n = float(unknowns)
    seconds = postures * _DENSE_FLOPS * n**3 / _FLOPS_PER_SECOND
    return Cost(n, 8.0 * _DENSE_COPIES * n**2, seconds)


def require_affordable(cost: Cost, subject: str, longest: float = LONGEST) -> None:
    """Raise InputError, with the estimate, beyond the available memory or `longest` (s)."""
    available = available_memory() or inf
    if cost.memory > available:
        raise InputError(
            f"{subject}: {cost}, more than the {available / 1e9:.2g} GB of memory available"
        )
    if cost.seconds > longest:
        minutes = longest / 60.0
        raise InputError(f"{subject}: {cost}, more than the {minutes:g} minutes that it may take")
