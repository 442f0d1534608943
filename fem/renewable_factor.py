"""A factor that gives its memory back and comes again when it is needed."""

from dataclasses import dataclass, field

from fem.cholesky import Factor, Symbolic, available_memory, factorise
from lumped.arrays import Array, SparseMatrix


@dataclass(eq=False)
class RenewableFactor:
    """The factor of `matrix` (csr n×n, positive definite), made anew where it was released.

    `part` names the matrix in errors; these are those of `fem.cholesky.factorise`.
    """

    symbolic: Symbolic
    matrix: SparseMatrix = field(repr=False)
    part: str
    _current: Factor | None = field(default=None, init=False, repr=False)

    @property
    def numeric(self) -> Factor:
        """The backend's own factor."""
        if self._current is None:
            self._current = factorise(self.symbolic, self.matrix, self.part)
        return self._current

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        return self.numeric.solve(right_hand_sides)

    def make_room(self) -> None:
        """Release the factor where there is no memory for a second one of its size beside it."""
        available = available_memory()
        if available is not None and available < self.symbolic.peak_bytes:
            self._current = None
