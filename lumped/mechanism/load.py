"""Loads of a robot file: wrenches at points, gravity and inertia of all bodies, harmonic forces."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.body import Selection

# Components of the resultant of a pressure below this share of pressure times area are round-off:
# forces in N, moments in N m with a lever of 1 m.
_ROUND_OFF = 1e-9


class DistributedLoad(Protocol):
    """A load along a leg between two positions `start` and `stop` (m along its line)."""

    @property
    def start(self) -> float:
        """Position (m along the line) at which the load begins."""
        ...

    @property
    def stop(self) -> float:
        """Position (m along the line) at which the load ends."""
        ...

    def per_length(self, stations: Array) -> Array:
        """Forces and moments per length (s×6, leg axes) at s `stations` (m) on the line."""
        ...


@dataclass(frozen=True, eq=False)
class LineLoad:
    """A distributed load along a leg between `start` and `stop` (m along its line from the root).

    `first` and `last` (6 values each, in N/m and N m/m, leg axes) are the forces and moments per
    length at `start` and at `stop`, about the line of centroids. Between `start` and `stop` the
    load varies linearly.
    """

    start: float
    stop: float
    first: Array
    last: Array

    def per_length(self, stations: Array) -> Array:
        """Forces and moments per length (s×6) at s `stations` (m) between `start` and `stop`."""
        share = (stations[:, None] - self.start) / (self.stop - self.start)
        return self.first + share * (self.last - self.first)

    def in_axes(self, rotation: Array) -> "LineLoad":
        """Load with forces and moments in other axes: the columns of `rotation` (3×3).

        The columns are unit vectors in the axes of this load.
        """
        first, last = (
            (wrench.reshape(2, 3) @ rotation).ravel() for wrench in (self.first, self.last)
        )
        return LineLoad(self.start, self.stop, first, last)


@dataclass(frozen=True, eq=False)
class AppliedLine:
    """A distributed load of the robot file along the leg with the name `leg`.

    The forces and moments are in base axes if `in_base` is True, otherwise in leg axes.
    """

    leg: str
    load: LineLoad
    in_base: bool


@dataclass(frozen=True)
class Pressure:
    """A uniform `pressure` (Pa) on selected `faces` of the CAD part `body`.

    A positive pressure acts into the body. Points and directions of the selection are in m and in
    the axes of the part's file.
    """

    body: str
    faces: Selection
    pressure: float


@dataclass(frozen=True, eq=False)
class PressureResultant:
    """Resultant of a `pressure` (Pa) on `faces` of the CAD part `body`, whose `area` is in m².

    `force` (3, in N) and `moment` (3, in N m) are in the axes of the part. The moment is about
    their origin.
    """

    body: str
    faces: tuple[int, ...]
    pressure: float
    area: float
    force: Array
    moment: Array

    @property
    def text(self) -> str:
        """Description with pressure, faces, area, force and moment, for reports."""
        numbers = ", ".join(map(str, self.faces))
        label = "faces" if len(self.faces) > 1 else "face"
        smallest = _ROUND_OFF * abs(self.pressure) * self.area
        force, moment = (
            ", ".join(f"{0.0 if abs(x) < smallest else x:.4g}" for x in vector)
            for vector in (self.force, self.moment)
        )
        return (
            f"{self.pressure:.6g} Pa on {label} {numbers} of {self.body} "
            f"({self.area * 1e6:.5g} mm²), force ({force}) N, moment ({moment}) N m"
        )


@dataclass(frozen=True, eq=False)
class InterfaceLoads:
    """Data for the wrenches of inertia forces, pressures and loads along legs on interfaces.

    All data are in body axes and SI units. `masses` contains, by body name, the mass matrix (6m×6m)
    for the twists of the m interfaces of the body. `unit_pressures` contains, by body name and
    selection, the wrenches (6m values) on the interfaces that represent a pressure of 1 Pa on the
    selected faces. `line_wrenches` contains, by name of a leg, a function of a load along it that
    returns its wrenches (2×6) on root and tip. Other legs carry such loads by beam theory.
    """

    masses: Mapping[str, Array] = field(default_factory=dict)
    unit_pressures: Mapping[tuple[str, Selection], Array] = field(default_factory=dict)
    line_wrenches: Mapping[str, Callable[[LineLoad], Array]] = field(default_factory=dict)


@dataclass(frozen=True, eq=False)
class Load:
    """A static load of a robot file, in base axes and SI units.

    `wrench` (6) acts at the interface `point` of `body`. If `path_wrenches` (p×6, one for each pose
    of the path) is not None, it replaces `wrench`. `gravity` (3, in m/s²) acts on the mass of all
    bodies. If the tool's point moves with `speed` (3, in m/s) and `acceleration` (3, in m/s²),
    inertia forces act on the mass of all bodies, too. `lines` act along legs, `pressures` on faces
    of CAD parts.
    """

    name: str
    body: str
    point: str
    wrench: Array = field(default_factory=lambda: np.zeros(6))
    gravity: Array = field(default_factory=lambda: np.zeros(3))
    acceleration: Array = field(default_factory=lambda: np.zeros(3))
    speed: Array = field(default_factory=lambda: np.zeros(3))
    path_wrenches: Array | None = None
    lines: Sequence[AppliedLine] = ()
    pressures: Sequence[Pressure] = ()

    @property
    def acts_on_mass(self) -> bool:
        """True if the load includes gravity or inertia forces on the mass of the bodies."""
        return bool(self.gravity.any()) or self.moves_tool

    @property
    def moves_tool(self) -> bool:
        """True if the load includes the inertia forces of a moving tool."""
        return bool(self.acceleration.any() or self.speed.any())


@dataclass(frozen=True, eq=False)
class AppliedWrench:
    """Wrench (6, SI, base axes) at `position` (3, in m, base axes) on an interface of a body."""

    body: str
    point: str
    position: Array
    wrench: Array


@dataclass(frozen=True, eq=False)
class Loading:
    """Wrenches of a load in one posture.

    `point_wrenches` act at points. `body_wrenches` represent gravity, inertia forces, loads along
    legs and pressures by wrenches on the interfaces of the bodies. `rotor_forces` are forces (N) or
    moments (N m) on the rotors of drives along the coordinates of their joints, by joint name.
    `line_loads` contains, by name of the leg, the distributed loads along legs that
    `body_wrenches` represent (leg axes).
    """

    point_wrenches: Sequence[AppliedWrench]
    body_wrenches: Sequence[AppliedWrench] = ()
    rotor_forces: Mapping[str, float] = field(default_factory=dict)
    line_loads: Mapping[str, Sequence[DistributedLoad]] = field(default_factory=dict)

    @property
    def wrenches(self) -> list[AppliedWrench]:
        """All wrenches of the load on interfaces of bodies."""
        return [*self.point_wrenches, *self.body_wrenches]


@dataclass(frozen=True, eq=False)
class Excitation:
    """A harmonic force, for which the response of a point is computed.

    It acts along `direction` (3, a unit vector, base axes) at `count` frequencies (Hz) from `first`
    to `last`, equally spaced on a logarithmic scale. The peak of the response is judged. If `at` is
    not None, the magnitude at the frequency `at` (Hz) is judged, too.

    The force acts at the point `loaded` (body and interface). The response is the displacement of
    the point `moved` (body and interface) along `moved_direction` (3, a unit vector, base axes). If
    `loaded` or `moved` is None, it is the tool. If `moved_direction` is None, it is the direction
    of the force.
    """

    name: str
    direction: Array
    first: float
    last: float
    count: int
    at: float | None = None
    loaded: tuple[str, str] | None = None
    moved: tuple[str, str] | None = None
    moved_direction: Array | None = None

    @property
    def is_direct(self) -> bool:
        """True for the response of the tool along a force that acts on it."""
        return self.loaded is None and self.moved is None and self.moved_direction is None

    @property
    def is_driving_point(self) -> bool:
        """True for the displacement of the loaded point along the force."""
        return self.loaded == self.moved and self.moved_direction is None

    @property
    def displacement_direction(self) -> Array:
        """Direction (3, a unit vector) of the displacement."""
        return self.direction if self.moved_direction is None else self.moved_direction

    @property
    def frequencies(self) -> Array:
        """Frequencies (Hz) at which the response is computed."""
        return np.geomspace(self.first, self.last, self.count)

    @property
    def judged(self) -> tuple[str, ...]:
        """Names of the judged values: height and frequency of the peak, magnitude at `at`.

        The last is left out if `at` is None. The prefix "response:" is not included.
        """
        single = () if self.at is None else (f"{self.name}.at",)
        return (self.name, f"{self.name}.frequency", *single)
