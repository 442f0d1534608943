"""Search for the lowest modes of K φ = ω² M φ by block Lanczos on the factor of K.

T = K⁻¹M is symmetric in the inner product of M, its eigenvalues are θ = 1/ω². Blocks of right-hand
sides read the factor once for all of them. The basis is kept M-orthonormal in full, so a Ritz
value has the residual ‖T x − θ x‖_M = ‖B s‖ with the last block's B and s: some eigenvalue lies
that near (Krylov, Weinstein), and within residual²/gap of an isolated one (Kato, Temple); Parlett,
The Symmetric Eigenvalue Problem, §§10–13. A search can be told what is known already and stays
M-orthogonal to it: so it finds what an earlier one has missed.
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.sparse.linalg import LinearOperator

from fem.solvers.factor import Factor
from lumped.arrays import Array, SparseMatrix
from lumped.errors import ComputationError

# Residual relative to θ: bounds the relative error of a frequency by half of it without any
# assumption, and by 5e-10 for a mode that keeps 1e-3 from its neighbours in ω².
_RESIDUAL = 1e-6
# The mode after the last one only has to show where the gap is.
_RESIDUAL_BEYOND = 1e-2
# Modes closer than this in ω² belong together: no shift between them is far from both.
CLUSTER = 1e-4
# A direction that loses this part of its squared length to those before it is rounding error.
_DEPENDENT = 1e-20
# Squared lengths this near to one: what the pass removed was below the square root of rounding.
_ORTHONORMAL = 1e-8


@dataclass(frozen=True)
class Ritz:
    """Converged pairs: ω² (ascending, m), M-orthonormal vectors (n×m), residuals relative to θ.

    `beyond` is the Ritz value after the last one, infinite where there is none; `solves` the
    number of right-hand sides solved for.
    """

    values: Array
    vectors: Array
    residuals: Array
    beyond: float
    solves: int

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
        solves=first.solves + second.solves,
    )


def _orthonormal(
    block: Array, weighted: Array, basis: Array, M: SparseMatrix | LinearOperator
) -> tuple[Array, Array]:
    """The part of `block` M-orthogonal to `basis`, M-orthonormal, and M times it.

    `weighted` is M times `block`. Dependent directions are dropped.
    """
    size = np.einsum("ij,ij->j", block, weighted)
    block, weighted = (a[:, size > 0.0] / np.sqrt(size[size > 0.0]) for a in (block, weighted))
    # Again: a pass leaves rounding errors of the size of what it removed. Where it found the block
    # orthonormal, it had nothing to remove.
    for _ in range(3):
        block = block - basis @ (basis.T @ weighted)
        weighted = M @ block
        gram = block.T @ weighted
        squares, directions = eigh((gram + gram.T) / 2.0)
        kept = squares > _DEPENDENT
        scaled = directions[:, kept] / np.sqrt(squares[kept])
        block, weighted = block @ scaled, weighted @ scaled
        if np.all(np.abs(squares - 1.0) < _ORTHONORMAL):
            break
    return np.asarray(block), np.asarray(weighted)


def _last_wanted(values: Array, count: int) -> int:
    """Number of modes up to the first gap at or after `count`, 0 where no gap is in sight."""
    gaps = values[count:] - values[count - 1 : -1] > CLUSTER * values[count - 1 : -1]
    return count + int(np.argmax(gaps)) if gaps.any() else 0


def block_lanczos(
    factor: Factor,
    M: SparseMatrix | LinearOperator,
    start: Array,
    count: int,
    part: str,
    known: Array | None = None,
) -> Ritz:
    """The lowest `count` modes M-orthogonal to `known` (n×m), and the rest of the last's cluster.

    `start` (n×s): the first block before the first solve. Raises ComputationError, naming `part`,
    where fewer modes have mass or they do not converge.
    """
    told = np.zeros((len(start), 0)) if known is None else known
    limit = 12 * count + 20 * start.shape[1]
    # One array from the beginning: pages never reached take no memory, and nothing is copied.
    first = told.shape[1]
    everything = np.empty((len(start), first + limit), order="F")
    everything[:, :first] = told
    block = factor.solve(M @ start)
    block, weighted_block = _orthonormal(block, M @ block, told, M)
    width = block.shape[1]
    everything[:, first : first + width] = block
    solves, projected = start.shape[1], np.zeros((0, 0))
    leak = np.zeros((told.shape[1], 0))
    while True:
        basis = everything[:, first : first + width]
        image = factor.solve(weighted_block)
        weighted = M @ image
        solves += block.shape[1]
        column = basis.T @ weighted
        leak = np.hstack([leak, told.T @ weighted])
        previous = width - block.shape[1]
        projected = np.block(
            [[projected, column[:previous]], [column[:previous].T, column[previous:]]]
        )
        following, weighted_following = _orthonormal(
            image, weighted, everything[:, : first + width], M
        )
        coefficients = following.T @ weighted
        theta, s = eigh((projected + projected.T) / 2.0)
        theta, s = theta[::-1], s[:, ::-1]
        has_mass = theta > np.finfo(float).eps * len(theta) * theta.max(initial=0.0)
        theta, s = theta[has_mass], s[:, has_mass]
        values = 1.0 / theta
        residuals = np.linalg.norm(coefficients @ s[previous:], axis=0) / theta
        exhausted = following.shape[1] == 0
        if exhausted and len(values) < count:
            raise ComputationError(
                f"{part}: {told.shape[1] + count} modes asked for, but fewer have mass"
            )
        wanted = _last_wanted(values, count) if len(values) > count else 0
        if exhausted and not wanted:
            wanted = len(values)
        if wanted and np.all(residuals[:wanted] <= _RESIDUAL):
            beyond = residuals[wanted : wanted + 1]
            if np.all(beyond <= _RESIDUAL_BEYOND):
                # What is known is known to its own residual, a part of that of what is found.
                along = np.linalg.norm(leak @ s[:, :wanted], axis=0) / theta[:wanted]
                return Ritz(
                    values=values[:wanted],
                    vectors=basis @ s[:, :wanted],
                    residuals=np.hypot(residuals[:wanted], along),
                    beyond=float(values[wanted]) if len(values) > wanted else np.inf,
                    solves=solves,
                )
        if exhausted or width + following.shape[1] > limit:
            converged = int(np.argmin(np.append(residuals[:count] <= _RESIDUAL, [False])))
            raise ComputationError(
                f"{part}: {converged} of {count} modes converged in {solves} solves; "
                "fewer modes or a finer mesh are needed"
            )
        block, weighted_block = following, weighted_following
        width += block.shape[1]
        everything[:, first + width - block.shape[1] : first + width] = block
