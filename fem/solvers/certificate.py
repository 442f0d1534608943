"""How many eigenvalues of K x = λ M x lie below σ: the certificate that no mode was missed.

By Sylvester's law of inertia the signs of D in K − σM = L D Lᵀ are those of its eigenvalues. Of a
body that nothing holds these signs would be rounding where σ is small, so that it is counted with
springs and then without them: with A = K − σM + WWᵀ Haynsworth's theorem (Linear Algebra Appl. 1
(1968) 73) on [A W B; Wᵀ I 0; Bᵀ 0 0] gives the inertia of K − σM on the vectors with Bᵀx = 0, to
which the bordered matrix adds a positive eigenvalue for each spring and one of either sign for each
condition (Gould, Math. Prog. 32 (1985) 90).
"""

import numpy as np
from scipy.sparse import csr_array, diags_array

from fem.solvers.factor import Inertia, RenewableFactor, analyse, upper_triangle
from lumped.arrays import Array, SparseMatrix

# An eigenvalue of the small matrix below this is rounding: its blocks are of the size of one, and
# their errors, measured on a leg 87 diameters long, are some 1e-15.
_ZERO = 500.0 * np.finfo(np.float64).eps


def count_below(
    K: SparseMatrix,
    M: SparseMatrix,
    sigma: float,
    constraints: Array | None = None,
    springs: Array | None = None,
    room: RenewableFactor | None = None,
) -> Inertia:
    """Inertia of K − σM (csr n×n, K and M symmetric, M positive definite, σ in rad²/s²).

    Their upper triangles are enough. `negative` eigenvalues of K x = λ M x lie below σ. `zero`
    above zero means that σ is too near an eigenvalue; move it. With `constraints` B (n×c, of full
    rank) only vectors with Bᵀx = 0 count. `springs` (n) are stiffnesses on single unknowns, zero on
    most, that hold a body while it is counted. `room` is a factor that makes room for this one.
    """
    n = K.shape[0]
    held = np.zeros(n) if springs is None else springs
    shifted = upper_triangle(K) - sigma * upper_triangle(csr_array(M))
    symbolic = analyse(csr_array(shifted + diags_array(held, format="csr")))
    if room is not None:
        room.make_room()
    factor = symbolic.indefinite("count of the modes")
    own = np.flatnonzero(held)
    W = np.zeros((n, len(own)))
    W[own, np.arange(len(own))] = np.sqrt(held[own])
    B = np.zeros((n, 0)) if constraints is None else constraints
    border = np.hstack([W, B])
    if factor.inertia.zero or not border.shape[1]:
        return factor.inertia
    across = border.T @ factor.solve(border)
    # Conditions of any units, as they come, get the size of the springs.
    scale = np.ones(border.shape[1])
    scale[len(own) :] = 1.0 / np.sqrt(np.abs(np.diag(across)[len(own) :]))
    remaining = -across * scale * scale[:, None]
    remaining[np.diag_indices(len(own))] += 1.0
    values = np.linalg.eigvalsh((remaining + remaining.T) / 2.0)
    c, zero = B.shape[1], int((np.abs(values) <= _ZERO).sum())
    negative = factor.inertia.negative + int((values < -_ZERO).sum()) - c
    return Inertia(negative, zero, n - c - negative - zero)
