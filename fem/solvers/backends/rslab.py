"""Factors by rslab, on the processor.

rslab factorises PᵀAP = L D Lᵀ (Bunch and Kaufman, Math. Comp. 31 (1977) 163) in an order by nested
dissection. The bits of a factor do not depend on the number of threads.
"""

from functools import cache
from importlib.metadata import version
from typing import Any

import numpy as np

from fem.machine import threads
from fem.solvers.backends.factor_checks import require_memory
from fem.solvers.backends.protocol import HOST
from lumped.arrays import Array, SparseMatrix

# Number of right-hand sides solved together, for which memory is predicted.
_COLUMNS_AT_ONCE = 32


@cache
def load_error() -> str:
    """Reason why the library cannot be loaded, in one line. "" if it can be loaded."""
    try:
        import rslab  # noqa: F401, PLC0415
    except Exception as error:  # noqa: BLE001  a damaged wheel fails in many ways
        return " ".join(str(error).split()) or type(error).__name__
    return ""


def title() -> str:
    """Name and version of the library."""
    return f"rslab {version('rslab')} (sparse LDLᵀ)"


class RslabNumeric:
    """Factor by rslab, see `Numeric`."""

    def __init__(self, size: int, handle: Any) -> None:
        _, self.negative, zero = handle.inertia
        # A zero pivot is perturbed, and then counted among the positive or negative ones.
        self.zero = zero + handle.n_perturbed
        self._size, self._handle = size, handle

    def solve(self, columns: Array) -> Array:
        """Solutions (n×k) for the right-hand sides `columns` (n×k)."""
        solution = np.empty_like(columns, dtype=np.float64)
        for start in range(0, columns.shape[1], _COLUMNS_AT_ONCE):
            some = slice(start, start + _COLUMNS_AT_ONCE)
            solution[:, some] = self._handle.solve_many(np.ascontiguousarray(columns[:, some]))
        return solution


class RslabOrdering:
    """Order of elimination for a lower triangle (csc n×n), see `Ordering`."""

    space = HOST

    def __init__(self, lower: SparseMatrix) -> None:
        import rslab  # noqa: PLC0415  many answers need no sparse factor

        self._size = lower.shape[0]
        self._handle = rslab.analyze(lower, "ldlt", threads=threads())
        plan = self._handle.memory_plan(nrhs=_COLUMNS_AT_ONCE, threads=threads())
        self.peak_bytes = int(plan["peak_bytes"])

    def factorise(self, values: Array, part: str) -> RslabNumeric:
        """Factor of the matrix whose lower triangle has the entries `values`.

        `part` is the name of the matrix in messages. Raises ComputationError if memory is
        insufficient.
        """
        require_memory(self.peak_bytes, self._size, part)
        # Only the values are passed: rslab would copy a matrix and compare its pattern.
        handle = self._handle.factor(values, threads=threads(), force_accept=True)
        return RslabNumeric(self._size, handle)
