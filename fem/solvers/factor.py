"""Sparse factors of symmetric matrices: ordering, factorisation, solution, count of signs.

A library (`fem.solvers.backends`) factorises PᵀAP = L D Lᵀ. The signs of D are those of A's
eigenvalues (Sylvester): all positive for a stiffness, and counted for K − σM. If a graphics card
fails, its computations are repeated on the processor.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple, Protocol

import numpy as np
from scipy.sparse import csc_array, csr_array

from fem.machine import available_memory
from fem.solvers.backends.choice import announce_fallback, order, order_on_host
from fem.solvers.backends.protocol import HOST, DeviceError, Numeric, Ordering, Space
from lumped.arrays import Array, SparseMatrix
from lumped.errors import ComputationError

# If the stiffness of an unknown is below this fraction of its diagonal entry, it is round-off.
_SINGULAR = 100.0 * np.finfo(np.float64).eps
# Two factors are kept at once only if this many factors fit into the free memory.
_ROOM = 4
_SEED = 3


class NotPositiveDefiniteError(ComputationError):
    """Error: a matrix that must be positive definite is not, or not within round-off."""

    def __init__(self, part: str) -> None:
        super().__init__(
            "the matrix is not positive definite (a part free to move as a rigid body, a negative "
            "material constant, stiffnesses that differ by more than rounding allows, or a shift "
            "above the first eigenvalue)",
            part,
        )

    def __reduce__(self) -> tuple[type, tuple[str]]:
        """Data with which pickle reconstructs the error in another process."""
        return type(self), (self.part,)


class Inertia(NamedTuple):
    """Numbers of negative, zero (within round-off) and positive eigenvalues of a matrix."""

    negative: int
    zero: int
    positive: int


class Analysis:
    """Order of elimination for one sparsity pattern.

    It is computed by the chosen library, and again on the processor if the graphics card fails.
    `lower` is the lower triangle (csc n×n) of a matrix with this pattern.
    """

    def __init__(self, lower: SparseMatrix) -> None:
        self._lower = lower

    @cached_property
    def ordering(self) -> Ordering:
        """The order, computed when it is first needed."""
        return order(self._lower)

    @cached_property
    def peak_bytes(self) -> int:
        """Predicted peak of the host's memory (bytes) during a factorisation."""
        return self.ordering.peak_bytes

    def give_up(self) -> None:
        """Release the memory of the order."""
        vars(self).pop("ordering", None)

    def factorise(self, values: Array, part: str) -> Numeric:
        """Factor of the matrix whose lower triangle has the entries `values`.

        `part` is the name of the matrix in messages. Raises ComputationError if memory is
        insufficient.
        """
        try:
            return self.ordering.factorise(values, part)
        except DeviceError as error:
            self.leave_device(error)
            return self.ordering.factorise(values, part)

    def leave_device(self, error: DeviceError) -> None:
        """Continue on the processor after `error` of the graphics card, with one warning."""
        if self.ordering.space is not HOST:
            announce_fallback(error)
            self.ordering = order_on_host(self._lower)


class Factor:
    """Factor of a symmetric matrix A (n×n), and the signs of A's eigenvalues."""

    def __init__(self, symbolic: "Symbolic", part: str) -> None:
        self._symbolic, self._part = symbolic, part
        self._numeric = symbolic.analysis.factorise(symbolic.triangle.data, part)
        negative, zero = self._numeric.negative, self._numeric.zero
        self.inertia = Inertia(negative, zero, symbolic.size - negative - zero)

    def solve(self, right_hand_sides: Any) -> Any:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape and memory.

        Raises DeviceError if the right-hand sides are on a graphics card that fails, because they
        are lost with it. Right-hand sides on the host are then solved on the processor.
        """
        columns = right_hand_sides.reshape(self._symbolic.size, -1)
        try:
            solution = self._numeric.solve(columns)
        except DeviceError as error:
            analysis = self._symbolic.analysis
            analysis.leave_device(error)
            self._numeric = analysis.factorise(self._symbolic.triangle.data, self._part)
            if type(columns) is not np.ndarray:
                raise
            solution = self._numeric.solve(columns)
        return solution.reshape(right_hand_sides.shape)


@dataclass(frozen=True, eq=False)
class Symbolic:
    """A symmetric matrix (size×size) and the analysis of its sparsity pattern.

    `triangle` is its lower triangle (csc).
    """

    size: int
    triangle: SparseMatrix = field(repr=False)
    analysis: Analysis = field(repr=False)

    @property
    def peak_bytes(self) -> int:
        """Predicted peak of the host's memory (bytes) during a factorisation."""
        return self.analysis.peak_bytes

    @property
    def space(self) -> Space:
        """Memory (host or graphics card) in which right-hand sides are used without a copy."""
        return self.analysis.ordering.space

    def factorise(self, part: str = "stiffness matrix") -> Factor:
        """Factor of a positive definite matrix, named `part` in messages.

        Raises NotPositiveDefiniteError (a ComputationError) if an eigenvalue is not positive or is
        lost in round-off. Raises ComputationError before the factorisation if memory is
        insufficient.
        """
        factor = self.indefinite(part)
        if factor.inertia.positive < self.size:
            raise NotPositiveDefiniteError(part)
        self.require_support(factor.solve, part)
        return factor

    def indefinite(self, part: str) -> Factor:
        """Factor of any symmetric matrix. Raises ComputationError if memory is insufficient."""
        return Factor(self, part)

    def with_values(self, values: Array) -> "Symbolic":
        """Matrix of the same pattern and order with other `values` in its triangle."""
        lower = self.triangle
        triangle = csc_array((values, lower.indices, lower.indptr), shape=lower.shape)
        return replace(self, triangle=triangle)

    def require_support(self, solve: Callable[[Array], Array], part: str) -> None:
        """Raise NotPositiveDefiniteError if the smallest possible pivot is only round-off.

        The pivot of unknown k is smallest if it is eliminated last: 1/(A⁻¹)ₖₖ. The most compliant
        unknown is checked. `solve` is a function that multiplies right-hand sides by A⁻¹.
        """
        if not self.size:
            return
        diagonal = self.triangle.diagonal()
        loads = np.random.default_rng(_SEED).standard_normal(self.size) * np.sqrt(diagonal)
        softest = int(np.argmax(np.abs(solve(loads)) * np.sqrt(diagonal)))
        unit = np.zeros(self.size)
        unit[softest] = 1.0
        compliance = float(solve(unit)[softest])
        if not 0.0 < compliance * diagonal[softest] < 1.0 / _SINGULAR:
            raise NotPositiveDefiniteError(part)


