"""Search for the lowest modes of K φ = ω² M φ by a preconditioner, without solutions by K.

Generalised Davidson iteration with thick restart (Morgan and Scott, SIAM J. Sci. Stat. Comput. 7
(1986) 817; Stathopoulos, Saad and Wu, SIAM J. Sci. Comput. 19 (1998) 227): the basis grows by the
preconditioned residuals T r, r = K x − λ M x, of the lowest Ritz vectors x, where T approximates
K⁻¹. Each costs one application of T, such as one cycle of multigrid.

With xᵀM x = 1 and ρ² = rᵀK⁻¹ r / λ, there is an eigenvalue μ with |λ − μ| ≤ ρ √(λ μ). The relative
error of an isolated one is about ρ² divided by its relative gap (Parlett, The Symmetric Eigenvalue
Problem, §§10–11). ρ is computed with T in place of K⁻¹.
"""

from collections.abc import Callable

import numpy as np
from scipy.linalg import eigh

from fem.solvers.backends.protocol import HOST
from fem.solvers.block_lanczos import orthonormal_block
from lumped.arrays import Array, SparseMatrix

# Largest ρ of a mode. With an accurate T, the relative error of a frequency at a relative gap of
# 1e-2 is then 5e-9. For a leg 150 times as long as wide, GAMG leaves 1e-6.
_RESIDUAL = 1e-5
# Largest ρ of the mode after the last requested one, which only has to show that it is higher.
_RESIDUAL_BEYOND = 1e-2
# Number of Ritz vectors that are improved at once. Largest number of vectors in the basis after a
# restart, in excess of the modes that are still searched: the search then takes 4 % more cycles
# than without restarts.
_BLOCK, _EXCESS = 8, 40


class StagnationError(Exception):
    """Error: too few modes converged with the allowed number of applications of T."""


def davidson(
    K: SparseMatrix,
    M: SparseMatrix,
    precondition: Callable[[Array], Array],
    start: Array,
    count: int,
    limit: int,
) -> tuple[Array, Array]:
    """Lowest `count` eigenvalues ω² (m, rad²/s², ascending) and M-orthonormal modes (n×m).

    K is positive definite on a subspace that contains `start` (n×s) and all results of
    `precondition`, which is T on blocks (n×k). T and M are positive definite. m equals `count`, or
    n if n is smaller. Raises StagnationError after `limit` applications of T.
    """
    found, squared = np.zeros((len(start), 0)), np.zeros(0)
    basis, _ = orthonormal_block(start, found, M, HOST)
    projected = basis.T @ (K @ basis)
    applications = 0
    while basis.shape[1]:
        values, directions = eigh((projected + projected.T) / 2.0)
        basis = basis @ directions
        block, ritz_values = basis[:, :_BLOCK], values[:_BLOCK]
        residuals = K @ block - (M @ block) * ritz_values
        corrections = precondition(residuals)
        applications += block.shape[1]
        squares = np.einsum("ij,ij->j", residuals, corrections) / ritz_values
        # A negative square shows that T is not positive definite. It must not pass for a small one.
        errors = np.sqrt(np.abs(squares))
        if len(squared) >= count:
            last = np.sort(squared)[count - 1]
            if errors[0] <= _RESIDUAL_BEYOND and values[0] * (1.0 - errors[0]) > last:
                break
        if applications > limit:
            raise StagnationError(f"{len(squared)} of {count} modes converged")
        converged = errors <= _RESIDUAL
        found = np.hstack([found, block[:, converged]])
        squared = np.append(squared, ritz_values[converged])
        width = max(count - len(squared), 0) + _EXCESS
        kept = np.append(~converged, np.ones(len(values) - len(converged), dtype=bool))
        values, basis = values[kept][:width], basis[:, kept][:, :width]
        known = np.hstack([found, basis])
        added, _ = orthonormal_block(corrections[:, ~converged], known, M, HOST)
        forces = K @ added
        coupling = basis.T @ forces
        basis = np.hstack([basis, added])
        projected = np.block([[np.diag(values), coupling], [coupling.T, added.T @ forces]])
    order = np.argsort(squared, kind="stable")[:count]
    return squared[order], found[:, order]
