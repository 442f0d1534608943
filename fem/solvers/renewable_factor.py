"""A factor that gives its memory to another matrix and comes again when it is needed."""

from dataclasses import dataclass, field

from fem.machine import available_memory
from fem.solvers.cholesky import analyse, factorise
from fem.solvers.factor import Factor, SeparatedFactor, Symbolic
from lumped.arrays import Array, IntArray, SparseMatrix

# Two factors at once where the memory that is left holds this many more; the machine is not ours.
_ROOM = 4


@dataclass(eq=False)
class RenewableFactor:
    """The factor of a positive definite matrix (csr n×n), made anew where it was given away.

    `triangle` is the upper triangle of the matrix. `part` names it in errors; these are those of
    `fem.solvers.cholesky.factorise`.
    """

    symbolic: Symbolic
    triangle: SparseMatrix = field(repr=False)
    part: str
    _current: Factor | None = field(default=None, init=False, repr=False)
    # Whether the current factor is that of this matrix, not of one in its place.
    _own: bool = field(default=False, init=False, repr=False)

    @property
    def numeric(self) -> Factor:
        """The backend's own factor."""
        current = self._current
        if current is None or not self._own:
            if isinstance(current, SeparatedFactor):
                current = current.renewed(self.triangle, self.part)
            else:
                current = factorise(self.symbolic, self.triangle, self.part)
            self._current, self._own = current, True
        return current

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        return self.numeric.solve(right_hand_sides)

    def separators(self, count: int) -> list[IntArray]:
        """Unknowns of the `count` largest separators; none where the backend does not tell."""
        current = self._current or self.numeric
        return current.separators(count) if isinstance(current, SeparatedFactor) else []

    def on_its_separators(self, triangle: SparseMatrix, part: str) -> Factor:
        """The factor of another matrix (upper triangle) with the same separators.

        It may have entries beside this one's that couple unknowns of one separator. Where memory is
        short it takes the place of this factor, and is lost when this one is needed again. Raises
        as `fem.solvers.cholesky.factorise` does.
        """
        if isinstance(self._current, SeparatedFactor) and not self._has_room():
            self._own = False
            self._current = self._current.renewed(triangle, part)
            return self._current
        symbolic = analyse(triangle, elimination=self.symbolic.elimination)
        return factorise(symbolic, triangle, part)

    def make_room(self) -> None:
        """Release the factor unless a second one beside it takes a small part of the memory."""
        if not self._has_room():
            self._current = None

    def _has_room(self) -> bool:
        available = available_memory()
        return available is None or available >= _ROOM * self.symbolic.peak_bytes
