"""Loads of a robot file: wrenches at points, gravity and inertia of all bodies, harmonic forces."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.body import Selection

# Components of the resultant of a pressure below this share of pressure times area are round-off:
# forces in N, moments in N m with a lever of 1 m.
_ROUND_OFF = 1e-9


@dataclass(frozen=True, eq=False)
class LineLoad:
    """A load along a leg between `start` and `stop` (m from its root), leg axes.

    `first` and `last` (6 values each, in N/m and N) are the forces and moments per length at
    `start` and at `stop`, about the line of centroids. Between them the load varies linearly.
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
        """Load in other axes, given by the columns of `rotation` (3×3) in the present axes."""
        first, last = (
            (wrench.reshape(2, 3) @ rotation).ravel() for wrench in (self.first, self.last)
        )
        return LineLoad(self.start, self.stop, first, last)


@dataclass(frozen=True, eq=False)
class AppliedLine:
    """A load of the robot file along the leg `leg`, in leg axes, or in base axes if `in_base`."""

    leg: str
    load: LineLoad
    in_base: bool


@dataclass(frozen=True)
class Pressure:
    """A uniform `pressure` (Pa) on selected `faces` of the CAD part `body`, positive into it.

    Points and directions of the selection are in m and in the axes of the part's file.
    """

    body: str
    faces: Selection
    pressure: float


@dataclass(frozen=True, eq=False)
class PressureResultant:
    """Resultant of a `pressure` (Pa) on `faces` of the CAD part `body`, whose `area` is in m².

    `force` (3, N) and `moment` (3, N m) about the origin of the part's axes, in these axes.
    """

    body: str
    faces: tuple[int, ...]
    pressure: float
    area: float
    force: Array
    moment: Array

    @property
    def text(self) -> str:
        """Text with pressure, faces, area, force and moment."""
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
    """Wrenches on the interfaces of deformable bodies for unit accelerations and pressures.

    Body axes, SI units. `masses`: mass matrices (6m×6m) for the twists of the m interfaces, by body
    name. `unit_pressures`: wrenches (6m values) equivalent to a pressure of 1 Pa on the selected
    faces, by body name and selection.
    """

    masses: Mapping[str, Array] = field(default_factory=dict)
    unit_pressures: Mapping[tuple[str, Selection], Array] = field(default_factory=dict)


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

    `point_wrenches` act at points. `body_wrenches` are gravity, inertia forces, loads along legs
    and pressures, reduced to the interfaces of the bodies. `rotor_forces` are forces (N) or moments
    (N m) on the rotors of drives along the coordinates of their joints, by joint name. `line_loads`
    are those of `body_wrenches` that act along legs, by name of the leg.
    """

    point_wrenches: Sequence[AppliedWrench]
    body_wrenches: Sequence[AppliedWrench] = ()
    rotor_forces: Mapping[str, float] = field(default_factory=dict)
    line_loads: Mapping[str, Sequence[LineLoad]] = field(default_factory=dict)

    @property
    def wrenches(self) -> list[AppliedWrench]:
        """All wrenches of the load on interfaces of bodies."""
        return [*self.point_wrenches, *self.body_wrenches]


@dataclass(frozen=True, eq=False)
class Excitation:
    """A harmonic force, for which the response of a point is computed.

    It acts along `direction` (3, a unit vector, base axes) at `count` frequencies (Hz) from `first`
    to `last`, equally spaced on a logarithmic scale. The peak of the response is judged, and the
    magnitude at the frequency `at` (Hz) unless `at` is None. The force acts at the point `loaded`
    (body and interface), and the response is the displacement of the point `moved` along
    `moved_direction` (3, a unit vector, base axes). A point that is None stands for the tool, and a
    `moved_direction` that is None for the direction of the force.
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
        """Names of the judged numbers: height and frequency of the peak, magnitude at `at` (Hz)."""
        single = () if self.at is None else (f"{self.name}.at",)
        return (self.name, f"{self.name}.frequency", *single)
