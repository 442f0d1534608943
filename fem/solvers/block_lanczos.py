"""Search for the lowest modes of K φ = ω² M φ by block Lanczos on the flexibility of K.

T = K⁻¹M is symmetric in the inner product of M, its eigenvalues are θ = 1/ω². Blocks of right-hand
sides read a factor once for all of them. The basis is kept M-orthonormal in full, so a Ritz
value has the residual ‖T x − θ x‖_M = ‖B s‖ with the last block's B and s: some eigenvalue lies
that near (Krylov, Weinstein), and within residual²/gap of an isolated one (Kato, Temple); Parlett,
The Symmetric Eigenvalue Problem, §§10–13. A search can be told what is known already and stays
M-orthogonal to it: so it finds what an earlier one has missed.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from scipy.linalg import eigh

from fem.solvers.backends.choice import announce_fallback
from fem.solvers.backends.protocol import HOST, DeviceError, Space
from lumped.arrays import Array, SparseMatrix

# The mode after the last one only has to show where the gap is.
_RESIDUAL_BEYOND = 1e-2
# Modes closer than this in ω² belong together: no shift between them is far from both.
CLUSTER = 1e-4
# How many of the lowest modes are wanted of the values ω² (ascending) and their residuals relative
# to θ that there are so far; None where they do not tell yet.
Wanted: TypeAlias = Callable[[Array, Array], int | None]
# A direction that loses this part of its squared length to those before it is rounding error.
_DEPENDENT = 1e-20
# A pass that leaves or removes no more than this is the last; without it M is not applied again.
_ORTHONORMAL = 1e-12


class NotConvergedError(Exception):
    """Of what was looked for `converged` modes have, in as many vectors as were allowed."""

    def __init__(self, converged: int, solves: int) -> None:
        self.converged, self.solves = converged, solves
        super().__init__(f"{converged} modes converged in {solves} solves")


@dataclass(frozen=True)
class Ritz:
    """Converged pairs: ω² (ascending, m), M-orthonormal vectors (n×m), residuals relative to θ.

    `beyond` is the Ritz value after the last one, infinite where there is none.
    """

    values: Array
    vectors: Array
    residuals: Array
    beyond: float

    @property
    def errors(self) -> Array:
        """Relative errors of frequencies from residuals: half of the smaller bound of ω²'s."""
        distances = np.abs(np.append(self.values, self.beyond) - self.values[:, None])
        distances /= self.values[:, None]
        distances[distances < CLUSTER] = np.inf
        bounds = np.minimum(self.residuals, self.residuals**2 / distances.min(axis=1))
        return np.asarray(bounds / 2.0)


def merged(first: Ritz, second: Ritz) -> Ritz:
    """The pairs of two searches, of which `second` was told those of `first`."""
    values = np.concatenate([first.values, second.values])
    order = np.argsort(values, kind="stable")
    last = values[order[-1]]
    return Ritz(
        values=values[order],
        vectors=np.hstack([first.vectors, second.vectors])[:, order],
        residuals=np.concatenate([first.residuals, second.residuals])[order],
        # Below the last value it says only that more is missing: the next count will.
        beyond=second.beyond if second.beyond > last else np.inf,
    )


def _orthonormal(block: Any, basis: Any, M: Any, space: Space) -> tuple[Any, Any]:
    """The part of `block` M-orthogonal to `basis`, M-orthonormal, and M times it.

    Dependent directions are dropped. All four are in `space`.
    """
    weighted = M @ block
    size = space.get(np.einsum("ij,ij->j", block, weighted))
    moving = np.flatnonzero(size > 0.0)
    scale = space.put(1.0 / np.sqrt(size[moving]))
    block, weighted = (a[:, space.put(moving)] * scale for a in (block, weighted))
    # Again where a pass had much to remove: it leaves rounding errors of the size of that.
    for _ in range(4):
        gram = space.get(block.T @ weighted)
        squares, directions = eigh((gram + gram.T) / 2.0)
        kept = squares > _DEPENDENT
        scaled = space.put(directions[:, kept] / np.sqrt(squares[kept]))
        block, weighted = block @ scaled, weighted @ scaled
        rounding = np.finfo(float).eps / squares[kept].min(initial=1.0)
        if basis.shape[1]:
            along = basis.T @ weighted
            block -= basis @ along
            rounding = max(rounding, np.abs(space.get(along)).max(initial=0.0))
        if rounding < _ORTHONORMAL:
            break
        weighted = M @ block
    return block, weighted


