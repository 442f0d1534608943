"""Where the points of both legs go: displacements of the robot from its unknowns."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide, Places
from lumped.legs import ConstantLeg, equivalent_leg
from lumped.mechanism.body_model import LegMatrices
from lumped.system.assembly import System
from lumped.system.solution import solved
from validation.drawing.prisms import (
    Surface,
    box,
    edges,
    end_faces,
    frames,
    in_robot_axes,
    outline,
    pin,
    prism_faces,
    prism_points,
    section_displacements,
)
from validation.drawing.rendering import DARK, Body, Wire
from validation.drawing.style import MODELS

_STATIONS = 41
_LEGS = ("leg1", "leg2")
# How much larger than the leg the lumped model's outlines are drawn, to be seen on its surface.
OUTSET = 1.04


@dataclass(frozen=True)
class LegShape:
    """One leg as a prism: `points` (m·k × 3, m) and their `displacements`, robot axes.

    k `corners` in each of m `stations`.
    """

    points: Array
    displacements: Array
    corners: int
    stations: int

    @property
    def sizes(self) -> Array:
        """Length of each point's displacement (n)."""
        return np.asarray(np.linalg.norm(self.displacements, axis=1))

    def deformed(self, factor: float, unit: float) -> Surface:
        """The leg with `factor` times its displacements, coloured by their length over `unit`."""
        faces = [prism_faces(self.corners, self.stations), end_faces(self.corners, self.stations)]
        moved = factor * self.displacements
        return Surface(self.points + moved, np.vstack(faces), self.sizes / unit, moved)

    def wire(self) -> Wire:
        """The edges of the leg as it was."""
        return Wire(self.points, edges(self.corners, self.stations), colour="#8a8f98")


def load_displacement(system: System, force: Array) -> Array:
    """Displacements of the robot's unknowns (n, SI) under `force` (3, N, robot axes) at P."""
    wrench = np.concatenate([force, np.zeros(3)])
    return solved(system).displacements(system.tool.T @ wrench[:, None])[:, 0]


def leg_shapes(
    robot: Biglide,
    x: float,
    system: System,
    legs: Sequence[LegMatrices],
    unknowns: Array,
) -> tuple[LegShape, LegShape]:
    """Both legs displaced by `unknowns` (n) of the robot with B at `x` (m)."""
    posture = robot.posture(x)
    first, second = (
        _leg_shape(leg, matrices, system.own(name, unknowns), rotation, root)
        for leg, matrices, name, (rotation, root) in zip(
            _constant_legs(robot), legs, _LEGS, _frames(posture), strict=True
        )
    )
    return first, second


def legs_at_rest(robot: Biglide, x: float) -> tuple[Surface, Surface]:
    """Surfaces of both legs with B at `x` (m), nothing displaced."""
    first, second = (
        _placed(leg, rotation, root)
        for leg, (rotation, root) in zip(
            _constant_legs(robot), _frames(robot.posture(x)), strict=True
        )
    )
    return first, second


def _placed(leg: ConstantLeg, rotation: Array, root: Array) -> Surface:
    corners = outline(leg.section)
    points = prism_points(corners, np.array([0.0, leg.length]))
    faces = [prism_faces(len(corners), 2), end_faces(len(corners), 2)]
    return Surface(root + in_robot_axes(points, rotation), np.vstack(faces))


def centreline_points(
    robot: Biglide,
    x: float,
    system: System,
    legs: Sequence[LegMatrices],
    unknowns: Array,
    count: int,
) -> tuple[Array, Array]:
    """Middles (2·count × 3, m) of `count` equal pieces of each leg, and their displacements."""
    points, displacements = [], []
    for leg, name, (rotation, root) in zip(legs, _LEGS, _frames(robot.posture(x)), strict=True):
        stations = (np.arange(count) + 0.5) * leg.length / count
        twists = (leg.centreline(stations) @ system.own(name, unknowns)).reshape(count, 6)
        straight = np.column_stack([stations, np.zeros((count, 2))])
        points.append(root + in_robot_axes(straight, rotation))
        displacements.append(in_robot_axes(twists[:, :3], rotation))
    return np.vstack(points), np.vstack(displacements)