def analyse(matrix: SparseMatrix) -> Symbolic:
    """Order the unknowns of a symmetric matrix (csr n×n) and predict the memory of its factor.

    The upper triangle of the matrix is sufficient. Raises InputError if a requested library cannot
    be used, ComputationError if no library can be used.
    """
    symbolic = unordered(matrix)
    _ = symbolic.analysis.ordering
    return symbolic


def unordered(matrix: SparseMatrix) -> Symbolic:
    """A symmetric matrix (csr n×n) whose unknowns are ordered when a factor is first needed.

    In contrast, `analyse` orders them at once. The upper triangle of the matrix is sufficient.
    """
    triangle = upper_triangle(matrix)
    # The same arrays read by columns are the lower triangle.
    lower = csc_array((triangle.data, triangle.indices, triangle.indptr), shape=triangle.shape)
    return Symbolic(matrix.shape[0], lower, Analysis(lower))


class Inverse(Protocol):
    """Inverse A⁻¹ of a symmetric matrix A, by a factor or by iterations."""

    def solve(self, right_hand_sides: Any) -> Any:
        """A⁻¹ times one (n) or several (n×k) right-hand sides."""


@dataclass(eq=False)
class RenewableFactor:
    """Factor that is released if another one needs its memory, and recomputed when needed.

    `part` is the name of the matrix in messages. Raises errors as `Symbolic.factorise` does.
    """

    symbolic: Symbolic
    part: str

    @cached_property
    def numeric(self) -> Inverse:
        """The factor, which is computed if it has been released."""
        return self.symbolic.factorise(self.part)

    @property
    def space(self) -> Space:
        """Memory (host or graphics card) in which right-hand sides are used without a copy."""
        return self.symbolic.space

    @property
    def countable(self) -> bool:
        """True if the eigenvalues of K − σM can be counted with a factor."""
        return True

    def solve(self, right_hand_sides: Any) -> Any:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, see `Factor.solve`."""
        return self.numeric.solve(right_hand_sides)

    def give_up(self) -> None:
        """Release the memory of the factor. It is computed again when it is needed."""
        vars(self).pop("numeric", None)

    def make_room(self) -> None:
        """Release the factor if the available memory does not suffice for a second one."""
        available = available_memory()
        if available is not None and available < _ROOM * self.symbolic.peak_bytes:
            self.give_up()


def upper_triangle(matrix: SparseMatrix) -> SparseMatrix:
    """Upper triangle of a symmetric matrix (csr, sorted columns, explicit zeros kept).

    The same three arrays read by columns are the lower triangle.
    """
    matrix = csr_array(matrix)
    if not matrix.has_canonical_format:
        matrix = matrix.copy()
        matrix.sum_duplicates()
    n = matrix.shape[0]
    rows = np.repeat(np.arange(n, dtype=matrix.indices.dtype), np.diff(matrix.indptr))
    upper = matrix.indices >= rows
    if upper.all():
        return matrix.astype(np.float64, copy=False)
    pointers = np.concatenate([[0], np.cumsum(np.bincount(rows[upper], minlength=n))])
    triangle = csr_array(
        (
            matrix.data[upper].astype(np.float64, copy=False),
            matrix.indices[upper],
            pointers.astype(matrix.indptr.dtype),
        ),
        shape=(n, n),
    )
    triangle.has_canonical_format = True
    return triangle
