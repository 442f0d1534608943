"""What a reduction needs of a body of any kind with the twists of its interfaces given."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Protocol

from fem.bodies.rooted import RootedBody
from fem.solvers.certificate.sturm import Inertia
from lumped.arrays import Array, SparseMatrix


class Swinging(Protocol):
    """A body of n unknowns u that swings with the twists of its interfaces held.

    `flexibility`: displacement (n×k) under forces (n×k); `mass` (n×n).
    """

    @property
    def model(self) -> str:
        """What errors call it."""
        ...

    @property
    def flexibility(self) -> Callable[[Array], Array]:
        """From forces to displacements."""
        ...

    @property
    def mass(self) -> SparseMatrix:
        """n×n."""
        ...

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        ...


class Held(Swinging, Protocol):
    """The same with what the interfaces' own twists do.

    `constraint_modes` Ψ (n×6m): static displacement for unit twists of the m interfaces;
    `stiffness` (6m×6m) the condensed one; `inertia`: of K − σM with all twists held, by σ
    (rad²/s²), None where it is not counted.
    """

    @property
    def constraint_modes(self) -> Array:
        """Ψ (n×6m)."""
        ...

    @property
    def stiffness(self) -> Array:
        """6m×6m."""
        ...

    @property
    def inertia(self) -> Callable[[float], Inertia] | None:
        """From σ to the signs of the eigenvalues of K − σM."""
        ...


@dataclass(frozen=True, eq=False)
class HeldBody:
    """A solid with any number of interfaces as `Held` wants it."""

    rooted: RootedBody

    @property
    def model(self) -> str:
        """What errors call it."""
        return self.rooted.name

    @property
    def constraint_modes(self) -> Array:
        """Ψ (n×6m)."""
        return self.rooted.constraint_modes

    @property
    def stiffness(self) -> Array:
        """6m×6m."""
        return self.rooted.stiffness

    @property
    def flexibility(self) -> Callable[[Array], Array]:
        """With the twists of all interfaces held."""
        return self.rooted.held_flexibility

    @property
    def mass(self) -> SparseMatrix:
        """n×n."""
        return self.rooted.solid.mass

    @property
    def inertia(self) -> Callable[[float], Inertia]:
        """With the twists of all interfaces held."""
        return self.rooted.held_inertia

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        return self.rooted.solid.size
