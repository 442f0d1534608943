"""Modes of a body, held or free, all of them below a cut-off, by block Lanczos.

A M φ = φ/λ with the flexibility A of the body, symmetric in the product of M. Blocks of vectors
pay twice: the factor is read once for all of them, and a mode that repeats is found as often.
"""

import numpy as np
from scipy.linalg import eigh

from fem.reduction.held import Swinging
from fem.solvers.block_lanczos import NotConvergedError, block_lanczos, modes_below
from lumped.dense.modes import Modes, fix_signs
from lumped.errors import ComputationError

# Below this number of unknowns all modes at once, dense, cost less than Lanczos.
_DENSE_SIZE = 400
_BLOCK = 8
_LARGEST_SUBSPACE = 1600
# Residual of a mode in units of 1/λ: its shape is as good, its frequency twice as many digits.
_CONVERGED = 1e-9
_SEED = 1


def interface_modes(held: Swinging, cutoff: float, search: int = 0) -> Modes:
    """All modes below `cutoff` (Hz), rigid motions left out; shapes (n×m) mass-normalised, on u.

    Every number of a `search` starts from noise of its own. Raises ComputationError where they are
    too many to find.
    """
    modes = None if held.size <= _DENSE_SIZE else _modes_below(held, cutoff, _SEED + search)
    if modes is None:
        modes = _all_modes(held)
    kept = modes.frequencies < cutoff
    return Modes(frequencies=modes.frequencies[kept], shapes=fix_signs(modes.shapes[:, kept]))


def _modes_below(held: Swinging, cutoff: float, seed: int) -> Modes | None:
    """All modes below the cut-off; None where these are a large part of all there are."""
    # Noise has a share in the modes of every symmetry; Lanczos finds none that its start lacks.
    start = np.random.default_rng(seed).standard_normal((held.size, _BLOCK))
    limit = min(_LARGEST_SUBSPACE, held.size // 2)
    wanted = modes_below((2.0 * np.pi * cutoff) ** 2)
    try:
        ritz = block_lanczos(held.flexibility, held.mass, start, wanted, limit, _CONVERGED)
    except NotConvergedError as error:
        if limit < _LARGEST_SUBSPACE:
            return None
        raise ComputationError(
            f"{held.state}: its modes below the cut-off of {cutoff:g} Hz were not "
            f"found in {limit} Lanczos vectors; a lower cut-off is needed"
        ) from error
    return Modes(np.sqrt(ritz.values) / (2.0 * np.pi), ritz.vectors)


def _all_modes(held: Swinging) -> Modes:
    """All modes with mass: with A = S Sᵀ, Sᵀ M S w = w/λ and φ = √λ S w."""
    flexibility = held.flexibility(np.eye(held.size))
    scale = np.sqrt(np.maximum(np.diag(flexibility), np.finfo(float).tiny))
    rounding = np.finfo(float).eps * held.size
    values, vectors = eigh(0.5 * (flexibility + flexibility.T) / scale[:, None] / scale)
    kept = values > rounding * values[-1]
    root = scale[:, None] * vectors[:, kept] * np.sqrt(values[kept])
    inverse_squares, amplitudes = eigh(root.T @ (held.mass @ root))
    with_mass = inverse_squares > rounding * inverse_squares.max(initial=0.0)
    inverse_squares, amplitudes = (
        inverse_squares[with_mass][::-1],
        amplitudes[:, with_mass][:, ::-1],
    )
    shapes = root @ amplitudes / np.sqrt(inverse_squares)
    return Modes(1.0 / (2.0 * np.pi * np.sqrt(inverse_squares)), shapes)
