"""Records of a robot, its tool and its postures, from which each model is built."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.body import Body, Frame, Part
from lumped.mechanism.joint import Joint
from lumped.mechanism.length_unit import METRE, UnitOfLength
from lumped.mechanism.load import Excitation, Load

GROUND = "ground"
# Coordinates of the loaded point that a pose may prescribe, in the order of a twist.
MOVES = ("x", "y", "z", "phi_x", "phi_y", "phi_z")
# Difference (m or rad) below which two poses count as equal: the precision of a typed pose.
_SAME_POSE = 1e-6
UNITS_OF_MOVES = dict(zip(MOVES, ("m", "m", "m", "rad", "rad", "rad"), strict=True))
# Moves that are lengths.
LENGTHS = MOVES[:3]


@dataclass(frozen=True)
class Tool:
    """The loaded point: the interface `point` of `body`, with a point mass `mass` (kg).

    `moves` names the coordinates that a pose prescribes, in order. In base axes, x, y and z (m) are
    the coordinates of the point, measured from `datum` (m), and phi_x, phi_y and phi_z (rad) are
    the components of the rotation vector from the reference posture. `constant_moves` are pairs of
    a coordinate and the value (m or rad) that is prescribed for it in all poses.
    """

    body: str
    point: str
    moves: tuple[str, ...] = ()
    mass: float = 0.0
    constant_moves: tuple[tuple[str, float], ...] = ()
    datum: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Bodies, the joints between them, the tool, and the poses in which the robot is evaluated.

    `reference` contains the frame of every body in base axes in the reference posture. The body
    "ground" is the base: its frame is the base frame, its interfaces are the points of its joints.
    `poses` (p × number of moves, m and rad) are in the order of the tool's `moves`. `loads` are the
    static loads of the robot file, `excitations` its harmonic forces. `damping` is a damping ratio
    that every mode has in addition to the loss factors of bodies, joints and drives. If the poses
    form a grid, `grid` contains the values along each move, otherwise it is empty.
    `inverse_kinematics` computes the frames of all bodies for a pose in closed form. If it is None,
    loops are closed by iteration. `lengths` is the unit of length in the robot file and in
    messages.
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
        tool_frame = (
            self.reference[self.tool.body] @ self.bodies[self.tool.body].interfaces[self.tool.point]
        )
        return np.append(tool_frame.position - self.tool.datum, np.zeros(3))[
            [MOVES.index(move) for move in self.tool.moves]
        ]

    def in_metres(self, pose: Array) -> Array:
        """Pose in m and rad from a `pose` whose lengths are in the unit of the robot file."""
        per_metre = self.lengths.per_metre
        divisors = [per_metre if move in LENGTHS else 1.0 for move in self.tool.moves]
        metres: Array = pose / np.array(divisors)
        return metres

    def pose_number(self, pose: Array) -> int | None:
        """Index from 0 of the first pose of the path that equals `pose`. None if there is none."""
        near = np.abs(self.poses - pose).max(axis=1, initial=0.0) <= _SAME_POSE
        return int(np.argmax(near)) if near.any() else None

    @property
    def is_damped(self) -> bool:
        """True if a mode, a body, a joint or a drive dissipates energy."""
        drives = [joint.drive for joint in self.joints if joint.drive]
        losses = [*(joint.loss for joint in self.joints), *(drive.loss for drive in drives)]
        losses += [body.loss for body in self.bodies.values()]
        return self.damping > 0.0 or any(losses) or self.has_dashpots

    @property
    def has_dashpots(self) -> bool:
        """True if a joint or a drive has a viscous dashpot."""
        in_drives = any(joint.drive.damping for joint in self.joints if joint.drive)
        return in_drives or any(joint.damping is not None for joint in self.joints)

    @property
    def judged_responses(self) -> tuple[str, ...]:
        """Names of the judged values of all harmonic responses, in the order of the robot file."""
        return tuple(name for excitation in self.excitations for name in excitation.judged)

    @property
    def parts(self) -> dict[str, Body]:
        """Bodies given by CAD files or meshes, by name."""
        return {name: body for name, body in self.bodies.items() if isinstance(body.shape, Part)}

    @property
    def size(self) -> float:
        """Half the longest side (m) of the box around all interfaces in the reference posture.

        1 m if all interfaces coincide. Angles are multiplied by this length to compare them with
        lengths.
        """
        positions = np.array(
            [
                (self.reference[name] @ interface).position
                for name, body in self.bodies.items()
                for interface in body.interfaces.values()
            ]
        )
        return float(0.5 * np.ptp(positions, axis=0).max()) or 1.0


@dataclass(frozen=True, eq=False)
class Posture:
    """Positions of all bodies of a mechanism in one pose, with closed loops.

    `pose` is in the order of the tool's moves. `frames` contains the frame of each body in base
    axes. `coordinates` contains the coordinates (m, rad) of each joint, one for each free twist.
    They are zero in the reference posture.
    """

    mechanism: Mechanism
    pose: Array
    frames: Mapping[str, Frame]
    coordinates: Mapping[str, Array]
