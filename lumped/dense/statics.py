"""Displacements of small models under loads, and the round-off errors of these displacements.

A computed solution X of KX = F has the error K⁻¹R with the residual R = F − KX. The error of the
flexibility FᵀX is FᵀK⁻¹R = XᵀR to first order: the part of the work of the loads that is not stored
in the springs. In a well-conditioned model it is a few units in the last place. It is as large as
the flexibility itself if the ratio of two stiffnesses is the resolution of double precision.
"""

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve
from scipy.sparse import csr_array

from lumped.arrays import Array, SparseMatrix, dense, unit_diagonal
from lumped.errors import ComputationError

# Smallest pivot of the stiffness with unit diagonal. A chain of n elements has pivots down to about
# 1/8n³ (3e-8 for 160). Rounding of a singular matrix leaves about 1e-16 to 1e-15.
_SMALLEST_PIVOT = 1e-13
# Largest relative difference between work and stored energy. Results are printed with four digits.
# Observed: 1e-6 for solid legs 200 times as long as high, 1e-7 for hollow sections with walls of a
# fiftieth of the side and ν = 0.4999.
_UNBALANCED = 1e-4
# Ratio of the round-off error of an elimination, which rounds each entry repeatedly, to the error
# from rounding each entry of the matrix once. Largest ratios observed in extreme cases: 3.8 for
# legs, and 3.4 between two eliminations of robots with such legs.
ELIMINATION = 5.0


def solve_statics(stiffness: SparseMatrix, loads: Array, part: str) -> Array:
    """Displacements (n×m) under `loads` (n×m, one load case per column).

    Cholesky factorisation of the stiffness (n×n) scaled to a unit diagonal, for models of up to
    about 2000 unknowns. Raises ComputationError, with `part` in its message, if the stiffness is
    singular or not positive definite.
    """
    k = dense(stiffness)
    try:
        scale = unit_diagonal(k)
        factor = cho_factor(k * scale[:, None] * scale)
    except LinAlgError:
        factor = None
    if factor is None or np.min(np.diag(factor[0])) ** 2 < _SMALLEST_PIVOT:
        raise ComputationError(
            "the stiffness matrix is not positive definite; a part is free to move or a "
            "stiffness is negative",
            part=part,
        )
    displacements: Array = scale[:, None] * cho_solve(factor, scale[:, None] * loads)
    return displacements


def balanced_flexibility(loads: Array, displacements: Array, forces: Array, part: str) -> Array:
    """Symmetric flexibility FᵀX (…×m×m) from loads F, displacements X and elastic forces KX.

    `loads`, `displacements` and `forces` have shape …×n×m. Raises ComputationError, with `part` in
    its message, if the work of the loads and the energy of the springs differ by more than 1e-4, or
    if a number is not finite.
    """
    flexibility = np.swapaxes(loads, -1, -2) @ displacements
    unbalanced_energy = np.swapaxes(displacements, -1, -2) @ (loads - forces)
    sizes = np.sqrt(np.maximum(np.diagonal(flexibility, axis1=-2, axis2=-1), 0.0))
    scale = sizes[..., :, None] * sizes[..., None, :]
    # A unit load under which the model does not move does no work and stores no energy.
    share = np.where(
        scale > 0.0,
        np.abs(unbalanced_energy) / np.where(scale > 0.0, scale, 1.0),
        np.abs(unbalanced_energy),
    )
    worst = float(share.max(initial=0.0))
    if not worst <= _UNBALANCED:
        raise ComputationError(
            f"the work of the loads and the stored energy differ by {100.0 * worst:.2g} "
            "%: stiffnesses in the model differ by more than double precision can "
            "represent",
            part=part,
        )
    return np.asarray(0.5 * (flexibility + np.swapaxes(flexibility, -1, -2)))


def rounding_of_flexibility(
    stiffness: SparseMatrix | Array, displacements: Array, rotated: int = 0
) -> Array:
    """Half-width (m×m, 95 %) of the round-off error of the flexibility FᵀX with X = K⁻¹F.

    `stiffness` is K (n×n), `displacements` is X (n×m). The first `rotated` unknowns are vectors of
    three components in axes that are rotated relative to those of the elements.

    A change δK of the stiffness changes FᵀX by −XᵀδK X to first order. K = Σ TᵀK_e T is assembled
    from element matrices K_e with rotations T. Each term of an entry of K is rounded about a dozen
    times by up to ±ε/2, with the resolution ε of double precision. These errors add up to a
    standard deviation of √12 ε/2√3 = ε times the magnitude of the term. For rotated unknowns this
    magnitude is the norm of the 3×3 block, because the rotation mixes stiff with soft components
    and the angle itself is rounded. Blocks of adjacent elements do not cancel, because each K_e is
    positive semidefinite. Only one triangle of K is used, so that δK is symmetric and its entries
    act in pairs. For two columns x and y of X, the half-width is two standard deviations:

        δ = 2ε √2 √Σ (|x_I| |K_IJ| |y_J|)²   with the sum over blocks I, J.

    It is large if large motions cause little strain: in long thin legs, and in stiff parts next to
    soft ones.
    """
    size = len(displacements)
    block_of_unknown = np.concatenate(
        [np.arange(rotated) // 3, rotated // 3 + np.arange(size - rotated)]
    )
    sums = csr_array((np.ones(size), (block_of_unknown, np.arange(size))))
    squared = sums @ csr_array(stiffness).power(2) @ sums.T
    squared_displacements = sums @ np.square(displacements)
    return np.asarray(
        2.0
        * np.sqrt(2.0)
        * np.finfo(float).eps
        * np.sqrt(squared_displacements.T @ (squared @ squared_displacements))
    )
