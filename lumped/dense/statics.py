"""Displacements of small models under loads, and what rounding has left of their digits.

A computed X = K⁻¹F is off by K⁻¹R, R = F − KX, and the flexibility FᵀX by FᵀK⁻¹R = XᵀR to first
order: the energy that the loads do and the springs do not store. Of a well-conditioned model it is
some roundings; where stiffnesses differ by as much as the digits of a number it is the whole.
"""

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve
from scipy.sparse import csr_array

from lumped.arrays import Array, SparseMatrix, dense, unit_diagonal
from lumped.errors import ComputationError

# Pivots of the stiffness with unit diagonal: a chain of n elements has them down to about 1/8n³
# (3e-8 for 160), rounding of a singular matrix leaves about 1e-16 to 1e-15.
_SMALLEST_PIVOT = 1e-13
# Results are printed with four digits. Long thin legs of solids come to 1e-6 (200 times as long as
# high), walls of a fiftieth of the side with ν = 0.4999 to 1e-7.
_UNBALANCED = 1e-4
# What elimination, which rounds each entry again and again, loses over what the rounding of the
# matrix leaves open: up to 3.8 times is seen of legs, 3.4 between two eliminations of robots of
# them, over extreme ones.
ELIMINATION = 5.0


def solve_statics(stiffness: SparseMatrix, loads: Array, part: str) -> Array:
    """Displacements (n×m) under `loads` (n×m): Cholesky on unknowns scaled to a unit diagonal.

    For models of up to about 2000 unknowns. Raises ComputationError, naming `part`, where the
    stiffness is singular or not positive definite.
    """
    k = dense(stiffness)
    try:
        scale = unit_diagonal(k)
        factor = cho_factor(k * scale[:, None] * scale)
    except LinAlgError:
        factor = None
    if factor is None or np.min(np.diag(factor[0])) ** 2 < _SMALLEST_PIVOT:
        raise ComputationError(
            f"{part}: the stiffness matrix is not positive definite; a part is free to move or a "
            "stiffness is negative"
        )
    displacements: Array = scale[:, None] * cho_solve(factor, scale[:, None] * loads)
    return displacements


def balanced_flexibility(loads: Array, displacements: Array, forces: Array, part: str) -> Array:
    """Symmetric flexibility FᵀX (…×m×m) of `loads` F, `displacements` X, `forces` KX (…×n×m each).

    Raises ComputationError, naming `part`, where the energy of the loads and that of the springs
    differ in the fourth digit, where one is negative, and where a number is none.
    """
    flexibility = np.swapaxes(loads, -1, -2) @ displacements
    left = np.swapaxes(displacements, -1, -2) @ (loads - forces)
    sizes = np.sqrt(np.maximum(np.diagonal(flexibility, axis1=-2, axis2=-1), 0.0))
    scale = sizes[..., :, None] * sizes[..., None, :]
    # Unit loads against which the model is rigid do no work and store none.
    share = np.where(scale > 0.0, np.abs(left) / np.where(scale > 0.0, scale, 1.0), np.abs(left))
    worst = float(share.max(initial=0.0))
    if not worst <= _UNBALANCED:
        raise ComputationError(
            f"{part}: the work of the loads and the energy stored differ by {100.0 * worst:.2g} %: "
            "stiffnesses in the model differ by more than double precision resolves"
        )
    return np.asarray(0.5 * (flexibility + np.swapaxes(flexibility, -1, -2)))


def rounding_of_flexibility(
    stiffness: SparseMatrix | Array, displacements: Array, turned: int = 0
) -> Array:
    """What rounding leaves open of FᵀX, X = K⁻¹F (m×m; 95 %, of both signs).

    A change δK changes FᵀX by −XᵀδK X to first order. Terms of an entry of K = Σ TᵀK_e T have gone
    through a dozen roundings of ±ε/2 (K_e, twice T, two products, three sums), together a
    standard deviation of √12 ε/2√3 = ε of what they passed. Of the first `turned` unknowns, vectors
    of three in axes that are not the elements', that is the norm of the entry's block: turning
    passes the stiff components through the soft ones, and the angle itself is rounded. Blocks of
    parts that meet do not cancel, since the parts are positive. δK is symmetric, only a triangle
    being used, so its entries work in pairs: δ = 2ε √2 √Σ (|x_I| |K_IJ| |y_J|)² over blocks.

    Motions that strain little and move far make it large: long thin legs, stiff beside soft.
    """
    size = len(displacements)
    block = np.concatenate([np.arange(turned) // 3, turned // 3 + np.arange(size - turned)])
    sums = csr_array((np.ones(size), (block, np.arange(size))))
    squared = sums @ csr_array(stiffness).power(2) @ sums.T
    moved = sums @ np.square(displacements)
    return np.asarray(
        2.0 * np.sqrt(2.0) * np.finfo(float).eps * np.sqrt(moved.T @ (squared @ moved))
    )
