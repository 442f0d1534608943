"""Search for the lowest modes of K φ = ω² M φ by block Lanczos with the flexibility K⁻¹.

T = K⁻¹M is symmetric in the inner product of M and has the eigenvalues θ = 1/ω². With blocks of
right-hand sides a factor is read once for all of them. The whole basis is kept M-orthonormal.
Therefore a Ritz value has the residual ‖T x − θ x‖_M = ‖B s‖. Here B couples the last block of the
basis with the next one, and s are the components of the Ritz vector x in the last block. An
eigenvalue lies within this distance (Krylov, Weinstein), and an isolated one within residual²/gap
(Kato, Temple); Parlett, The Symmetric Eigenvalue Problem, §§10–13. A search is M-orthogonal to
modes that are already known, and thus finds those that an earlier search has missed.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from scipy.linalg import eigh

from fem.solvers.backends.choice import announce_fallback
from fem.solvers.backends.protocol import HOST, DeviceError, Space
from lumped.arrays import Array, SparseMatrix

# Largest residual of the mode after the last requested one, which only has to locate the gap.
_RESIDUAL_BEYOND = 1e-2
# Relative distance in ω² below which modes form a cluster: no shift between them is far from both.
CLUSTER = 1e-4
# Function that returns the required number of lowest modes, from the current values ω² (ascending)
# and their residuals relative to θ. None if these do not determine it yet.
Wanted: TypeAlias = Callable[[Array, Array], int | None]
# A direction whose squared length is reduced to this fraction by orthogonalisation is round-off.
_DEPENDENT = 1e-20
# Orthogonalisation ends after a pass with at most this round-off. M is then not applied again.
_ORTHONORMAL = 1e-12


class NotConvergedError(Exception):
    """Error: only `converged` of the required modes converged with the allowed vectors."""

    def __init__(self, converged: int, solves: int) -> None:
        self.converged, self.solves = converged, solves
        super().__init__(f"{converged} modes converged in {solves} solves")


@dataclass(frozen=True)
class Ritz:
    """Converged modes: `values` ω² (m, ascending) and M-orthonormal `vectors` (n×m).

    `residuals` (m) are relative to 1/ω². `beyond` is the next Ritz value of ω², which need not have
    converged. Infinite if there is none.
    """

    values: Array
    vectors: Array
    residuals: Array
    beyond: float

    @property
    def errors(self) -> Array:
        """Estimated relative errors (m) of the frequencies, by the smaller of two bounds on ω²."""
        distances = np.abs(np.append(self.values, self.beyond) - self.values[:, None])
        distances /= self.values[:, None]
        distances[distances < CLUSTER] = np.inf
        bounds = np.minimum(self.residuals, self.residuals**2 / distances.min(axis=1))
        return np.asarray(bounds / 2.0)


def merged(first: Ritz, second: Ritz) -> Ritz:
    """Modes of two searches. Those of `second` must be M-orthogonal to those of `first`."""
    values = np.concatenate([first.values, second.values])
    order = np.argsort(values, kind="stable")
    last = values[order[-1]]
    return Ritz(
        values=values[order],
        vectors=np.hstack([first.vectors, second.vectors])[:, order],
        residuals=np.concatenate([first.residuals, second.residuals])[order],
        # A value below the last one means that more modes are missing, which the next count shows.
        beyond=second.beyond if second.beyond > last else np.inf,
    )


def orthonormal_block(block: Any, basis: Any, M: Any, space: Space) -> tuple[Any, Any]:
    """M-orthonormal basis W of the part of `block` that is M-orthogonal to `basis`, and M W.

    Dependent directions are dropped. Arguments and results are in the memory `space`.
    """
    weighted = M @ block
    size = space.get(np.einsum("ij,ij->j", block, weighted))
    moving = np.flatnonzero(size > 0.0)
    scale = space.put(1.0 / np.sqrt(size[moving]))
    block, weighted = (a[:, space.put(moving)] * scale for a in (block, weighted))
    # A pass that removes a large part is repeated, because its round-off is proportional to that
    # part.
    for _ in range(4):
        gram = space.get(block.T @ weighted)
        squares, directions = eigh((gram + gram.T) / 2.0)
        independent = squares > _DEPENDENT
        scaled = space.put(directions[:, independent] / np.sqrt(squares[independent]))
        block, weighted = block @ scaled, weighted @ scaled
        rounding = np.finfo(float).eps / squares[independent].min(initial=1.0)
        if basis.shape[1]:
            along = basis.T @ weighted
            block -= basis @ along
            rounding = max(rounding, np.abs(space.get(along)).max(initial=0.0))
        if rounding < _ORTHONORMAL:
            break
        weighted = M @ block
    return block, weighted


def first_modes(count: int) -> Wanted:
    """Requirement that the first `count` modes and the cluster of the last one converge."""

    def wanted(values: Array, _residuals: Array) -> int | None:
        if len(values) <= count:
            return None
        gaps = values[count:] - values[count - 1 : -1] > CLUSTER * values[count - 1 : -1]
        return count + int(np.argmax(gaps)) if gaps.any() else None

    return wanted


def modes_below(squared: float) -> Wanted:
    """Requirement that all modes with ω² below `squared` converge.

    The search ends with one mode above `squared` (rad²/s²), which shows that all are found.
    """

    def wanted(values: Array, residuals: Array) -> int | None:
        below = int(np.sum(values < squared * (1.0 + residuals)))
        return below if below < len(values) else None

    return wanted


def block_lanczos(
    solve: Callable[[Any], Any],
    M: SparseMatrix,
    start: Array,
    wanted: Wanted,
    limit: int,
    residual: float,
    known: Array | None = None,
    space: Space = HOST,
) -> Ritz:
    """The lowest modes, as many as `wanted` requires, M-orthogonal to `known` (n×m).

    `solve` is a function that multiplies a block (n×k) by K⁻¹. `start` (n×s) is a block of vectors,
    and the first block of the basis is K⁻¹M times it. At most `limit` vectors are used. The
    residual of each returned mode relative to θ is at most `residual`. Fewer modes are returned if
    no more have mass. Blocks, and input and output of `solve`, are in the memory `space`. If its
    device fails, the search restarts in the memory of the host. Raises NotConvergedError.
    """
    known_vectors = np.zeros((len(start), 0)) if known is None else known
    if space is not HOST:
        try:
            with space.errors():
                return _search(solve, M, start, wanted, limit, residual, known_vectors, space)
        except DeviceError as error:
            announce_fallback(error)
    return _search(solve, M, start, wanted, limit, residual, known_vectors, HOST)


def _search(
    solve: Callable[[Any], Any],
    mass: SparseMatrix,
    start: Array,
    wanted: Wanted,
    limit: int,
    residual: float,
    known_vectors: Array,
    space: Space,
) -> Ritz:
    first, M = known_vectors.shape[1], space.matrix(mass)
    everything = space.columns(len(start), first + limit, space.put(known_vectors))
    block, weighted_block = orthonormal_block(
        solve(M @ space.put(start)), everything[:, :first], M, space
    )
    width = block.shape[1]
    if first + width > everything.shape[1]:
        everything = space.columns(len(start), first + limit, everything[:, :first])
    everything[:, first : first + width] = block
    solves, projected = start.shape[1], np.zeros((0, 0))
    leak = np.zeros((known_vectors.shape[1], 0))
    while True:
        tried = everything[:, : first + width]
        image = solve(weighted_block)
        weighted = M @ image
        solves += block.shape[1]
        shares = tried.T @ weighted
        along = space.get(shares)
        leak, column = np.hstack([leak, along[:first]]), along[first:]
        previous = width - block.shape[1]
        projected = np.block(
            [[projected, column[:previous]], [column[:previous].T, column[previous:]]]
        )
        following, weighted_following = orthonormal_block(image - tried @ shares, tried, M, space)
        coefficients = space.get(following.T @ weighted)
        theta, s = eigh((projected + projected.T) / 2.0)
        theta, s = theta[::-1], s[:, ::-1]
        has_mass = theta > np.finfo(float).eps * len(theta) * theta.max(initial=0.0)
        theta, s = theta[has_mass], s[:, has_mass]
        values = 1.0 / theta
        residuals = np.linalg.norm(coefficients @ s[previous:], axis=0) / theta
        exhausted = following.shape[1] == 0
        count = wanted(values, residuals)
        if exhausted and count is None:
            count = len(values)
        if count is not None and np.all(residuals[:count] <= residual):
            beyond = residuals[count : count + 1]
            if np.all(beyond <= _RESIDUAL_BEYOND):
                # Residuals of the known modes add to those of the new modes.
                along = np.linalg.norm(leak @ s[:, :count], axis=0) / theta[:count]
                return Ritz(
                    values=values[:count],
                    vectors=space.get(tried[:, first:] @ space.put(s[:, :count])),
                    residuals=np.hypot(residuals[:count], along),
                    beyond=float(values[count]) if len(values) > count else np.inf,
                )
        if exhausted or width + following.shape[1] > limit:
            converged = int(np.argmin(np.append(residuals <= residual, [False])))
            raise NotConvergedError(converged, solves)
        block, weighted_block = following, weighted_following
        width += block.shape[1]
        if first + width > everything.shape[1]:
            everything = space.columns(len(start), first + limit, tried)
        everything[:, first + width - block.shape[1] : first + width] = block
