"""One leg alone, its root clamped: what any leg model says about tip compliance and modes."""

import numpy as np
from scipy.linalg import LinAlgError, cho_factor, cho_solve

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.leg_matrices import LegMatrices
from lumped.modes import Modes, dense, solve_modes

_ROOT = 6
_TIP = slice(0, 6)  # of the unknowns that are left once the root is clamped


def tip_compliance_of(leg: LegMatrices) -> Array:
    """6×6 tip compliance (SI, leg axes) of the leg with its root clamped.

    Dense Cholesky on unknowns scaled to a unit diagonal. Raises ComputationError where the
    clamped leg is not held by its stiffness.
    """
    stiffness = dense(leg.stiffness)[_ROOT:, _ROOT:]
    diagonal = np.diag(stiffness)
    if diagonal.min() <= 0.0:
        raise ComputationError(f"{leg.model}: an unknown of the leg has no stiffness")
    scale = 1.0 / np.sqrt(diagonal)
    try:
        factor = cho_factor(stiffness * scale[:, None] * scale)
    except LinAlgError as error:
        raise ComputationError(
            f"{leg.model}: the stiffness of the clamped leg is not positive definite; "
            "a part of the leg is free to move or a stiffness is negative"
        ) from error
    unit_loads = np.zeros((len(scale), 6))
    unit_loads[_TIP] = np.diag(scale[_TIP])
    compliance: Array = scale[_TIP, None] * cho_solve(factor, unit_loads)[_TIP]
    return 0.5 * (compliance + compliance.T)


def clamped_modes(leg: LegMatrices, count: int) -> Modes:
    """The lowest `count` modes of the leg with its root clamped.

    Shapes are on all unknowns of the leg (n×count, zero at the root), so that
    `leg.centreline(stations) @ shapes` draws them. Raises ComputationError as `solve_modes` does.
    """
    free = solve_modes(
        dense(leg.stiffness)[_ROOT:, _ROOT:], dense(leg.mass)[_ROOT:, _ROOT:], count, leg.model
    )
    shapes = np.vstack([np.zeros((_ROOT, count)), free.shapes])
    return Modes(frequencies=free.frequencies, shapes=shapes)
