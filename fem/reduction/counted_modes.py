"""Modes of a body, held or free, none below the cut-off missing: their number is counted.

Lanczos cannot know what it missed. The negative eigenvalues of K − σM on the displacements that
leave what is held where it is, σ at the cut-off, are as many as there are modes below it
(Sylvester). What the count finds beyond the search is searched for, the flexibility being without
what is found: A − Φ Λ⁻¹ Φᵀ has the other modes, and these alone.
"""

from dataclasses import dataclass, replace

import numpy as np

from fem.reduction.held import Swinging
from fem.reduction.interface_modes import interface_modes
from lumped.arrays import Array
from lumped.dense.modes import Modes
from lumped.errors import ComputationError

_SEARCHES = 3
# Shares of the cut-off at which is counted: an eigenvalue may lie at one of them by chance.
_PLACES = (1.0, 0.999, 0.997)
# A mode nearer than this to where is counted (relative) is on neither side of it.
_TOO_NEAR = 1e-6


@dataclass(frozen=True)
class CountedModes(Modes):
    """All modes below `cutoff` (Hz); some may lie just above it.

    `counted` lie below it by inertia: as many as were found; None where nobody counts.
    """

    cutoff: float
    counted: int | None


def _without(held: Swinging, known: Modes) -> Swinging:
    """A body without the modes that are known."""
    shapes, squared = known.shapes, (2.0 * np.pi * known.frequencies[:, None]) ** 2

    def flexibility(forces: Array) -> Array:
        return np.asarray(held.flexibility(forces) - shapes @ (shapes.T @ forces / squared))

    return replace(held, flexibility=flexibility)


def counted_modes(held: Swinging, cutoff: float) -> CountedModes:
    """All modes below `cutoff` (Hz), counted where the body can.

    Raises ComputationError where more are counted than can be found, or fewer than were found.
    """
    modes = interface_modes(held, cutoff)
    if held.inertia is None:
        return CountedModes(modes.frequencies, modes.shapes, cutoff, None)
    for search in range(1, _SEARCHES + 1):
        place, counted = _counted(held, modes, cutoff)
        missing = counted - int((modes.frequencies < place).sum())
        if not missing:
            return CountedModes(modes.frequencies, modes.shapes, place, counted)
        if missing < 0 or search == _SEARCHES:
            break
        modes = _joined(modes, interface_modes(_without(held, modes), cutoff, search))
    raise ComputationError(
        f"{held.state}: certificate of the modes failed: {counted} lie below "
        f"{place:.6g} Hz, {counted - missing} were found"
    )


def _counted(held: Swinging, modes: Modes, cutoff: float) -> tuple[float, int]:
    """Frequency (Hz) at or just below the cut-off, and how many modes lie below it."""
    for share in _PLACES:
        place = share * cutoff
        if held.inertia and (np.abs(modes.frequencies / place - 1.0) > _TOO_NEAR).all():
            found = held.inertia((2.0 * np.pi * place) ** 2)
            if not found.zero:
                return place, found.negative
    raise ComputationError(
        f"{held.state}: zero pivots near {cutoff:.6g} Hz; the modes below it "
        "cannot be counted, take another cut-off"
    )


def _joined(some: Modes, more: Modes) -> Modes:
    frequencies = np.concatenate([some.frequencies, more.frequencies])
    order = np.argsort(frequencies, kind="stable")
    return Modes(frequencies[order], np.hstack([some.shapes, more.shapes])[:, order])
