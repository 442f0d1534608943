"""Geometry of a modal test (table [hammer]): nodes of a universal file as points of bodies."""

from collections.abc import Iterable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from lumped.acceptance.measured import Freedoms, place_faults
from lumped.arrays import Array
from lumped.mechanism.body import Frame
from lumped.mechanism.mechanism import GROUND, Mechanism
from lumped.mechanism.placing import axes_along
from lumped.models.bodies import legs_of
from lumped.robot_file.rules.rule import NO_DIRECTION
from lumped.robot_file.rules.tables.requests import HammerEntry, NodeEntry
from lumped.text import shown


class Hammer(NamedTuple):
    """A modal test of the robot in the pose `pose`, with the positions and axes of its nodes.

    `uncertainty` and `calibration` are the relative standard uncertainties of the frequencies and
    of the responses, respectively, besides their scatter. Coherence was averaged over `averages`
    blows. The keys of `nodes` are the numbers of the nodes. Each value contains the name of the
    node's body, and a frame: its `position` (m) is in body axes, the columns of its `rotation` are
    the axes of the node in base axes during the test.
    """

    pose: tuple[float, ...]
    uncertainty: float
    calibration: float
    averages: int
    nodes: Mapping[int, tuple[str, Frame]]

    def freedoms(self, ends: Iterable[Iterable[int]]) -> Freedoms:
        """Measured motions: displacements of nodes along one of their axes, in the order of `ends`.

        Each of the `ends` is a pair: the number of a node, and the index (0 to 2) of its axis x, y
        or z.
        """
        motions = [(*self.nodes[number], axis) for number, axis in ends]
        return Freedoms(
            tuple(body for body, _, _ in motions),
            np.array([frame.position for _, frame, _ in motions]),
            np.array([frame.rotation[:, axis] for _, frame, axis in motions]),
        )


def hammer_of(entry: HammerEntry, robot: Mechanism) -> Hammer:
    """Modal test of a robot from the table [hammer] of its file, which has no faults."""
    nodes = {
        int(number): (node.body, Frame(_position(node, robot), axes_along(node.x, node.y)))
        for number, node in entry.nodes.items()
    }
    return Hammer(_pose(entry, robot), entry.uncertainty, entry.calibration, entry.averages, nodes)


def hammer_faults(entry: HammerEntry, robot: Mechanism) -> Iterator[str]:
    """Faults of a table [hammer] whose keys have been checked, one line each."""
    yield from place_faults(robot, _pose(entry, robot), "hammer")
    legs, bodies = legs_of(robot), dict(robot.bodies)
    bodies.pop(GROUND, None)
    for number, node in entry.nodes.items():
        key, name, location = f"hammer.nodes.{number}", node.body, node.at
        if name not in bodies:
            yield f"{key}.body = {shown(name)}: must be one of {', '.join(bodies)}"
        elif isinstance(location, str) and location not in bodies[name].interfaces:
            points = ", ".join(bodies[name].interfaces)
            yield f"{key}.at = {shown(location)}: must be a point of {name} ({points}) or [x, y, z]"
        elif name in legs and not 0 <= round(_position(node, robot)[0] / legs[name].length, 9) <= 1:
            yield f"{key}.at = {shown(location)}: must lie between the ends of {name}"
        if np.linalg.norm(np.cross(node.x, node.y)) < NO_DIRECTION:
            yield f"{key}.y = {list(node.y)}: must not lie along {key}.x"


def _pose(entry: HammerEntry, robot: Mechanism) -> tuple[float, ...]:
    return tuple(robot.reference_pose.tolist()) if entry.pose is None else entry.pose


def _position(node: NodeEntry, robot: Mechanism) -> Array:
    body = robot.bodies[node.body]
    if isinstance(node.at, str):
        return body.interfaces[node.at].position
    return (robot.reference[body.name].inverse() @ Frame(np.array(node.at))).position
