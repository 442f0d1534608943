"""What a reduction needs of a body of any kind, with its interfaces held or free."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Protocol

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from fem.bodies.rooted import RootedBody
from fem.solvers.certificate.sturm import Inertia
from lumped.arrays import Array, SparseMatrix


class Swinging(Protocol):
    """A body of n unknowns u that swings, held or free of everything.

    `flexibility`: displacement (n×k) under forces (n×k); `mass` (n×n).
    """

    @property
    def state(self) -> str:
        """What errors call it, and how it is held."""
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


class Counted(Swinging, Protocol):
    """The same, and the inertia of K − σM by σ (rad²/s²); None where it is not counted."""

    @property
    def inertia(self) -> Callable[[float], Inertia] | None:
        """From σ to the signs of the eigenvalues of K − σM, those of rigid motions left out."""
        ...


class Held(Counted, Protocol):
    """A body with the twists of its interfaces held, and what these twists do themselves.

    `constraint_modes` Ψ (n×6m): static displacement for unit twists of the m interfaces;
    `stiffness` (6m×6m) the condensed one.
    """

    @property
    def constraint_modes(self) -> Array:
        """Ψ (n×6m)."""
        ...

    @property
    def stiffness(self) -> Array:
        """6m×6m."""
        ...


@dataclass(frozen=True, eq=False)
class HeldBody:
    """A solid with any number of interfaces as `Held` wants it."""

    rooted: RootedBody

    @property
    def state(self) -> str:
        """What errors call it, and how it is held."""
        return f"{self.rooted.name}, all interfaces held"

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


@dataclass(frozen=True, eq=False)
class FreeBody:
    """A solid free of everything, as `Counted` wants it: its modes are the elastic ones.

    `rigid` (n×6): its rigid motions, mass-normalised. Forces are taken together with the inertia
    of the rigid body that they move, displacements without the share of its motions (inertia
    relief), so that the flexibility has all other modes and these alone.
    """

    rooted: RootedBody

    @property
    def state(self) -> str:
        """What errors call it, and how it is held."""
        return f"{self.rooted.name}, free"

    @cached_property
    def rigid(self) -> Array:
        """n×6."""
        motions = self.rooted.solid.motions
        own = cholesky(motions.T @ (self.mass @ motions))
        return np.asarray(solve_triangular(own, motions.T, trans="T").T)

    @cached_property
    def _momenta(self) -> Array:
        return np.asarray(self.mass @ self.rigid)

    def flexibility(self, forces: Array) -> Array:
        """With nothing held: displacement (n×k) beside the rigid motions."""
        moved = self.rooted.flexibility(forces - self._momenta @ (self.rigid.T @ forces))
        return np.asarray(moved - self.rigid @ (self._momenta.T @ moved))

    @property
    def mass(self) -> SparseMatrix:
        """n×n."""
        return self.rooted.solid.mass

    def inertia(self, sigma: float) -> Inertia:
        """Of K − σM without the rigid motions, which lie below every σ."""
        found = self.rooted.free_inertia(sigma)
        return found._replace(negative=found.negative - self.rigid.shape[1])

    @property
    def size(self) -> int:
        """Number of unknowns n."""
        return self.rooted.solid.size
