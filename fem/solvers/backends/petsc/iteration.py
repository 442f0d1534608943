"""Solutions without a factor: conjugate gradients with the multigrid GAMG of PETSc.

GAMG (smoothed aggregation; Vaněk, Mandel, Brezina, Computing 56 (1996) 179) constructs its coarse
levels from the rigid motions. The number of iterations hardly depends on the number of unknowns,
and the memory is a few times that of the matrix. Without a factor, the signs of eigenvalues are not
known, and eigenvalues cannot be counted.
"""

from typing import Any, NamedTuple
from weakref import finalize

import numpy as np
from scipy.sparse import coo_array, csc_array

from fem.solvers.backends.petsc.client import server
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.errors import ComputationError

# Largest accepted error in the norm of the preconditioner, relative to the energy norm. The server
# stops at a tenth. The relative error of the energy is then the square of this, that of other
# products of solutions and loads about this.
_ENERGY = 1e-10
# Residual f − K x, relative to the terms f and K x, below which it is round-off. Factors of the
# same matrices leave 1e-16 to 5e-16. Long slender legs end here.
_BACKWARD = 1e-15
# Number of entries of a row above which its unknown belongs to the border. Rows of nodes have a few
# hundred.
_LONG_ROW = 1500
# Codes of PETSc for an iteration that ends because the preconditioner or the matrix is not positive
# definite.
_INDEFINITE = {-8, -10}


class IndefiniteError(Exception):
    """Error: conjugate gradients met a direction without positive energy."""


class SolutionCheck(NamedTuple):
    """Accuracy of the solution x of K x = f for one right-hand side f.

    `energy` is the residual f − K x in the norm of the preconditioner, relative to the energy norm
    of the solution. `backward` is the residual relative to the sizes of f and K x. `balance` is the
    difference between the work x·f and twice the energy, x·K x, relative to x·K x. `iterations` is
    the number of iterations, `reason` PETSc's code for the reason why they ended.
    """

    iterations: int
    energy: float
    backward: float
    balance: float
    reason: int

    @property
    def sufficient(self) -> bool:
        """True if energy and work have ten correct digits, or all that double precision allows."""
        return max(self.energy, self.balance) <= _ENERGY or self.backward <= _BACKWARD


class GamgIteration:
    """Conjugate gradients for one positive definite matrix, set up once for all right-hand sides.

    `lower` is the lower triangle (csc n×n) of the matrix. `motions` (n×6) are the rigid motions
    that the body would have without supports. `places` (n×3, in m) are the positions of the
    unknowns. The unknowns are sorted along the longest axis of the body, so that each MPI rank has
    neighbouring unknowns. The unknowns of a node stay together. `part` is the name of the matrix in
    messages. Raises MissingPetscError and ComputationError.
    """

    def __init__(self, lower: SparseMatrix, motions: Array, places: Array, part: str) -> None:
        self._server, self._part = server(), part
        self._name = self._server.new_name()
        axis = int(np.ptp(places, axis=0).argmax())
        long = _row_lengths(lower) > _LONG_ROW
        # All six unknowns of a twist, so that the others remain three for each node.
        for place in np.unique(places[long], axis=0):
            long |= (places == place).all(axis=1)
        # The order is stable: unknowns at the same position stay together. The border is last.
        self._order: IntArray = np.lexsort((places[:, axis], long))
        finalize(self, self._server.discard, self._name).atexit = False
        inner = len(long) - int(long.sum())
        triangle, border = _bordered(lower, self._order, inner)
        orthonormal, _ = np.linalg.qr(motions[self._order[:inner]])
        self._server.precondition(self._name, triangle, border, orthonormal, part)
        self.checks: tuple[SolutionCheck, ...] = ()

    def solve(self, columns: Array) -> Array:
        """Solutions (n×k) for the right-hand sides `columns` (n×k).

        Raises IndefiniteError if the matrix is not positive definite, and ComputationError if a
        solution does not converge.
        """
        ordered, answer = self._server.solve(self._name, columns[self._order], self._part)
        self.checks = tuple(SolutionCheck(*check) for check in answer["checks"])
        for check in self.checks:
            if check.reason in _INDEFINITE:
                raise IndefiniteError
            if not check.sufficient:
                raise ComputationError(_why_not(check), self._part)
        return self._unordered(ordered)

    def precondition(self, columns: Array) -> Array:
        """Approximate solutions (n×k) for `columns` (n×k), by one cycle of the multigrid."""
        return self._unordered(self._server.cycle(self._name, columns[self._order], self._part))

    def _unordered(self, ordered: Array) -> Array:
        columns = np.empty_like(ordered)
        columns[self._order] = ordered
        return columns


def _why_not(check: SolutionCheck) -> str:
    return (
        f"conjugate gradients with GAMG end after {check.iterations} iterations with a relative "
        f"error of {max(check.energy, check.balance):.1e} in energy norm, {_ENERGY:g} is allowed; "
        "probably the material is nearly incompressible, or elements are very thin: use a coarser "
        "mesh that a factor (--solver rslab or petsc) can solve"
    )


def _row_lengths(lower: SparseMatrix) -> IntArray:
    """Numbers of entries in the rows (n) of the symmetric matrix with this lower triangle."""
    below = np.bincount(lower.indices, minlength=lower.shape[0])
    return np.asarray(below + np.diff(lower.indptr) - 1)


def _bordered(lower: SparseMatrix, order: IntArray, inner: int) -> tuple[Any, Array]:
    """Parts of the matrix with rows and columns in another order: [[A, B], [Bᵀ, C]].

    `lower` is its lower triangle (csc n×n), `order` (n) contains the old index of each new row, A
    has `inner` rows. The parts are the lower triangle of A (csc) and, of B and C, the array
    (n×(n − inner)).
    """
    size = lower.shape[0]
    position = np.empty(size, dtype=lower.indices.dtype)
    position[order] = np.arange(size, dtype=position.dtype)
    rows, columns = position[lower.indices], np.repeat(position, np.diff(lower.indptr))
    rows, columns = np.maximum(rows, columns), np.minimum(rows, columns)
    border = np.zeros((size, size - inner))
    last = np.flatnonzero(rows >= inner)
    border[columns[last], rows[last] - inner] = lower.data[last]
    corner = last[columns[last] >= inner]
    border[rows[corner], columns[corner] - inner] = lower.data[corner]
    values = lower.data
    if len(last):
        kept = rows < inner
        rows, columns, values = rows[kept], columns[kept], values[kept]
    triangle = csc_array(coo_array((values, (rows, columns)), shape=(inner, inner)))
    triangle.sort_indices()
    return triangle, border
