"""Loads of a robot's own: a wrench at a point, and what acts on the mass of all bodies."""

from dataclasses import dataclass, field

import numpy as np

from lumped.arrays import Array


@dataclass(frozen=True, eq=False)
class Load:
    """A load by its `name`; base axes, SI.

    `wrench` (6) acts at the interface `point` of `body`. `gravity` (3), and the inertia of all
    bodies where the tool moves with `speed` (3, m/s) and `acceleration` (3, m/s²) of its point,
    act on distributed mass.
    """

    name: str
    body: str
    point: str
    wrench: Array = field(default_factory=lambda: np.zeros(6))
    gravity: Array = field(default_factory=lambda: np.zeros(3))
    acceleration: Array = field(default_factory=lambda: np.zeros(3))
    speed: Array = field(default_factory=lambda: np.zeros(3))

    @property
    def acts_on_mass(self) -> bool:
        """Whether any of it acts on the mass of the bodies."""
        return bool(self.gravity.any()) or self.moves

    @property
    def moves(self) -> bool:
        """Whether the tool moves under it."""
        return bool(self.acceleration.any() or self.speed.any())


@dataclass(frozen=True, eq=False)
class Applied:
    """A `wrench` (6, SI) at `position` (3, m), both in base axes, on what carries an interface."""

    body: str
    point: str
    position: Array
    wrench: Array
