"""Number of eigenvalues of K x = λ M x below σ, which certifies that no mode was missed.

By Sylvester's law of inertia, the signs of D in K − σM = L D Lᵀ are those of its eigenvalues. For
an unsupported body and small σ these signs would be round-off. Eigenvalues are therefore counted
with springs, whose effect is then removed: with A = K − σM + WWᵀ, Haynsworth's theorem (Linear
Algebra Appl. 1 (1968) 73) for [A W B; Wᵀ I 0; Bᵀ 0 0] gives the inertia of K − σM on the vectors
with Bᵀx = 0. The bordered matrix has one additional positive eigenvalue for each spring, and one of
either sign for each constraint (Gould, Math. Prog. 32 (1985) 90).
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import csr_array

from fem.solvers.factor import Inertia, RenewableFactor, Symbolic, unordered, upper_triangle
from lumped.arrays import Array, SparseMatrix

# Eigenvalues of the small matrix below this are round-off: its blocks are of order 1, and their
# errors, observed on a leg 87 diameters long, are about 1e-15.
_ZERO = 500.0 * np.finfo(np.float64).eps


@dataclass(frozen=True, eq=False)
class Pencil:
    """The matrix K − σM for any σ, with one sparsity pattern for all σ.

    `springs` (n) are stiffnesses on single unknowns, mostly zero, that support a body while it is
    factorised. `symbolic` is the matrix K with the springs added. Its unknowns are ordered when a
    factor is first needed. `mass` contains the entries of M at the places of the triangle of
    `symbolic`.
    """

    symbolic: Symbolic
    mass: Array
    springs: Array

    def shifted(self, sigma: float) -> Symbolic:
        """Matrix K − σM with the supporting springs, for `sigma` = σ (rad²/s²)."""
        return self.symbolic.with_values(self.symbolic.triangle.data - sigma * self.mass)


def pencil(K: SparseMatrix, M: SparseMatrix, springs: Array | None = None) -> Pencil:
    """Pencil of K (csr n×n, symmetric) with `springs` (n), and M (symmetric, positive definite).

    The upper triangles of K and M are sufficient.
    """
    added = np.zeros(K.shape[0]) if springs is None else springs
    # A sum of two real matrices would drop entries that cancel. The sum of a real and an imaginary
    # matrix has the entries of both.
    combined = csr_array(upper_triangle(K) + 1j * upper_triangle(csr_array(M)))
    for unknown in np.flatnonzero(added):
        combined[unknown, unknown] += added[unknown]
    stiffness = csr_array(
        (combined.data.real.copy(), combined.indices, combined.indptr), shape=combined.shape
    )
    return Pencil(unordered(stiffness), combined.data.imag.copy(), added)


def count_below(
    pencil: Pencil,
    sigma: float,
    constraints: Array | None = None,
    room: RenewableFactor | None = None,
) -> Inertia:
    """Numbers of negative, zero and positive eigenvalues of K − σM.

    The springs of the pencil have no effect on the numbers. `sigma` is σ in rad²/s². `negative` is
    the number of eigenvalues of K x = λ M x below σ. If `zero` is above zero, σ is too near an
    eigenvalue and must be changed. With `constraints` B (n×c, of full rank), only vectors with Bᵀx
    = 0 are admissible. `room` is a factor whose memory may be released for the count. None if there
    is no such factor.
    """
    n, springs = pencil.symbolic.size, pencil.springs
    if room is not None:
        room.make_room()
    factor = pencil.shifted(sigma).indefinite("count of the modes")
    sprung = np.flatnonzero(springs)
    W = np.zeros((n, len(sprung)))
    W[sprung, np.arange(len(sprung))] = np.sqrt(springs[sprung])
    B = np.zeros((n, 0)) if constraints is None else constraints
    border = np.hstack([W, B])
    if factor.inertia.zero or not border.shape[1]:
        return factor.inertia
    across = border.T @ factor.solve(border)
    # Constraints, which may have any unit, are scaled to the size of the springs.
    scale = np.ones(border.shape[1])
    scale[len(sprung) :] = 1.0 / np.sqrt(np.abs(np.diag(across)[len(sprung) :]))
    remaining = -across * scale * scale[:, None]
    remaining[np.diag_indices(len(sprung))] += 1.0
    values = np.linalg.eigvalsh((remaining + remaining.T) / 2.0)
    c, zero = B.shape[1], int((np.abs(values) <= _ZERO).sum())
    negative = factor.inertia.negative + int((values < -_ZERO).sum()) - c
    return Inertia(negative, zero, n - c - negative - zero)