def first_modes(count: int) -> Wanted:
    """The first `count` modes, and the rest of the last one's cluster."""

    def wanted(values: Array, _residuals: Array) -> int | None:
        if len(values) <= count:
            return None
        gaps = values[count:] - values[count - 1 : -1] > CLUSTER * values[count - 1 : -1]
        return count + int(np.argmax(gaps)) if gaps.any() else None

    return wanted


def modes_below(squared: float) -> Wanted:
    """All modes with ω² below `squared`, one beyond it telling that none is still to come."""

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
    """The lowest modes, as many as are `wanted`, M-orthogonal to `known` (n×m).

    `solve` is K⁻¹ on blocks (n×k), `start` (n×s) the first block before the first solve; at most
    `limit` vectors are tried. Of what is wanted no `residual` relative to θ is larger. Fewer
    come back where no more have mass. Blocks stay in `space`, where `solve` takes and leaves them;
    if its device fails, the search begins again in the host's memory. Raises NotConvergedError.
    """
    told = np.zeros((len(start), 0)) if known is None else known
    if space is not HOST:
        try:
            with space.errors():
                return _search(solve, M, start, wanted, limit, residual, told, space)
        except DeviceError as error:
            announce_fallback(error)
    return _search(solve, M, start, wanted, limit, residual, told, HOST)


def _search(
    solve: Callable[[Any], Any],
    mass: SparseMatrix,
    start: Array,
    wanted: Wanted,
    limit: int,
    residual: float,
    told: Array,
    space: Space,
) -> Ritz:
    first, M = told.shape[1], space.matrix(mass)
    everything = space.columns(len(start), first + limit, space.put(told))
    block, weighted_block = _orthonormal(
        solve(M @ space.put(start)), everything[:, :first], M, space
    )
    width = block.shape[1]
    if first + width > everything.shape[1]:
        everything = space.columns(len(start), first + limit, everything[:, :first])
    everything[:, first : first + width] = block
    solves, projected = start.shape[1], np.zeros((0, 0))
    leak = np.zeros((told.shape[1], 0))
    while True:
        reached = everything[:, : first + width]
        image = solve(weighted_block)
        weighted = M @ image
        solves += block.shape[1]
        shares = reached.T @ weighted
        along = space.get(shares)
        leak, column = np.hstack([leak, along[:first]]), along[first:]
        previous = width - block.shape[1]
        projected = np.block(
            [[projected, column[:previous]], [column[:previous].T, column[previous:]]]
        )
        following, weighted_following = _orthonormal(image - reached @ shares, reached, M, space)
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
                # What is known is known to its own residual, a part of that of what is found.
                along = np.linalg.norm(leak @ s[:, :count], axis=0) / theta[:count]
                return Ritz(
                    values=values[:count],
                    vectors=space.get(reached[:, first:] @ space.put(s[:, :count])),
                    residuals=np.hypot(residuals[:count], along),
                    beyond=float(values[count]) if len(values) > count else np.inf,
                )
        if exhausted or width + following.shape[1] > limit:
            converged = int(np.argmin(np.append(residuals <= residual, [False])))
            raise NotConvergedError(converged, solves)
        block, weighted_block = following, weighted_following
        width += block.shape[1]
        if first + width > everything.shape[1]:
            everything = space.columns(len(start), first + limit, reached)
        everything[:, first + width - block.shape[1] : first + width] = block
