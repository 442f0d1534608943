"""A robot as data, from which every model follows."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.body import Body, Frame, Part
from lumped.mechanism.joint import Joint
from lumped.mechanism.length_unit import METRE, UnitOfLength
from lumped.mechanism.load import Excitation, Load

GROUND = "ground"
# What a pose may prescribe of the loaded point, in the order of a twist.
MOVES = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
# m or rad: what typed digits of a pose leave open.
_SAME_POSE = 1e-6
UNITS_OF_MOVES = dict(zip(MOVES, ("m", "m", "m", "rad", "rad", "rad"), strict=True))
# Moves that are lengths.
LENGTHS = MOVES[:3]


@dataclass(frozen=True)
class Tool:
    """The loaded point: an interface of a body, what a pose prescribes of it, a mass (kg) there.

    `moves` are components of the point's pose in base axes: x, y, z (m) its coordinates, phi_x,
    phi_y, phi_z (rad) the rotation vector from the reference posture. `keeps` are components that
    have one value in all poses. Coordinates are counted from `datum` (m).
    """

    body: str
    point: str
    moves: tuple[str, ...] = ()
    mass: float = 0.0
    keeps: tuple[tuple[str, float], ...] = ()
    datum: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Bodies, the joints between them, the tool, and the poses in which the robot is looked at.

    `reference` holds the frame of every body in base axes in the reference posture; ground is the
    body of that name, whose frame is the base and whose interfaces are the points it is joined at.
    `poses` (p×len(moves)) are in the order of the tool's `moves`; `loads` are the designer's own.
    `damping` is the damping ratio of every mode, beside the loss factors of bodies, joints and
    drives; `excitations` are the responses that are asked for.
    Where poses are a grid, `grid` has the values along each move.
    `inverse_kinematics` gives the frames of all bodies in a pose in closed form; where it is None,
    loops are closed by iteration.
    `lengths` is the unit in which its file gives lengths and messages show them.
    """

    name: str
    bodies: Mapping[str, Body]
    joints: Sequence[Joint]
    tool: Tool
    reference: Mapping[str, Frame]
    poses: Array
    loads: Sequence[Load] = ()
    damping: float = 0.0
    excitations: Sequence[Excitation] = ()
    grid: Sequence[Array] = ()
    inverse_kinematics: Callable[[Array], Mapping[str, Frame]] | None = None
    lengths: UnitOfLength = METRE

    @property
    def reference_pose(self) -> Array:
        """Pose of the tool in the reference posture, in the order of its moves."""
        place = (
            self.reference[self.tool.body] @ self.bodies[self.tool.body].interfaces[self.tool.point]
        )
        return np.append(place.position - self.tool.datum, np.zeros(3))[
            [MOVES.index(move) for move in self.tool.moves]
        ]

    def in_metres(self, pose: Array) -> Array:
        """A pose that is typed in the file's unit of length, in m and rad."""
        per_metre = self.lengths.per_metre
        divisors = [per_metre if one in LENGTHS else 1.0 for one in self.tool.moves]
        metres: Array = pose / np.array(divisors)
        return metres

    def number_of(self, pose: Array) -> int | None:
        """Number of a pose along the path, from 0 and of equal ones the first; None: not on it."""
        near = np.abs(self.poses - pose).max(axis=1, initial=0.0) <= _SAME_POSE
        return int(np.argmax(near)) if near.any() else None

    @property
    def loses_energy(self) -> bool:
        """Whether anything damps it."""
        drives = (joint.drive.loss for joint in self.joints if joint.drive)
        joints = (joint.loss for joint in self.joints)
        return any((self.damping, *drives, *joints, *(b.loss for b in self.bodies.values())))

    @property
    def judged_responses(self) -> tuple[str, ...]:
        """Names of the judged numbers of all responses, in the robot's order."""
        return tuple(name for one in self.excitations for name in one.judged)

    @property
    def parts(self) -> dict[str, Body]:
        """The bodies that are parts, CAD or meshes, by name."""
        return {name: body for name, body in self.bodies.items() if isinstance(body.shape, Part)}

    @property
    def size(self) -> float:
        """Length (m) that angles are weighed with: half the largest extent of all interfaces."""
        places = np.array(
            [
                (self.reference[name] @ interface).position
                for name, body in self.bodies.items()
                for interface in body.interfaces.values()
            ]
        )
        return float(0.5 * np.ptp(places, axis=0).max()) or 1.0


@dataclass(frozen=True, eq=False)
class Posture:
    """Where everything is in one pose, loops closed.

    `pose` in the order of the tool's moves, `frames` of all bodies in base axes, `coordinates` of
    every joint, one for each of its free twists (m, rad; zero in the reference posture).
    """

    mechanism: Mechanism
    pose: Array
    frames: Mapping[str, Frame]
    coordinates: Mapping[str, Array]
