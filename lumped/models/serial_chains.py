"""The virtual joint method on mechanisms whose legs are serial chains (eqs 3 to 9 of the paper).

A chain from the ground to the platform consists of the free twists of its joints, one after the
other, and of springs with six degrees of freedom: one at the tip of each leg, and those of joints
and drives. Springs between the platform and the tool are in series with all chains. Chains are
evaluated by `lumped.models.vjm`, which has no code in common with the assembly of the other models.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError, InputError
from lumped.mechanism.free_twists import (
    drive_in,
    free_twists,
    interface_position,
    rotation_since_reference,
)
from lumped.mechanism.joint import FREEDOMS, Joint, Side
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.load import Loading
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.models import vjm
from lumped.screws import shift, turn_matrix

# A body and an interface. The interface is "" for a rigid body, which is a single node.
_Node: TypeAlias = tuple[str, str]
_BASE: _Node = (GROUND, "")


@dataclass(frozen=True)
class _Step:
    """One step of a chain, between two neighbouring `nodes`.

    `across` is the joint between them, or the name of the leg. A node is an interface of an elastic
    leg, or a rigid body with all its interfaces.
    """

    nodes: frozenset[_Node]
    across: Joint | str


class NoChainError(InputError):
    """Error: a leg of the robot is not a serial chain. `reason` explains why."""

    def __init__(self, robot: str, reason: str) -> None:
        super().__init__(f"{robot}: {reason}; take --model links")
        self.reason = reason


def compliance(posture: Posture, legs: Mapping[str, Array]) -> Array:
    """6×6 compliance (SI, base axes) of the loaded point by the virtual joint method.

    `legs` contains the 6×6 compliance (SI, body axes) of each elastic leg at its tip with its root
    clamped. Other bodies are rigid. Raises NoChainError if a leg of the robot is not a serial
    chain, ComputationError if a chain is rigid or the tool is free to move.
    """
    pose = shown_pose(posture.mechanism, posture.pose)
    name = f"{posture.mechanism.name}, virtual joints" + (f", {pose}" if pose else "")
    parallel, series = serial_chains(posture, legs)
    platform = vjm.platform_compliance(vjm.robot_stiffness(parallel), f"{name}: the tool")
    return platform + series.compliance


def serial_chains(
    posture: Posture, legs: Mapping[str, Array]
) -> tuple[tuple[vjm.Chain, ...], vjm.Chain]:
    """Chains from the ground to the platform, and the chain from the platform to the tool.

    All chains are referred to the loaded point. Those from the ground are in the order of the
    joints and legs at the platform.
    """
    paths, series = _paths(posture.mechanism, legs)
    return (
        tuple(_chain(posture, legs, path) for path in paths),
        _chain(posture, legs, series),
    )


def tool_displacements(
    posture: Posture, legs: Mapping[str, Array], loads: Sequence[Loading]
) -> Array:
    """Displacements (l×6, in m and rad, base axes) of the loaded point under each of l loads.

    `legs` contains the 6×6 compliance (SI, body axes) of each elastic leg at its tip with its root
    clamped. A load on a body that is not part of a chain acts on the node of a chain to which the
    body is attached. Raises the errors of `compliance`.
    """
    mechanism, tool = posture.mechanism, posture.mechanism.tool
    paths, series = _paths(mechanism, legs)
    chains = [_chain(posture, legs, path) for path in paths]
    stiffness = vjm.robot_stiffness(chains)
    platform = vjm.platform_compliance(stiffness, f"{mechanism.name}, virtual joints: the tool")
    end = interface_position(posture, Side(tool.body, tool.point))
    carrier = _carriers(mechanism, legs, [*series, *(step for path in paths for step in path)])

    def displacement(load: Loading) -> Array:
        wrenches: dict[_Node, Array] = defaultdict(lambda: np.zeros(6))
        for applied in load.wrenches:
            node = carrier[_node(applied.body, applied.point, legs)]
            wrenches[node] = wrenches[node] + shift(applied.position - end).T @ applied.wrench
        platform_wrench, series_displacement = np.zeros(6), np.zeros(6)
        for path, chain in zip(paths, chains, strict=True):
            slip, work, node = np.zeros(6), np.zeros(chain.passive.shape[1]), carrier[_BASE]
            for count, step in enumerate(path[:-1], start=1):
                slip += _drive_deflection(posture, step, load, end)
                node = _other(step, node)
                partial = _chain(posture, legs, path[:count])
                slip += partial.compliance @ wrenches[node]
                work[: partial.passive.shape[1]] += partial.passive.T @ wrenches[node]
            slip += _drive_deflection(posture, path[-1], load, end)
            platform_wrench += vjm.clamped_end_wrench(chain, slip, work)
            node = _other(path[-1], node)
        platform_wrench += wrenches[node]
        for count, step in enumerate(series, start=1):
            node = _other(step, node)
            series_displacement += _drive_deflection(posture, step, load, end)
            series_compliance = _chain(posture, legs, series[:count]).compliance
            series_displacement += series_compliance @ wrenches[node]
            platform_wrench += wrenches[node]
        return np.asarray(platform @ platform_wrench + series_displacement)

    return np.reshape([displacement(load) for load in loads], (-1, 6))


def _drive_deflection(posture: Posture, step: _Step, load: Loading, end: Array) -> Array:
    """Twist (6, base axes) at the point `end` (3, in m) due to the deflection of a drive.

    The force of the `load` on the rotor deflects the drive of the joint in `step`. Zero if `step`
    has no elastic drive.
    """
    joint = step.across
    drive = None if isinstance(joint, str) else drive_in(posture, joint)
    if isinstance(joint, str) or drive is None or drive.stiffness is None:
        return np.zeros(6)
    arm = shift(end - interface_position(posture, joint.first))
    deflection = load.rotor_forces.get(joint.name, 0.0) / drive.stiffness
    return np.asarray(deflection * (arm @ free_twists(posture, joint)[:, 0]))


def _carriers(
    mechanism: Mechanism, legs: Mapping[str, Array], chain_steps: Sequence[_Step]
) -> dict[_Node, _Node]:
    """For each node of the robot, the node of a chain on which loads on that node act.

    Loads on a node of a chain act on the node itself. Other nodes are attached to a chain.
    `chain_steps` are the joints and legs of all chains.
    """
    group = _groups(mechanism, legs)
    carrier = {node: node for step in chain_steps for node in step.nodes}
    remaining = [step for step in _steps(mechanism, legs, group) if step not in chain_steps]
    while remaining:
        step = next(other for other in remaining if carrier.keys() & other.nodes)
        remaining.remove(step)
        for node in step.nodes - carrier.keys():
            carrier[node] = carrier[_other(step, node)]
    return {node: carrier[representative] for node, representative in group.items()}


def _paths(
    mechanism: Mechanism, legs: Mapping[str, Array]
) -> tuple[list[list[_Step]], list[_Step]]:
    """Joints and legs of each chain from ground to platform, and of that from platform to tool.

    Both are in order of the path.

    Raises NoChainError if a chain branches, ComputationError if the tool is part of the ground.
    """
    groups = _groups(mechanism, legs)
    base = groups[_BASE]
    end = groups[_node(mechanism.tool.body, mechanism.tool.point, legs)]
    if end == base:
        raise ComputationError(
            f"{mechanism.name}, virtual joints: only rigid bodies and fixed joints connect the "
            "tool to the ground, so that the stiffness of the tool is infinite"
        )
    steps = _without_dead_ends(_steps(mechanism, legs, groups), {base, end})
    series = _series(steps, end, base)
    for step in series:
        end = _other(step, end)
    steps = [step for step in steps if step not in series]
    paths = []
    for start in [step for step in steps if end in step.nodes]:
        path, node = [start], _other(start, end)
        while node != base:
            next_steps = [step for step in steps if node in step.nodes and step is not path[-1]]
            if node == end or len(next_steps) != 1:
                raise NoChainError(
                    mechanism.name,
                    "the vjm model sums serial chains from the ground to the tool, but the robot "
                    f"branches at {_description(node)}",
                )
            path.append(next_steps[0])
            node = _other(next_steps[0], node)
        paths.append(path[::-1])
    return paths, series[::-1]


def _series(steps: list[_Step], end: _Node, base: _Node) -> list[_Step]:
    """Joints and legs from the tool back to the platform, at which the chains of the robot meet.

    `end` is the node of the tool, `base` that of the ground. Empty if the tool is on the platform,
    or if a single chain connects tool and ground.
    """
    series: list[_Step] = []
    while end != base:
        next_steps = [step for step in steps if end in step.nodes and step not in series]
        if len(next_steps) != 1 or _is_passive(next_steps[0].across):
            return series
        series += next_steps
        end = _other(next_steps[0], end)
    return []


def _is_passive(across: Joint | str) -> bool:
    """True if `across` is a joint with a passive free twist, which no drive determines.

    False for a leg, given by its name.
    """
    driven = isinstance(across, Joint) and across.drive is not None
    return isinstance(across, Joint) and FREEDOMS[across.kind] > driven


def _groups(mechanism: Mechanism, legs: Mapping[str, Array]) -> dict[_Node, _Node]:
    """Representative of each node: one node of each group that joints connect rigidly.

    The representative of nodes connected to the ground is the ground.
    """
    nodes = [_BASE]
    for name, body in mechanism.bodies.items():
        nodes += [node for p in body.interfaces if (node := _node(name, p, legs)) not in nodes]
    group = {node: node for node in nodes}
    for joint in mechanism.joints:
        locked = FREEDOMS[joint.kind] == (joint.drive is not None and joint.drive.stiffness is None)
        if locked and joint.compliance is None:
            representative, replaced = sorted(
                (group[_node(side.body, side.point, legs)] for side in (joint.first, joint.second)),
                key=nodes.index,
            )
            group = {
                node: representative if other == replaced else other
                for node, other in group.items()
            }
    return group


def _steps(
    mechanism: Mechanism, legs: Mapping[str, Array], group: Mapping[_Node, _Node]
) -> list[_Step]:
    """All joints and legs that connect different groups of rigidly connected nodes.

    `group` contains the representative of each node, as returned by `_groups`.
    """
    steps = [
        _Step(
            frozenset(
                group[_node(side.body, side.point, legs)] for side in (joint.first, joint.second)
            ),
            joint,
        )
        for joint in mechanism.joints
    ]
    steps += [
        _Step(frozenset(group[name, point] for point in mechanism.bodies[name].interfaces), name)
        for name in legs
    ]
    return [step for step in steps if len(step.nodes) == 2]


def _without_dead_ends(steps: list[_Step], ends: set[_Node]) -> list[_Step]:
    """Joints and legs of `steps` that transmit load between the nodes `ends`.

    Joints and legs that lead to a dead end transmit no load. A dead end is a node outside `ends`
    with a single joint or leg.
    """
    while True:
        nodes = [node for step in steps for node in step.nodes]
        hanging = {node for node in nodes if nodes.count(node) == 1} - ends
        if not hanging:
            return steps
        steps = [step for step in steps if not hanging & step.nodes]


def _node(body: str, point: str, legs: Mapping[str, Array]) -> _Node:
    return (body, point) if body in legs else (body, "")


def _other(step: _Step, node: _Node) -> _Node:
    (other,) = step.nodes - {node}
    return other


def _description(node: _Node) -> str:
    return f"point {node[1]} of {node[0]}" if node[1] else node[0]


def _chain(posture: Posture, legs: Mapping[str, Array], path: list[_Step]) -> vjm.Chain:
    joints: list[tuple[Array, Array]] = []
    springs: list[tuple[Array, Array]] = []
    for step in path:
        if isinstance(step.across, Joint):
            joint = step.across
            position = interface_position(posture, joint.first)
            passive, compliances = _joint(posture, joint)
            joints += [(position, twist) for twist in passive]
            springs += [(position, give) for give in compliances]
        else:
            body = posture.mechanism.bodies[step.across]
            position = interface_position(posture, Side(body.name, tuple(body.interfaces)[1]))
            rotation = posture.frames[body.name].rotation
            springs.append((position, turn_matrix(legs[body.name], rotation)))
    tool = posture.mechanism.tool
    end = interface_position(posture, Side(tool.body, tool.point))
    return vjm.serial_chain(end, joints, springs)


def _joint(posture: Posture, joint: Joint) -> tuple[list[Array], list[Array]]:
    """Passive twists (6 each) of a joint, and its compliances (6×6 each), base axes.

    The compliances are those of the drive and of the joint itself. The first free twist of a driven
    joint is not passive.
    """
    passive, compliances = list(free_twists(posture, joint).T), []
    if joint.drive is not None:
        driven, *passive = passive
        drive = drive_in(posture, joint)
        if drive is not None and drive.stiffness is not None:
            compliances.append(np.outer(driven, driven) / drive.stiffness)
    if joint.compliance is not None:
        rotation = rotation_since_reference(posture, joint.first.body)
        compliances.append(turn_matrix(joint.compliance, rotation))
    return passive, compliances