def segment_frames(
    robot: Biglide,
    x: float,
    system: System,
    legs: Sequence[LegMatrices],
    displaced: Array,
    count: int,
) -> Wire:
    """Outlines of `count` segments of each leg, slightly larger than it.

    `displaced` (n) are the robot's unknowns, times the factor they are drawn with.
    """
    points, motions, pairs, begun = [], [], [], 0
    for leg, matrices, name, (rotation, root) in zip(
        _constant_legs(robot), legs, _LEGS, _frames(robot.posture(x)), strict=True
    ):
        stations = (np.arange(count) + 0.5) * leg.length / count
        corners = OUTSET * outline(leg.section)
        straight = prism_points(corners, stations)
        twists = (matrices.centreline(stations) @ system.own(name, displaced)).reshape(-1, 6)
        moved = section_displacements(straight, np.repeat(twists, len(corners), axis=0))
        points.append(root + in_robot_axes(straight + moved, rotation))
        motions.append(in_robot_axes(moved, rotation))
        pairs.append(frames(len(corners), count) + begun)
        begun += len(straight)
    colour = MODELS["segments"].colour
    return Wire(np.vstack(points), np.vstack(pairs), colour, 2.5, np.vstack(motions))


def surroundings(robot: Biglide, x: float, moved: Array) -> list[Body]:
    """Rails, slides and joints of the robot as it was, and the joint at B displaced by `moved`."""
    posture = robot.posture(x)
    legs = _constant_legs(robot)
    length = (legs[0].length + legs[1].length) / 2.0
    unit = 0.1 * length
    tall = _joint_height(robot)
    joint = pin(posture.tip + moved, 0.55 * unit, tall)
    bodies = [Body(replace(joint, motion=np.tile(moved, (len(joint.points), 1))), DARK)]
    for root, side in ((posture.root1, -1.0), (posture.root2, 1.0)):
        bodies.append(Body(pin(root, 0.5 * unit, tall), DARK))
        bodies.append(Body(_beside(root, side, (0.6, 2.0), 1.3, 0.5 * tall, unit)))
        bodies.append(Body(_beside(root, side, (2.0, 2.5), 3.5, 0.35 * tall, unit), DARK))
    return bodies


def top_of_joint(robot: Biglide, x: float) -> Array:
    """Upper end (3, m) of the drawn joint at B."""
    tip: Array = robot.posture(x).tip + np.array([0.0, 0.0, _joint_height(robot) / 2.0])
    return tip


def slide_places(robot: Biglide, x: float) -> tuple[Array, Array]:
    """Points (3, m) under which the slides of A and C are named."""
    posture = robot.posture(x)
    unit = 0.05 * (robot.leg1.length + robot.leg2.length)
    down = np.array([0.0, -1.3 * unit, 0.0])
    return (
        posture.root1 + down - [1.3 * unit, 0.0, 0.0],
        posture.root2 + down + [1.3 * unit, 0.0, 0.0],
    )


def _joint_height(robot: Biglide) -> float:
    return 1.15 * max(leg.section.extent[1] for leg in _constant_legs(robot))


def _beside(
    root: Array, side: float, across: tuple[float, float], along: float, high: float, unit: float
) -> Surface:
    """Box beside a foot: `across` from–to along x away from the robot, ±`along`, in `unit` (m)."""
    near, far = sorted(side * unit * distance for distance in across)
    low = root + np.array([near, -along * unit, -high])
    return box(low, root + np.array([far, along * unit, high]))


def _constant_legs(robot: Biglide) -> tuple[ConstantLeg, ConstantLeg]:
    return equivalent_leg(robot.leg1), equivalent_leg(robot.leg2)


def _frames(posture: Places) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    return (posture.rotation1, posture.root1), (posture.rotation2, posture.root2)


def _leg_shape(
    leg: ConstantLeg, matrices: LegMatrices, unknowns: Array, rotation: Array, root: Array
) -> LegShape:
    stations = np.linspace(0.0, leg.length, _STATIONS)
    corners = outline(leg.section)
    points = prism_points(corners, stations)
    twists = (matrices.centreline(stations) @ unknowns).reshape(-1, 6)
    displacements = section_displacements(points, np.repeat(twists, len(corners), axis=0))
    return LegShape(
        points=root + in_robot_axes(points, rotation),
        displacements=in_robot_axes(displacements, rotation),
        corners=len(corners),
        stations=len(stations),
    )
