"""Loads of a robot file: wrenches at points, loads on distributed mass, and harmonic forces."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from lumped.arrays import Array


@dataclass(frozen=True, eq=False)
class Load:
    """A load with its `name`; base axes, SI.

    `wrench` (6) acts at the interface `point` of `body`; `path_wrenches` (p×6), one for each pose
    of the path, replace it. On distributed mass act `gravity` (3), and the inertia of all bodies
    if the tool's point moves with `speed` (3, m/s) and `acceleration` (3, m/s²).
    """

    name: str
    body: str
    point: str
    wrench: Array = field(default_factory=lambda: np.zeros(6))
    gravity: Array = field(default_factory=lambda: np.zeros(3))
    acceleration: Array = field(default_factory=lambda: np.zeros(3))
    speed: Array = field(default_factory=lambda: np.zeros(3))
    path_wrenches: Array | None = None

    @property
    def acts_on_mass(self) -> bool:
        """True if gravity or inertia acts on the mass of the bodies."""
        return bool(self.gravity.any()) or self.moves_tool

    @property
    def moves_tool(self) -> bool:
        """True if the load includes the inertia of a moving tool."""
        return bool(self.acceleration.any() or self.speed.any())


@dataclass(frozen=True, eq=False)
class AppliedWrench:
    """A `wrench` (6, SI) at `position` (3, m), both in base axes, on an interface of a body."""

    body: str
    point: str
    position: Array
    wrench: Array


@dataclass(frozen=True, eq=False)
class Loading:
    """Wrenches of a load in a posture.

    `point_wrenches` act at points, `body_wrenches` are the loads on distributed mass, reduced to
    the interfaces of the bodies. `rotor_forces`: forces (N or N m) on the rotors of drives along
    their joints' coordinates, by the joints' names.
    """

    point_wrenches: Sequence[AppliedWrench]
    body_wrenches: Sequence[AppliedWrench] = ()
    rotor_forces: Mapping[str, float] = field(default_factory=dict)

    @property
    def wrenches(self) -> list[AppliedWrench]:
        """All wrenches on interfaces."""
        return [*self.point_wrenches, *self.body_wrenches]


@dataclass(frozen=True, eq=False)
class Excitation:
    """A harmonic force at the loaded point with its `name`, for which the response is computed.

    It acts along `direction` (3, a unit vector, base axes) with `count` frequencies (Hz) from
    `first` to `last`, in equal steps of their logarithm. Judged are the peak of the response and
    its magnitude at the frequency `at` (Hz); None to judge the peak alone.
    """

    name: str
    direction: Array
    first: float
    last: float
    count: int
    at: float | None = None

    @property
    def frequencies(self) -> Array:
        """Frequencies (Hz) at which the response is computed."""
        return np.geomspace(self.first, self.last, self.count)

    @property
    def judged(self) -> tuple[str, ...]:
        """Names of the judged numbers: height and frequency of the peak, magnitude at `at`."""
        single = () if self.at is None else (f"{self.name}.at",)
        return (self.name, f"{self.name}.frequency", *single)
