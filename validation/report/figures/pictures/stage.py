"""What stands around the legs of the biglide, its slides on their rails, and what is named."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide
from lumped.legs import equivalent_leg
from lumped.system.assembly import System
from validation.drawing.prisms import Surface, box, pin
from validation.drawing.rendering import DARK, Body, Wire
from validation.models.options import DEFAULT_OPTIONS
from validation.report.figures.mechanism.shapes import Name, Stage


def stage_of(robot: Biglide, x: float) -> Stage:
    """The stage of a biglide with B at `x` (m): its joint at B goes where the loaded point goes."""

    def around(system: System, unknowns: Array) -> tuple[list[Body], list[Wire]]:
        return _surroundings(robot, x, (system.tool @ unknowns)[:3]), []

    def named(system: System, unknowns: Array) -> Sequence[Name]:
        return names(robot, x, (system.tool @ unknowns)[:3])

    above = _joint_height(robot) / 2.0
    return Stage(around, named, DEFAULT_OPTIONS.elements, (0.0, 0.0, above))


def names(robot: Biglide, x: float, moved: Array) -> Sequence[Name]:
    """The names of the parts; `moved` (3, m) is what B is drawn off."""
    at = robot.posture(x)
    unit = 0.05 * (robot.leg1.length + robot.leg2.length)
    down, aside = np.array([0.0, -1.3 * unit, 0.0]), np.array([1.3 * unit, 0.0, 0.0])
    return (
        (top_of_joint(robot, x) + moved, "B", (-10.0, 13.0)),
        (at.root1 + down - aside, "slide A", (0.0, -12.0)),
        (at.root2 + down + aside, "slide C", (0.0, -12.0)),
        ((at.tip + at.root1) / 2.0, "leg 1", (-26.0, 10.0)),
        ((at.tip + at.root2) / 2.0, "leg 2", (26.0, 10.0)),
    )


def top_of_joint(robot: Biglide, x: float) -> Array:
    """Upper end (3, m) of the drawn joint at B."""
    tip: Array = robot.posture(x).tip + np.array([0.0, 0.0, _joint_height(robot) / 2.0])
    return tip


def _surroundings(robot: Biglide, x: float, moved: Array) -> list[Body]:
    """Rails, slides and joints of the robot as it was, and the joint at B displaced by `moved`."""
    posture = robot.posture(x)
    unit = 0.05 * (robot.leg1.length + robot.leg2.length)
    tall = _joint_height(robot)
    joint = pin(posture.tip + moved, 0.55 * unit, tall)
    bodies = [Body(replace(joint, motion=np.tile(moved, (len(joint.points), 1))), DARK)]
    for root, side in ((posture.root1, -1.0), (posture.root2, 1.0)):
        bodies.append(Body(pin(root, 0.5 * unit, tall), DARK))
        bodies.append(Body(_beside(root, side, (0.6, 2.0), 1.3, 0.5 * tall, unit)))
        bodies.append(Body(_beside(root, side, (2.0, 2.5), 3.5, 0.35 * tall, unit), DARK))
    return bodies


def _joint_height(robot: Biglide) -> float:
    return 1.15 * max(equivalent_leg(leg).section.extent[1] for leg in (robot.leg1, robot.leg2))


def _beside(
    root: Array, side: float, across: tuple[float, float], along: float, high: float, unit: float
) -> Surface:
    """Box beside a foot: `across` from–to along x away from the robot, ±`along`, in `unit` (m)."""
    near, far = sorted(side * unit * distance for distance in across)
    low = root + np.array([near, -along * unit, -high])
    return box(low, root + np.array([far, along * unit, high]))
