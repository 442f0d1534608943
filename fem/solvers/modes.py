"""Lowest modes of K φ = ω² M φ, certified by a count of eigenvalues (Sturm).

Lanczos (`fem.solvers.block_lanczos`) cannot detect a missed mode. Therefore the negative
eigenvalues of K − σM are counted, with σ in the gap above the last mode. If the count exceeds the
number of modes found, the search is continued orthogonally to these modes until none is missing.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np

from fem.solvers.backends.protocol import HOST, Space
from fem.solvers.block_lanczos import NotConvergedError, Ritz, block_lanczos, first_modes, merged
from fem.solvers.davidson import StagnationError, davidson
from fem.solvers.factor import Inertia
from lumped.arrays import Array, SparseMatrix, fix_signs
from lumped.dense.modes import Modes, too_few
from lumped.errors import ComputationError, InputError
from lumped.text import counted

# Number of columns per block. For 20 modes, 6 to 12 columns take the same time. With fewer, the
# factor is read more often; with more, more columns are needed in total.
_BLOCK = 8
_SEED = 1
# Largest residual of a mode, relative to θ = 1/ω². Half of it bounds the relative error of a
# frequency without any assumption. The bound is 5e-10 for a mode whose distance from its neighbours
# in ω² is 1e-3.
_RESIDUAL = 1e-6
# Largest number of multigrid cycles for each mode. 15 to 30 are usual. Nearly incompressible
# parts and slender legs can need thousands.
_CYCLES = 300
# Largest number of searches for missing modes, each from different random vectors.
_SEARCHES = 4
# Relative distance of the shift above the last mode. It is at most half way to the next mode.
_SHIFT_ABOVE = 1e-2
# Positions of σ in its interval. Several are needed because a pivot may vanish at one of them.
_FRACTIONS = (1.0, 0.8, 0.6)

Solve: TypeAlias = Callable[[Any], Any]
Count: TypeAlias = Callable[[float], Inertia]


@dataclass(frozen=True)
class CertifiedModes(Modes):
    """Lowest modes with the proof that none is missing.

    `frequency_errors` are estimated relative errors, the smaller of two bounds from the residual.
    `count` is the number of eigenvalues below `shift` (rad²/s²), by the signs of K − shift·M. These
    eigenvalues are those of the returned modes and possibly of further ones, such as the rest of
    the cluster of the last mode.
    """

    frequency_errors: Array
    shift: float
    count: int


class MissedModesError(ComputationError):
    """Error: below the shift there are `missing` more eigenvalues than modes found."""

    def __init__(self, message: str, missing: int, part: str = "") -> None:
        self.missing = missing
        super().__init__(message, part)


def certify(values: Array, beyond: float, count: Count, part: str) -> float:
    """Shift σ (rad²/s²) below which there are provably no other eigenvalues than `values`.

    `values` are the eigenvalues found (ω², ascending), `beyond` is the next one, or infinite if it
    is unknown. `count` is a function of σ that returns the inertia of K − σM. `part` is the name in
    messages. Raises MissedModesError if the count is higher than the number of values,
    ComputationError if the count is lower or cannot be made.
    """
    last, mode_count = float(values[-1]), len(values)
    half_way = (beyond - last) / 2.0
    near = min(_SHIFT_ABOVE * last, half_way)
    # The last of these shifts is farthest above the last mode, with the largest margin for
    # round-off.
    for above in [*(fraction * near for fraction in _FRACTIONS), min(half_way, last)]:
        sigma = last + above
        inertia = count(sigma)
        if inertia.zero:
            continue
        missing = inertia.negative - mode_count
        message = (
            f"wrong number of modes: {inertia.negative} lie below "
            f"{np.sqrt(sigma) / (2.0 * np.pi):.6g} Hz (inertia of K − ω²M), and the search found "
            f"{mode_count}; request another number of modes, or use another mesh"
        )
        if missing > 0:
            raise MissedModesError(message, missing, part)
        if missing < 0:
            raise ComputationError(message, part)
        return sigma
    raise ComputationError(
        f"the modes cannot be counted: zero pivots near "
        f"{np.sqrt(last) / (2.0 * np.pi):.6g} Hz; request another number of modes",
        part=part,
    )


def lowest_modes(
    solve: Solve,
    M: SparseMatrix,
    mode_count: int,
    count: Count,
    part: str,
    space: Space = HOST,
) -> CertifiedModes:
    """The lowest `mode_count` modes, certified by a count of eigenvalues.

    `solve` is a function that multiplies blocks (n×k) by K⁻¹, in the memory `space` or on the host.
    `M` (csr n×n) may be semidefinite. `count` is a function of σ that returns the inertia of K −
    σM. Shapes on the n unknowns have unit modal mass. If the count shows missed modes, as many are
    searched M-orthogonally to those found, from other random vectors, and the count is repeated.
    Raises InputError for fewer than one mode, ComputationError, with `part` in its message, if
    modes do not converge or the certificate still fails.
    """
    n = M.shape[0]
    if mode_count < 1:
        raise InputError(f"modes = {mode_count!r}: must be 1 or more", part=part)
    rng = np.random.default_rng(_SEED)
    ritz = _converged_pairs(solve, M, _random_block(n, rng), mode_count, part, space)
    for search in range(_SEARCHES):
        try:
            sigma = certify(ritz.values, ritz.beyond, count, part)
        except MissedModesError as error:
            if search == _SEARCHES - 1:
                raise
            missed = _converged_pairs(
                solve, M, _random_block(n, rng), error.missing, part, space, ritz.vectors
            )
            ritz = merged(ritz, missed)
        else:
            break
    first = _lowest(ritz, mode_count)
    return CertifiedModes(
        frequencies=first.frequencies,
        shapes=first.shapes,
        frequency_errors=ritz.errors[:mode_count],
        shift=sigma,
        count=len(ritz.values),
    )


def searched_modes(
    solve: Solve, M: SparseMatrix, mode_count: int, part: str, space: Space = HOST
) -> Modes:
    """The lowest `mode_count` modes as in `lowest_modes`, without the count that certifies them."""
    block = _random_block(M.shape[0], np.random.default_rng(_SEED))
    return _lowest(_converged_pairs(solve, M, block, mode_count, part, space), mode_count)


def preconditioned_modes(
    K: SparseMatrix,
    M: SparseMatrix,
    precondition: Solve,
    solve: Solve,
    mode_count: int,
    part: str,
) -> Modes:
    """The lowest `mode_count` modes from K, M (csr n×n) and a preconditioner, without a count.

    `precondition` is an approximation of K⁻¹ on blocks (n×k), see `fem.solvers.davidson`. K and M
    are positive definite on its results. If it is too inaccurate for a search, the modes are those
    of `searched_modes` with `solve`. Shapes have unit modal mass. Raises ComputationError, with
    `part` in its message, if modes do not converge or there are fewer.
    """
    start = precondition(M @ _random_block(M.shape[0], np.random.default_rng(_SEED)))
    limit = _CYCLES * mode_count
    try:
        values, shapes = davidson(K, M, precondition, start, mode_count, limit)
    except StagnationError:
        return searched_modes(solve, M, mode_count, part)
    if len(values) < mode_count:
        raise too_few(part, mode_count)
    return Modes(np.sqrt(values) / (2.0 * np.pi), fix_signs(shapes))


def _converged_pairs(
    solve: Solve,
    M: SparseMatrix,
    start: Array,
    count: int,
    part: str,
    space: Space,
    known: Array | None = None,
) -> Ritz:
    limit = 12 * count + 20 * start.shape[1]
    requirement = first_modes(count)
    try:
        ritz = block_lanczos(solve, M, start, requirement, limit, _RESIDUAL, known, space)
    except NotConvergedError as error:
        raise ComputationError(
            f"{min(error.converged, count)} of {counted(count, 'mode')} converged in "
            f"{counted(error.solves, 'solve')}; fewer modes or a finer mesh are needed",
            part=part,
        ) from error
    if len(ritz.values) < count:
        requested = count + (0 if known is None else known.shape[1])
        raise too_few(part, requested)
    return ritz


def _random_block(n: int, rng: np.random.Generator) -> Array:
    """A block (n×s) of random vectors, which have components in modes of every symmetry."""
    return np.asarray(rng.standard_normal((n, _BLOCK)) / np.sqrt(n))


def _lowest(ritz: Ritz, mode_count: int) -> Modes:
    frequencies = np.sqrt(ritz.values[:mode_count]) / (2.0 * np.pi)
    return Modes(frequencies, fix_signs(ritz.vectors[:, :mode_count]))
