"""Modes of a body, held or free, by block Lanczos, and a count that none of them is missing.

A M φ = φ/λ with the flexibility A of the body, symmetric in the product of M. Blocks of vectors pay
twice: the factor is read once for all of them, and a mode that repeats is found as often. Lanczos
cannot know what it missed. The negative eigenvalues of K − σM on the displacements that
leave what is held where it is, σ at the cut-off, are as many as there are modes below it
(Sylvester). What the count finds beyond the search is searched for, the flexibility being without
what is found: A − Φ Λ⁻¹ Φᵀ has the other modes, and these alone.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.linalg import eigh
from scipy.linalg.lapack import dpstrf

from fem.reduction.held import Swinging
from fem.solvers.block_lanczos import NotConvergedError, block_lanczos, modes_below
from fem.solvers.spaces import space_of
from lumped.arrays import fix_signs
from lumped.dense.modes import Modes
from lumped.errors import ComputationError

# Below this number of unknowns all modes at once, dense, cost less than Lanczos.
_DENSE_SIZE = 400
_BLOCK = 8
_LARGEST_SUBSPACE = 1600
# Residual of a mode in units of 1/λ: its shape is as good, its frequency twice as many digits.
_CONVERGED = 1e-9
_SEED = 1
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

    def flexibility(forces: Any) -> Any:
        found, scale = map(space_of(forces).put, (shapes, squared))
        return held.flexibility(forces) - found @ (found.T @ forces / scale)

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


def interface_modes(held: Swinging, cutoff: float, search: int = 0) -> Modes:
    """All modes below `cutoff` (Hz), rigid motions left out; shapes (n×m) mass-normalised, on u.

    Every number of a `search` starts from noise of its own. Raises ComputationError where they are
    too many to find.
    """
    modes = None if held.size <= _DENSE_SIZE else _modes_below(held, cutoff, _SEED + search)
    if modes is None:
        modes = _all_modes(held, cutoff)
    kept = modes.frequencies < cutoff
    return Modes(frequencies=modes.frequencies[kept], shapes=fix_signs(modes.shapes[:, kept]))


def _modes_below(held: Swinging, cutoff: float, seed: int) -> Modes | None:
    """All modes below the cut-off; None where these are a large part of all there are."""
    # Noise has a share in the modes of every symmetry; Lanczos finds none that its start lacks.
    start = np.random.default_rng(seed).standard_normal((held.size, _BLOCK))
    limit = min(_LARGEST_SUBSPACE, held.size // 2)
    wanted = modes_below((2.0 * np.pi * cutoff) ** 2)
    try:
        ritz = block_lanczos(
            held.flexibility, held.mass, start, wanted, limit, _CONVERGED, space=held.space()
        )
    except NotConvergedError as error:
        if limit < _LARGEST_SUBSPACE:
            return None
        raise ComputationError(
            f"{held.state}: its modes below the cut-off of {cutoff:g} Hz were not "
            f"found in {limit} Lanczos vectors; a lower cut-off is needed"
        ) from error
    return Modes(np.sqrt(ritz.values) / (2.0 * np.pi), ritz.vectors)


def _all_modes(held: Swinging, cutoff: float) -> Modes:
    """Modes with mass below the cut-off: with A = S Sᵀ, Sᵀ M S w = w/λ and φ = √λ S w."""
    flexibility = held.flexibility(np.eye(held.size))
    rounding, own = np.finfo(float).eps * held.size, np.diag(flexibility)
    # What is held moves by rounding alone, of either sign.
    moves = own > rounding * own.max(initial=0.0)
    scale = np.sqrt(np.where(moves, own, 0.0))
    unit = np.divide(1.0, scale, out=np.zeros_like(scale), where=moves)
    symmetric = 0.5 * (flexibility + flexibility.T) * unit[:, None] * unit
    factor, order, rank, _ = dpstrf(symmetric, tol=rounding, lower=1)
    root = np.empty((held.size, rank))
    root[order - 1] = np.tril(factor)[:, :rank]
    root *= scale[:, None]
    lowest = (2.0 * np.pi * cutoff) ** -2.0
    inverse_squares, amplitudes = eigh(
        root.T @ (held.mass @ root), subset_by_value=(lowest, np.inf)
    )
    with_mass = inverse_squares > rounding * inverse_squares.max(initial=0.0)
    inverse_squares, amplitudes = (
        inverse_squares[with_mass][::-1],
        amplitudes[:, with_mass][:, ::-1],
    )
    shapes = root @ amplitudes / np.sqrt(inverse_squares)
    return Modes(1.0 / (2.0 * np.pi * np.sqrt(inverse_squares)), shapes)
