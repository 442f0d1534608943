"""Displacements of small models under loads, dense."""

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from lumped.arrays import Array, SparseMatrix
from lumped.dense.balance import balanced_flexibility
from lumped.dense.modes import dense, unit_diagonal
from lumped.errors import ComputationError

# Pivots of the stiffness with unit diagonal: a chain of n elements has them down to about 1/8n³
# (3e-8 for 160), rounding of a singular matrix leaves about 1e-16 to 1e-15.
_SMALLEST_PIVOT = 1e-13


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


def flexibility(stiffness: SparseMatrix, loads: Array, part: str) -> Array:
    """Symmetric flexibility loadsᵀ K⁻¹ loads (m×m) for unit `loads` (n×m); raises as above."""
    displacements = solve_statics(stiffness, loads, part)
    return balanced_flexibility(loads, displacements, stiffness @ displacements, part)
