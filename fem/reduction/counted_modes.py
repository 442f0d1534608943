"""Modes of a body by block Lanczos, and a count of eigenvalues that proves that none is missing.

With the flexibility A of the body, its modes φ satisfy A M φ = φ/λ. The matrix A M is symmetric in
the inner product of M. Blocks of vectors have two advantages: the factor is read once for all of
them, and repeated modes are found. Lanczos cannot detect missing modes. The number of negative
eigenvalues of K − σM, on displacements without motion of the fixed interfaces and with σ at the
cut-off, equals the number of modes below the cut-off (Sylvester). If this number exceeds the number
of modes found, the missing ones are searched with the flexibility A − Φ Λ⁻¹ Φᵀ, which does not
contain the modes Φ found so far.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.linalg import eigh
from scipy.linalg.lapack import dpstrf

from fem.reduction.held import VibratingBody
from fem.solvers.backends.cudss import space_of
from fem.solvers.block_lanczos import NotConvergedError, block_lanczos, modes_below
from lumped.arrays import fix_signs
from lumped.dense.modes import Modes
from lumped.errors import ComputationError

# Number of unknowns below which computing all modes with dense matrices is faster than Lanczos.
_DENSE_SIZE = 400
_BLOCK = 8
_LARGEST_SUBSPACE = 1600
# Largest residual of a converged mode, relative to 1/λ. The error of the shape is of this order,
# that of the frequency of the order of its square.
_CONVERGED = 1e-9
_SEED = 1
_SEARCHES = 3
# Fractions of the cut-off at which eigenvalues are counted, tried in turn, because one of them may
# coincide with an eigenvalue.
_PLACES = (1.0, 0.999, 0.997)
# Relative distance of a mode from the counting frequency below which it is not clearly on one side.
_TOO_NEAR = 1e-6


@dataclass(frozen=True)
class CountedModes(Modes):
    """All modes of a body below `cutoff` (Hz), and possibly some slightly above it.

    `counted` is the number of modes below the cut-off by a count of eigenvalues. It equals the
    number of modes found. None if eigenvalues were not counted.
    """

    cutoff: float
    counted: int | None


def _without(body: VibratingBody, excluded: Modes) -> VibratingBody:
    """Copy of a body whose flexibility does not contain the modes `excluded`."""
    shapes, squared = excluded.shapes, (2.0 * np.pi * excluded.frequencies[:, None]) ** 2

    def flexibility(forces: Any) -> Any:
        excluded_shapes, scale = map(space_of(forces).put, (shapes, squared))
        return body.flexibility(forces) - excluded_shapes @ (excluded_shapes.T @ forces / scale)

    return replace(body, flexibility=flexibility)


def counted_modes(body: VibratingBody, cutoff: float) -> CountedModes:
    """All modes of a body below `cutoff` (Hz), with a count of eigenvalues if the body supports it.

    The cut-off of the result may be slightly lower if a mode lies near it. Raises ComputationError
    if no factor for the count fits the memory, or if the count differs from the number of modes
    found in repeated searches.
    """
    body.require_count()
    modes = interface_modes(body, cutoff)
    if body.inertia is None:
        return CountedModes(modes.frequencies, modes.shapes, cutoff, None)
    for search in range(1, _SEARCHES + 1):
        counting_frequency, counted = _counted(body, modes, cutoff)
        missing = counted - int((modes.frequencies < counting_frequency).sum())
        if not missing:
            return CountedModes(modes.frequencies, modes.shapes, counting_frequency, counted)
        if missing < 0 or search == _SEARCHES:
            break
        modes = _joined(modes, interface_modes(_without(body, modes), cutoff, search))
    raise ComputationError(
        f"{body.state}: wrong number of modes: {counted} lie below {counting_frequency:.6g} Hz "
        f"(inertia of K − ω²M), and the search found {counted - missing}; use another mesh"
    )


def _counted(body: VibratingBody, modes: Modes, cutoff: float) -> tuple[float, int]:
    """Frequency (Hz) at or slightly below the cut-off, and the number of eigenvalues below it.

    `cutoff` is in Hz. The frequency is not near that of any of the `modes`. Raises ComputationError
    if eigenvalues cannot be counted there.
    """
    for share in _PLACES:
        frequency = share * cutoff
        if body.inertia and (np.abs(modes.frequencies / frequency - 1.0) > _TOO_NEAR).all():
            inertia = body.inertia((2.0 * np.pi * frequency) ** 2)
            if not inertia.zero:
                return frequency, inertia.negative
    raise ComputationError(
        f"{body.state}: zero pivots near {cutoff:.6g} Hz; the modes below it "
        "cannot be counted; choose another cut-off"
    )


def _joined(first: Modes, second: Modes) -> Modes:
    frequencies = np.concatenate([first.frequencies, second.frequencies])
    order = np.argsort(frequencies, kind="stable")
    return Modes(frequencies[order], np.hstack([first.shapes, second.shapes])[:, order])


def interface_modes(body: VibratingBody, cutoff: float, search: int = 0) -> Modes:
    """All modes below `cutoff` (Hz), without rigid motions. Shapes (n×m) have unit modal mass.

    `search` is the number of the search, which starts from random vectors of its own. Raises
    ComputationError if there are too many modes.
    """
    modes = None if body.size <= _DENSE_SIZE else _modes_below(body, cutoff, _SEED + search)
    if modes is None:
        modes = _all_modes(body, cutoff)
    below = modes.frequencies < cutoff
    return Modes(frequencies=modes.frequencies[below], shapes=fix_signs(modes.shapes[:, below]))


def _modes_below(body: VibratingBody, cutoff: float, seed: int) -> Modes | None:
    """Modes below `cutoff` (Hz), by Lanczos. None if a small body has too many of them.

    Dense matrices can then be used. `seed` is that of the random vectors. Raises ComputationError
    if a large body has too many modes below the cut-off.
    """
    # Random vectors contain modes of every symmetry. Lanczos cannot find modes that its start
    # lacks.
    start = np.random.default_rng(seed).standard_normal((body.size, _BLOCK))
    limit = min(_LARGEST_SUBSPACE, body.size // 2)
    selection = modes_below((2.0 * np.pi * cutoff) ** 2)
    try:
        ritz = block_lanczos(
            body.flexibility, body.mass, start, selection, limit, _CONVERGED, space=body.space()
        )
    except NotConvergedError as error:
        if limit < _LARGEST_SUBSPACE:
            return None
        raise ComputationError(
            f"{body.state}: the modes of the body below the cut-off of {cutoff:g} Hz were not "
            f"found in {limit} Lanczos vectors; a lower cut-off is needed"
        ) from error
    return Modes(np.sqrt(ritz.values) / (2.0 * np.pi), ritz.vectors)


def _all_modes(body: VibratingBody, cutoff: float) -> Modes:
    """Modes below `cutoff` (Hz) by dense matrices.

    With the flexibility A = S Sᵀ, the eigenvalue problem is Sᵀ M S w = w/λ, and φ = √λ S w.
    """
    flexibility = body.flexibility(np.eye(body.size))
    rounding, diagonal = np.finfo(float).eps * body.size, np.diag(flexibility)
    # The flexibility of fixed unknowns is round-off of either sign.
    moves = diagonal > rounding * diagonal.max(initial=0.0)
    scale = np.sqrt(np.where(moves, diagonal, 0.0))
    unit = np.divide(1.0, scale, out=np.zeros_like(scale), where=moves)
    symmetric = 0.5 * (flexibility + flexibility.T) * unit[:, None] * unit
    factor, order, rank, _ = dpstrf(symmetric, tol=rounding, lower=1)
    root = np.empty((body.size, rank))
    root[order - 1] = np.tril(factor)[:, :rank]
    root *= scale[:, None]
    lowest = (2.0 * np.pi * cutoff) ** -2.0
    inverse_squares, amplitudes = eigh(
        root.T @ (body.mass @ root), subset_by_value=(lowest, np.inf)
    )
    with_mass = inverse_squares > rounding * inverse_squares.max(initial=0.0)
    inverse_squares, amplitudes = (
        inverse_squares[with_mass][::-1],
        amplitudes[:, with_mass][:, ::-1],
    )
    shapes = root @ amplitudes / np.sqrt(inverse_squares)
    return Modes(1.0 / (2.0 * np.pi * np.sqrt(inverse_squares)), shapes)
