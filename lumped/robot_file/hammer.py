"""Where a modal test was made, table [hammer]: nodes of a universal file as points of bodies."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np

from lumped.acceptance.measured import Freedoms, place_faults
from lumped.arrays import Array
from lumped.mechanism.body import Frame
from lumped.mechanism.mechanism import GROUND, Mechanism
from lumped.mechanism.placing import axes_along
from lumped.models.bodies import legs_of
from lumped.robot_file.rules.relations import NO_DIRECTION
from lumped.text import shown


class Hammer(NamedTuple):
    """A test in a `pose`, and its nodes by number.

    Standard relative uncertainties: `uncertainty` of frequencies, `calibration` of responses, whose
    coherence is that of so many `averages`.
    A node is a body and a frame: its position in the body's axes, its own axes in base axes as they
    were in the test.
    """

    pose: tuple[float, ...]
    uncertainty: float
    calibration: float
    averages: int
    nodes: Mapping[int, tuple[str, Frame]]

    def freedoms(self, ends: Iterable[Iterable[int]]) -> Freedoms:
        """Motions of nodes, by number, along their axes (0 to 2)."""
        along = [(*self.nodes[number], axis) for number, axis in ends]
        return Freedoms(
            tuple(body for body, _, _ in along),
            np.array([frame.position for _, frame, _ in along]),
            np.array([frame.rotation[:, axis] for _, frame, axis in along]),
        )


def hammer_of(read: Mapping[str, Any], robot: Mechanism) -> Hammer:
    """What a table [hammer] without faults describes."""
    nodes = {
        int(number): (one["body"], Frame(_position(one, robot), axes_along(one["x"], one["y"])))
        for number, one in read["nodes"].items()
    }
    known = {name: read[name] for name in ("uncertainty", "calibration", "averages")}
    return Hammer(_pose(read, robot), nodes=nodes, **known)


def hammer_faults(read: Mapping[str, Any], robot: Mechanism) -> Iterator[str]:
    """What is wrong with a table [hammer] whose keys are sound, one line each."""
    yield from place_faults(robot, _pose(read, robot), "hammer")
    legs, bodies = legs_of(robot), dict(robot.bodies)
    bodies.pop(GROUND, None)
    for number, one in read["nodes"].items():
        key, name, at = f"hammer.nodes.{number}", one["body"], one["at"]
        if name not in bodies:
            yield f"{key}.body = {shown(name)}: must be one of {', '.join(bodies)}"
        elif isinstance(at, str) and at not in bodies[name].interfaces:
            held = ", ".join(bodies[name].interfaces)
            yield f"{key}.at = {shown(at)}: must be a point of {name} ({held}) or [x, y, z]"
        elif name in legs and not 0 <= round(_position(one, robot)[0] / legs[name].length, 9) <= 1:
            yield f"{key}.at = {shown(at)}: must lie between the ends of {name}"
        if np.linalg.norm(np.cross(one["x"], one["y"])) < NO_DIRECTION:
            yield f"{key}.y = {list(one['y'])}: must not lie along {key}.x"


def _pose(read: Mapping[str, Any], robot: Mechanism) -> tuple[float, ...]:
    return tuple(robot.reference_pose.tolist()) if read["pose"] is None else read["pose"]


def _position(one: Mapping[str, Any], robot: Mechanism) -> Array:
    body = robot.bodies[one["body"]]
    if isinstance(one["at"], str):
        return body.interfaces[one["at"]].position
    return (robot.reference[body.name].inverse() @ Frame(np.array(one["at"]))).position
