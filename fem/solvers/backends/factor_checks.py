"""Checks of a factorisation: the host's memory before it, the accuracy of its factor after it.

Factors of cuDSS, MUMPS and SuperLU are checked by the backward error of a solution.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from fem.machine import available_memory
from lumped.arrays import Array
from lumped.errors import ComputationError

# Largest backward error ‖b − A x‖/(max|A| ‖x‖ + ‖b‖) of a factor whose signs can be trusted.
# Accurate solutions have 3e-16 to 5e-16. Eigenvalues of K − σM are at least 1e-12 of the largest.
_BACKWARD_ERROR = 1e-13
_SEED = 5


def is_accurate(
    triangle: Any,
    solve: Callable[[Any], Any],
    put: Callable[[Array], Any] = np.asarray,
) -> bool:
    """True if the solution for random forces has a small backward error.

    `triangle` (n×n) is the lower or the upper triangle of the matrix. `put` copies the forces (n×1)
    to the memory (host or graphics card) that contains the triangle and the solutions.
    """
    forces = np.random.default_rng(_SEED).standard_normal((triangle.shape[0], 1))
    right = put(forces)
    solution = solve(right)
    product = triangle @ solution + triangle.T @ solution
    product -= triangle.diagonal()[:, None] * solution
    size = float(abs(triangle.data).max()) * float(abs(solution).max()) + np.abs(forces).max()
    return bool(float(abs(right - product).max()) <= _BACKWARD_ERROR * size)


def require_memory(peak_bytes: int, unknowns: int, part: str) -> None:
    """Raise ComputationError, with `part` in its message, if the available memory is insufficient.

    `peak_bytes` is the predicted memory of a factorisation with `unknowns` unknowns.
    """
    available = available_memory()
    if available is not None and peak_bytes > available:
        raise ComputationError(
            f"factorising {unknowns} unknowns needs about {peak_bytes / 1e9:.1f} GB and "
            f"{available / 1e9:.1f} GB are available: use fewer divisions, a shorter leg, or, "
            "for statics, condensation by doubling or --solver petsc (without a factor)",
            part=part,
        )
