"""Modes of a body, held or free, all of them below a cut-off, by block Lanczos.

A M φ = φ/λ with the flexibility A of the body, symmetric in the product of M. Blocks of vectors
pay twice: the factor is read once for all of them, and a mode that repeats is found as often.
"""

import numpy as np
from scipy.linalg import LinAlgError, cholesky, eigh, solve_triangular

from fem.reduction.held import Swinging
from lumped.arrays import Array, SparseMatrix
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
    smallest = (2.0 * np.pi * cutoff) ** -2
    # Noise has a share in the modes of every symmetry; Lanczos finds none that its start lacks.
    noise = np.random.default_rng(seed).standard_normal((held.size, _BLOCK))
    block, _ = _orthonormal(held.mass, held.flexibility(noise))
    basis = [block]
    projected = np.zeros((0, 0))
    limit = min(_LARGEST_SUBSPACE, held.size // 2)
    while _BLOCK * len(basis) <= limit:
        image = held.flexibility(held.mass @ basis[-1])
        shares = _take_off(held.mass, basis, image)
        shares += _take_off(held.mass, basis, image)
        grown = np.zeros((len(shares), len(shares)))
        grown[: len(projected), : len(projected)] = projected
        grown[:, -_BLOCK:] = shares
        grown[-_BLOCK:] = shares.T
        projected = grown
        following, coupling = _orthonormal(held.mass, image)
        inverse_squares, vectors = eigh(projected)
        residuals = np.linalg.norm(coupling @ vectors[-_BLOCK:], axis=0)
        wanted = inverse_squares + residuals > smallest
        # One mode beyond the cut-off shows that none below it is still to come.
        if np.all(residuals[wanted] < _CONVERGED * inverse_squares[wanted]) and not wanted.all():
            chosen = inverse_squares > smallest
            return _ritz_modes(basis, inverse_squares[chosen], vectors[:, chosen])
        basis.append(following)
    if limit < _LARGEST_SUBSPACE:
        return None
    raise ComputationError(
        f"{held.state}: its modes below the cut-off of {cutoff:g} Hz were not "
        f"found in {limit} Lanczos vectors; a lower cut-off is needed"
    )


def _take_off(mass: SparseMatrix, basis: list[Array], block: Array) -> Array:
    """Shares (m×b) of `block` (n×b) in the basis; the block loses them."""
    momenta = mass @ block
    shares = [vectors.T @ momenta for vectors in basis]
    for vectors, share in zip(basis, shares, strict=True):
        block -= vectors @ share
    return np.vstack(shares)


def _orthonormal(mass: SparseMatrix, block: Array) -> tuple[Array, Array]:
    """Q with QᵀMQ = I and R with Q R = `block` (n×b), by Cholesky twice for its rounding."""
    total = np.eye(block.shape[1])
    for _ in range(2):
        gram = block.T @ (mass @ block)
        try:
            upper = cholesky(gram)
        except LinAlgError as error:
            raise ComputationError(
                "modes of a reduction: fewer have mass than are looked for"
            ) from error
        block = solve_triangular(upper, block.T, trans="T").T
        total = upper @ total
    return block, total


def _ritz_modes(basis: list[Array], inverse_squares: Array, vectors: Array) -> Modes:
    coefficients = vectors[:, ::-1].reshape(len(basis), _BLOCK, -1)
    shapes = sum(
        (block @ part for block, part in zip(basis, coefficients, strict=True)),
        np.zeros((len(basis[0]), coefficients.shape[2])),
    )
    return Modes(1.0 / (2.0 * np.pi * np.sqrt(inverse_squares[::-1])), shapes)


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
