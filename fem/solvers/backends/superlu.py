"""Factors by SuperLU of SciPy, for small systems if rslab cannot be loaded.

In the symmetric mode of SuperLU without a threshold, all pivots are on the diagonal unless one is
zero. Then P A Pᵀ = L U with U = D Lᵀ, and the signs of U's diagonal are those of A's eigenvalues
(Sylvester). Pivots are not paired. Each factor is therefore checked by the backward error of a
solution. If a factor fails this check, or has pivots that are not on the diagonal, its number of
entries of D without a known sign (`zero`) is at least 1.
"""

from typing import Any

import numpy as np
import scipy
from scipy.sparse import csc_array

from fem.solvers.backends.factor_checks import is_accurate, require_memory
from fem.solvers.backends.protocol import HOST
from lumped.arrays import Array, SparseMatrix

# Largest number of unknowns. For solids, the minimum degree order causes much more fill-in than
# nested dissection.
LARGEST = 20_000
# Memory (bytes) of L, U and work space per unknown. A leg of second-order tetrahedra with 18 000
# unknowns needs 25 000.
_BYTES_PER_UNKNOWN = 40_000


def title() -> str:
    """Name and version of the library."""
    return f"SciPy {scipy.__version__} (SuperLU, up to {LARGEST} unknowns)"


class SuperluNumeric:
    """Factor by SuperLU, see `Numeric`.

    `handle` is the factor as an object of SciPy. None for a singular or an empty matrix.
    """

    def __init__(self, handle: Any, negative: int, zero: int) -> None:
        self._handle = handle
        self.negative, self.zero = negative, zero

    def solve(self, columns: Array) -> Array:
        """Solutions (n×k) for the right-hand sides `columns` (n×k)."""
        if not columns.shape[1]:
            return np.zeros(columns.shape)
        return np.asarray(self._handle.solve(np.ascontiguousarray(columns)))


class SuperluOrdering:
    """Order of elimination for a lower triangle (csc n×n), see `Ordering`."""

    space = HOST

    def __init__(self, lower: SparseMatrix) -> None:
        self._lower = lower
        self.peak_bytes = _BYTES_PER_UNKNOWN * int(lower.shape[0])

    def factorise(self, values: Array, part: str) -> SuperluNumeric:
        """Factor of the matrix whose lower triangle has the entries `values`.

        `part` is the name of the matrix in messages. Raises ComputationError if memory is
        insufficient.
        """
        from scipy.sparse.linalg import splu  # noqa: PLC0415  rslab computes nearly always

        size = int(self._lower.shape[0])
        if not size:
            return SuperluNumeric(None, 0, 0)
        require_memory(self.peak_bytes, size, part)
        lower = csc_array((values, self._lower.indices, self._lower.indptr), (size, size))
        diagonal = lower.diagonal()
        matrix = csc_array(lower + lower.T)
        matrix.setdiag(diagonal)
        try:
            handle = splu(
                matrix,
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=0.0,
                options={"SymmetricMode": True},
            )
        except RuntimeError:
            return SuperluNumeric(None, 0, size)
        pivots = handle.U.diagonal()
        zero = int((pivots == 0.0).sum())
        on_diagonal = np.array_equal(handle.perm_r, handle.perm_c)
        if not on_diagonal or not is_accurate(lower, handle.solve):
            zero = max(zero, 1)
        return SuperluNumeric(handle, int((pivots < 0.0).sum()), zero)
