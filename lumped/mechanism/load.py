"""Loads of a robot's own: a wrench at a point, what acts on mass, and forces that swing."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from lumped.arrays import Array


@dataclass(frozen=True, eq=False)
class Load:
    """A load by its `name`; base axes, SI.

    `wrench` (6) acts at the interface `point` of `body`, in its place `over_path` (p×6), one for
    each pose of the path. `gravity` (3), and the inertia of all bodies where the tool moves with
    `speed` (3, m/s) and `acceleration` (3, m/s²) of its point, act on distributed mass.
    """

    name: str
    body: str
    point: str
    wrench: Array = field(default_factory=lambda: np.zeros(6))
    gravity: Array = field(default_factory=lambda: np.zeros(3))
    acceleration: Array = field(default_factory=lambda: np.zeros(3))
    speed: Array = field(default_factory=lambda: np.zeros(3))
    over_path: Array | None = None

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


@dataclass(frozen=True, eq=False)
class Loading:
    """What a load does in a posture: `at_points`, and `along` bodies with mass.

    The latter comes to their interfaces. `on_rotors`: forces (N or N m) on the rotors of drives
    along their joints' coordinates, by the joints' names.
    """

    at_points: Sequence[Applied]
    along: Sequence[Applied] = ()
    on_rotors: Mapping[str, float] = field(default_factory=dict)

    @property
    def everywhere(self) -> list[Applied]:
        """All wrenches on interfaces."""
        return [*self.at_points, *self.along]


@dataclass(frozen=True, eq=False)
class Excitation:
    """A force at the loaded point that swings, by its `name`: the response to it is asked for.

    It acts along `direction` (3, a unit vector, base axes) with `count` frequencies (Hz) from
    `first` to `last`, in equal steps of their logarithm. Beside the peak of the response its size
    at the frequency `at` (Hz) is judged, where one is given.
    """

    name: str
    direction: Array
    first: float
    last: float
    count: int
    at: float | None = None

    @property
    def frequencies(self) -> Array:
        """Frequencies (Hz) at which the response is told."""
        return np.geomspace(self.first, self.last, self.count)

    @property
    def judged(self) -> tuple[str, ...]:
        """Names of the numbers that are judged: height and frequency of the peak, size at `at`."""
        more = () if self.at is None else (f"{self.name}.at",)
        return (self.name, f"{self.name}.frequency", *more)
