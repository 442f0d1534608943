"""A factor that is given up where another one needs its memory, and made anew when it is asked."""

from dataclasses import dataclass, field

from fem.machine import available_memory
from fem.solvers.cholesky import analyse, factorise
from fem.solvers.factor import Factor, SeparatedFactor, Symbolic
from lumped.arrays import Array, IntArray, SparseMatrix

# Two factors at once where the memory that is left holds this many more; the machine is not ours.
_ROOM = 4


@dataclass(eq=False)
class RenewableFactor:
    """The factor of a positive definite matrix (csr n×n), made when it is first asked for.

    `triangle` is the upper triangle of the matrix. `part` names it in errors; these are those of
    `fem.solvers.cholesky.factorise`.
    """

    symbolic: Symbolic
    triangle: SparseMatrix = field(repr=False)
    part: str
    _made: Factor | None = field(default=None, init=False, repr=False)

    @property
    def numeric(self) -> Factor:
        """The backend's own factor."""
        if self._made is None:
            self._made = factorise(self.symbolic, self.triangle, self.part)
        return self._made

    def solve(self, right_hand_sides: Array) -> Array:
        """A⁻¹ times one (n) or several (n×k) right-hand sides, in the same shape."""
        return self.numeric.solve(right_hand_sides)

    def separators(self, count: int) -> list[IntArray]:
        """Unknowns of the `count` largest separators; none where the backend does not tell."""
        return self.numeric.separators(count) if isinstance(self.numeric, SeparatedFactor) else []

    def on_its_separators(self, triangle: SparseMatrix, part: str) -> Factor:
        """The factor of another matrix (upper triangle) with the same separators.

        It may have entries beside this one's that couple unknowns of one separator. Raises as
        `fem.solvers.cholesky.factorise` does.
        """
        self.make_room()
        symbolic = analyse(triangle, elimination=self.symbolic.elimination)
        return factorise(symbolic, triangle, part)

    def make_room(self) -> None:
        """Release the factor unless a second one beside it takes a small part of the memory."""
        available = available_memory()
        if available is not None and available < _ROOM * self.symbolic.peak_bytes:
            self._made = None
