"""Sparse factors of symmetric matrices: order, factorise, solve, count (rslab).

rslab factorises PᵀAP = L D Lᵀ (Bunch and Kaufman, Math. Comp. 31 (1977) 163) along a nested
dissection. The signs of D are those of A's eigenvalues (Sylvester): all positive for a stiffness,
and counted for K − σM. The bits of a factor do not depend on the number of threads.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from importlib.metadata import version
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import csc_array, csr_array

from fem.machine import available_memory, threads
from lumped.arrays import Array, SparseMatrix
from lumped.errors import ComputationError

# Right-hand sides solved together, for which memory is foretold.
_COLUMNS_AT_ONCE = 32
# An unknown whose own stiffness is this part of its diagonal entry is held by rounding alone.
_SINGULAR = 100.0 * np.finfo(np.float64).eps
# Two factors at once where the memory that is left holds this many more; the machine is not ours.
_ROOM = 4
_SEED = 3


class NotPositiveDefiniteError(ComputationError):
    """A matrix that must be positive definite is not, or only to rounding."""

    def __init__(self, part: str) -> None:
        self.part = part
        super().__init__(
            f"{part}: the matrix is not positive definite (a part free to move as a rigid body, a "
            "negative material constant, stiffnesses that differ by more than rounding allows, or "
            "a shift above the first eigenvalue)"
        )

    def __reduce__(self) -> tuple[type, tuple[str]]:
        """Made anew in another process."""
        return type(self), (self.part,)


class Inertia(NamedTuple):
    """Numbers of negative, zero (to rounding) and positive eigenvalues."""

    negative: int
    zero: int
    positive: int


@dataclass(frozen=True, eq=False)
class Factor:
    """A factorised symmetric matrix A (n×n) and the signs of its eigenvalues."""

    size: int
    inertia: Inertia
    handle: Any = field(repr=False)

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        columns = right_hand_sides.reshape(self.size, -1)
        solution = np.empty_like(columns, dtype=np.float64)
        for start in range(0, columns.shape[1], _COLUMNS_AT_ONCE):
            some = slice(start, start + _COLUMNS_AT_ONCE)
            solution[:, some] = self.handle.solve_many(np.ascontiguousarray(columns[:, some]))
        return solution.reshape(right_hand_sides.shape)


@dataclass(frozen=True, eq=False)
class Symbolic:
    """An analysed symmetric matrix; its factor takes `peak_bytes` of memory at its height."""

    size: int
    peak_bytes: int
    triangle: SparseMatrix = field(repr=False)
    handle: Any = field(repr=False)

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
        """The factor of any symmetric matrix; ComputationError where memory will not suffice."""
        available = available_memory()
        if available is not None and self.peak_bytes > available:
            raise ComputationError(
                f"{part}: factorising {self.size} unknowns needs about "
                f"{self.peak_bytes / 1e9:.1f} GB and {available / 1e9:.1f} GB are available: use "
                "fewer divisions, a shorter leg, or condensation by doubling (statics)"
            )
        # The values alone: given a matrix, rslab copies it and compares its pattern.
        values = self.triangle.data
        handle = self.handle.factor(values, threads=threads(), force_accept=True)
        # A pivot that is zero is lifted, and then counted among the others.
        _, negative, zero = handle.inertia
        zero += handle.n_perturbed
        return Factor(self.size, Inertia(negative, zero, self.size - negative - zero), handle)

    def with_values(self, values: Array) -> "Symbolic":
        """Another matrix in the same order: `values` of its triangle, entry by entry."""
        lower = self.triangle
        own = csc_array((values, lower.indices, lower.indptr), shape=lower.shape)
        return replace(self, triangle=own)

    def _held_by_rounding(self, factor: Factor) -> bool:
        """Whether the unknown that gives way most has a stiffness that is rounding error.

        1/(A⁻¹)ₖₖ is what elimination leaves of Aₖₖ when unknown k comes last: the smallest that its
        pivot can be.
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


def solver_name() -> str:
    """What a report calls the solver."""
    return f"rslab {version('rslab')} (sparse LDLᵀ)"


def analyse(matrix: SparseMatrix) -> Symbolic:
    """Order the unknowns of a symmetric matrix (csr n×n) and foretell what its factor takes.

    The upper triangle of the matrix is enough.
    """
    import rslab  # noqa: PLC0415  many answers need no sparse factor

    triangle = upper_triangle(matrix)
    # Read by columns it is the lower one.
    lower = csc_array((triangle.data, triangle.indices, triangle.indptr), shape=triangle.shape)
    handle = rslab.analyze(lower, "ldlt", threads=threads())
    plan = handle.memory_plan(nrhs=_COLUMNS_AT_ONCE, threads=threads())
    return Symbolic(matrix.shape[0], int(plan["peak_bytes"]), lower, handle)


@dataclass(eq=False)
class RenewableFactor:
    """A factor that is given up where another one needs its memory, and made anew when asked for.

    `part` names its matrix in errors; these are those of `Symbolic.factorise`.
    """

    symbolic: Symbolic
    part: str

    @cached_property
    def numeric(self) -> Factor:
        """The factor itself."""
        return self.symbolic.factorise(self.part)

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
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
