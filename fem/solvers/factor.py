"""Sparse factors of symmetric matrices: order, factorise, solve, count.

A library (fem.solvers.backends) factorises PᵀAP = L D Lᵀ. The signs of D are those of A's
eigenvalues (Sylvester): all positive for a stiffness, and counted for K − σM. If a graphics card
fails, the processor computes again what was on it.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csc_array, csr_array

from fem.machine import available_memory
from fem.solvers.backends.choice import announce_fallback, order, order_on_host
from fem.solvers.backends.protocol import HOST, DeviceError, Numeric, Space
from lumped.arrays import Array, SparseMatrix
from lumped.errors import ComputationError

# An unknown with a stiffness below this part of its diagonal entry is supported by round-off alone.
_SINGULAR = 100.0 * np.finfo(np.float64).eps
# Two factors at once if the free memory holds this many more; other programs share the machine.
_ROOM = 4
_SEED = 3


class NotPositiveDefiniteError(ComputationError):
    """A matrix that must be positive definite is not, or only to rounding."""

    def __init__(self, part: str) -> None:
        super().__init__(
            "the matrix is not positive definite (a part free to move as a rigid body, a negative "
            "material constant, stiffnesses that differ by more than rounding allows, or a shift "
            "above the first eigenvalue)",
            part,
        )

    def __reduce__(self) -> tuple[type, tuple[str]]:
        """Made anew in another process."""
        return type(self), (self.part,)


class Inertia(NamedTuple):
    """Numbers of negative, zero (to rounding) and positive eigenvalues."""

    negative: int
    zero: int
    positive: int


class Analysis:
    """Order of elimination of one pattern, on the processor after a graphics card has failed."""

    def __init__(self, lower: SparseMatrix) -> None:
        self._lower = lower
        self.ordering = order(lower)

    def factorise(self, values: Array, part: str) -> Numeric:
        """Factor of the matrix with these values; ComputationError if memory does not suffice."""
        try:
            return self.ordering.factorise(values, part)
        except DeviceError as error:
            self.leave_device(error)
            return self.ordering.factorise(values, part)

    def leave_device(self, error: DeviceError) -> None:
        """Order on the processor from now on, with one warning."""
        if self.ordering.space is not HOST:
            announce_fallback(error)
            self.ordering = order_on_host(self._lower)


class Factor:
    """A factorised symmetric matrix A (n×n) and the signs of its eigenvalues."""

    def __init__(self, symbolic: "Symbolic", part: str) -> None:
        self._symbolic, self._part = symbolic, part
        self._numeric = symbolic.analysis.factorise(symbolic.triangle.data, part)
        negative, zero = self._numeric.negative, self._numeric.zero
        self.inertia = Inertia(negative, zero, symbolic.size - negative - zero)

    def solve(self, right_hand_sides: Any) -> Any:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape and memory.

        Raises DeviceError if the right-hand sides are on a graphics card that fails. They are lost
        with it; the same from the host are then solved on the processor.
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
    """An analysed symmetric matrix."""

    size: int
    triangle: SparseMatrix = field(repr=False)
    analysis: Analysis = field(repr=False)

    @property
    def peak_bytes(self) -> int:
        """Predicted peak of the host's memory during a factorisation."""
        return self.analysis.ordering.peak_bytes

    @property
    def space(self) -> Space:
        """Memory in which right-hand sides need no transfer."""
        return self.analysis.ordering.space

    def factorise(self, part: str = "stiffness matrix") -> Factor:
        """The factor of a positive definite matrix, which errors call `part`.

        Raises NotPositiveDefiniteError, a ComputationError, where an eigenvalue is not positive or
        is lost in rounding, and ComputationError, before it starts, where memory will not suffice.
        """
        factor = self.indefinite(part)
        if factor.inertia.positive < self.size or self._held_by_rounding(factor):
            raise NotPositiveDefiniteError(part)
        return factor

    def indefinite(self, part: str) -> Factor:
        """Factor of any symmetric matrix; ComputationError if memory will not suffice."""
        return Factor(self, part)

    def with_values(self, values: Array) -> "Symbolic":
        """Matrix of the same pattern and order, with `values` of its triangle entry by entry."""
        lower = self.triangle
        triangle = csc_array((values, lower.indices, lower.indptr), shape=lower.shape)
        return replace(self, triangle=triangle)

    def _held_by_rounding(self, factor: Factor) -> bool:
        """True if the stiffness of the most compliant unknown is round-off.

        1/(A⁻¹)ₖₖ is the pivot of unknown k if it is eliminated last: its smallest possible pivot.
        """
        if not self.size:
            return False
        diagonal = self.triangle.diagonal()
        loads = np.random.default_rng(_SEED).standard_normal(self.size) * np.sqrt(diagonal)
        softest = int(np.argmax(np.abs(factor.solve(loads)) * np.sqrt(diagonal)))
        unit = np.zeros(self.size)
        unit[softest] = 1.0
        compliance = float(factor.solve(unit)[softest])
        return not 0.0 < compliance * diagonal[softest] < 1.0 / _SINGULAR


def analyse(matrix: SparseMatrix) -> Symbolic:
    """Order the unknowns of a symmetric matrix (csr n×n) and predict the memory of its factor.

    The upper triangle of the matrix is enough.
    """
    triangle = upper_triangle(matrix)
    # Read by columns it is the lower one.
    lower = csc_array((triangle.data, triangle.indices, triangle.indptr), shape=triangle.shape)
    return Symbolic(matrix.shape[0], lower, Analysis(lower))


@dataclass(eq=False)
class RenewableFactor:
    """Factor that is released if another one needs its memory, and recomputed on the next use.

    `part` names its matrix in errors; these are those of `Symbolic.factorise`.
    """

    symbolic: Symbolic
    part: str

    @cached_property
    def numeric(self) -> Factor:
        """The factor itself."""
        return self.symbolic.factorise(self.part)

    def solve(self, right_hand_sides: Any) -> Any:
        """A⁻¹ times one (n) or several (n×k) right-hand sides: see `Factor.solve`."""
        return self.numeric.solve(right_hand_sides)

    def give_up(self) -> None:
        """Free the memory of the factor."""
        vars(self).pop("numeric", None)

    def make_room(self) -> None:
        """Give the factor up unless a second one beside it takes a small part of the memory."""
        available = available_memory()
        if available is not None and available < _ROOM * self.symbolic.peak_bytes:
            self.give_up()


def upper_triangle(matrix: SparseMatrix) -> SparseMatrix:
    """Upper triangle of a symmetric matrix (csr, sorted columns, explicit zeros kept).

    Read by columns, the same three arrays are the lower triangle.
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
