"""The virtual joint method on any mechanism whose legs are serial chains (eqs 3 to 9).

A chain leads from the ground to what carries the tool: the free twists of its joints, one after
the other, and 6-DOF springs at the tips of the legs, in the joints and in the drives. The chains
end at the platform; springs between it and the tool lie in series with all of them. The rest is
`lumped.models.vjm`: a formulation of its own, which shares no assembly with the other models.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError, InputError
from lumped.mechanism.free_twists import free_twists, interface_position, turned_since_reference
from lumped.mechanism.joint import FREEDOMS, Joint, Side
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.load import Loading
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.models import vjm
from lumped.screws import shift, turn_matrix

# What moves as one: a rigid body ("" for the interface) or one interface of a leg.
_Node: TypeAlias = tuple[str, str]
_BASE: _Node = (GROUND, "")


@dataclass(frozen=True)
class _Step:
    """A joint, or a leg (by name) from one of its interfaces to the other, between two nodes."""

    nodes: frozenset[_Node]
    across: Joint | str


class NoChainError(InputError):
    """A leg of the robot is no serial chain: `reason` says where."""

    def __init__(self, robot: str, reason: str) -> None:
        super().__init__(f"{robot}: {reason}; take --model links")
        self.reason = reason


def compliance(posture: Posture, legs: Mapping[str, Array]) -> Array:
    """6×6 compliance (SI, base axes) at the loaded point.

    `legs`: 6×6 compliance of every leg (SI, body axes) at its second interface, the first clamped;
    bodies without one are rigid. Raises NoChainError where a leg of the robot is no serial chain,
    ComputationError where a chain is rigid or the tool is free to move.
    """
    place = shown_pose(posture.mechanism, posture.pose)
    name = f"{posture.mechanism.name}, virtual joints" + (f", {place}" if place else "")
    parallel, series = serial_chains(posture, legs)
    platform = vjm.platform_compliance(vjm.robot_stiffness(parallel), f"{name}: the tool")
    return platform + series.compliance


def serial_chains(
    posture: Posture, legs: Mapping[str, Array]
) -> tuple[tuple[vjm.Chain, ...], vjm.Chain]:
    """Every chain from the ground to the platform, and the one from there to the tool.

    All end at the loaded point; the former in the order of the joints at their end.
    """
    paths, onward = _paths(posture.mechanism, legs)
    return (
        tuple(_chain(posture, legs, path) for path in paths),
        _chain(posture, legs, onward),
    )


def tool_displacements(
    posture: Posture, legs: Mapping[str, Array], loads: Sequence[Loading]
) -> Array:
    """Displacements (l×6, m and rad, base axes) of the loaded point; `legs` as in `compliance`.

    What hangs on the chains loads them where it hangs. Raises as `compliance` does.
    """
    mechanism, tool = posture.mechanism, posture.mechanism.tool
    paths, onward = _paths(mechanism, legs)
    chains = [_chain(posture, legs, path) for path in paths]
    stiffness = vjm.robot_stiffness(chains)
    platform = vjm.platform_compliance(stiffness, f"{mechanism.name}, virtual joints: the tool")
    end = interface_position(posture, Side(tool.body, tool.point))
    carrier = _carriers(mechanism, legs, [*onward, *(step for path in paths for step in path)])

    def moved(load: Loading) -> Array:
        at: dict[_Node, Array] = defaultdict(lambda: np.zeros(6))
        for one in load.everywhere:
            node = carrier[_node(one.body, one.point, legs)]
            at[node] = at[node] + shift(one.position - end).T @ one.wrench
        on_platform, beyond = np.zeros(6), np.zeros(6)
        for path, chain in zip(paths, chains, strict=True):
            slip, work, here = np.zeros(6), np.zeros(chain.passive.shape[1]), carrier[_BASE]
            for count, step in enumerate(path[:-1], start=1):
                slip += _given_way(posture, step, load, end)
                here = _other(step, here)
                before = _chain(posture, legs, path[:count])
                slip += before.compliance @ at[here]
                work[: before.passive.shape[1]] += before.passive.T @ at[here]
            slip += _given_way(posture, path[-1], load, end)
            on_platform += vjm.carried(chain, slip, work)
            here = _other(path[-1], here)
        on_platform += at[here]
        for count, step in enumerate(onward, start=1):
            here = _other(step, here)
            beyond += _given_way(posture, step, load, end)
            beyond += _chain(posture, legs, onward[:count]).compliance @ at[here]
            on_platform += at[here]
        return np.asarray(platform @ on_platform + beyond)

    return np.reshape([moved(load) for load in loads], (-1, 6))


def _given_way(posture: Posture, step: _Step, load: Loading, end: Array) -> Array:
    """Twist (6) at `end` by which a drive gives way to the force on its rotor."""
    joint = step.across
    if isinstance(joint, str) or joint.drive is None or joint.drive.stiffness is None:
        return np.zeros(6)
    arm = shift(end - interface_position(posture, joint.first))
    given = load.on_rotors.get(joint.name, 0.0) / joint.drive.stiffness
    return np.asarray(given * (arm @ free_twists(posture, joint)[:, 0]))


def _carriers(
    mechanism: Mechanism, legs: Mapping[str, Array], kept: Sequence[_Step]
) -> dict[_Node, _Node]:
    """Every node with the one of the chains that moves as it does, or that it hangs on."""
    group = _groups(mechanism, legs)
    carrier = {node: node for step in kept for node in step.nodes}
    left = [step for step in _steps(mechanism, legs, group) if step not in kept]
    while left:
        step = next(one for one in left if carrier.keys() & one.nodes)
        left.remove(step)
        for node in step.nodes - carrier.keys():
            carrier[node] = carrier[_other(step, node)]
    return {node: carrier[of] for node, of in group.items()}


def _paths(
    mechanism: Mechanism, legs: Mapping[str, Array]
) -> tuple[list[list[_Step]], list[_Step]]:
    """Steps of each chain from the ground to the platform, and those from it to the tool.

    Raises NoChainError where one branches, ComputationError where the tool is part of the ground.
    """
    moving_as_one = _groups(mechanism, legs)
    base = moving_as_one[_BASE]
    end = moving_as_one[_node(mechanism.tool.body, mechanism.tool.point, legs)]
    if end == base:
        raise ComputationError(
            f"{mechanism.name}, virtual joints: rigid bodies and joints without freedom alone hold "
            "the tool to the ground, so its stiffness is infinite"
        )
    steps = _without_dead_ends(_steps(mechanism, legs, moving_as_one), {base, end})
    series = _series(steps, end, base)
    for step in series:
        end = _other(step, end)
    steps = [step for step in steps if step not in series]
    paths = []
    for start in [step for step in steps if end in step.nodes]:
        path, here = [start], _other(start, end)
        while here != base:
            onward = [step for step in steps if here in step.nodes and step is not path[-1]]
            if here == end or len(onward) != 1:
                raise NoChainError(
                    mechanism.name,
                    "the vjm model sums serial chains from the ground to the tool, but the robot "
                    f"branches at {_words(here)}",
                )
            path.append(onward[0])
            here = _other(onward[0], here)
        paths.append(path[::-1])
    return paths, series[::-1]


def _series(steps: list[_Step], end: _Node, base: _Node) -> list[_Step]:
    """Steps from the tool back to where the robot branches; none where a single chain holds it."""
    series: list[_Step] = []
    while end != base:
        onward = [step for step in steps if end in step.nodes and step not in series]
        if len(onward) != 1 or _is_passive(onward[0].across):
            return series
        series += onward
        end = _other(onward[0], end)
    return []


def _is_passive(across: Joint | str) -> bool:
    """Whether a joint leaves some twist to nothing but the rest of the robot."""
    driven = isinstance(across, Joint) and across.drive is not None
    return isinstance(across, Joint) and FREEDOMS[across.kind] > driven


def _groups(mechanism: Mechanism, legs: Mapping[str, Array]) -> dict[_Node, _Node]:
    """Every node with the one that stands for all that joints without freedom or give hold to it.

    Whatever is held to the ground is the ground.
    """
    nodes = [_BASE]
    for name, body in mechanism.bodies.items():
        nodes += [node for p in body.interfaces if (node := _node(name, p, legs)) not in nodes]
    group = {node: node for node in nodes}
    for joint in mechanism.joints:
        held = FREEDOMS[joint.kind] == (joint.drive is not None and joint.drive.stiffness is None)
        if held and joint.compliance is None:
            kept, gone = sorted(
                (group[_node(side.body, side.point, legs)] for side in (joint.first, joint.second)),
                key=nodes.index,
            )
            group = {node: kept if of == gone else of for node, of in group.items()}
    return group


def _steps(
    mechanism: Mechanism, legs: Mapping[str, Array], group: Mapping[_Node, _Node]
) -> list[_Step]:
    """All joints and legs between what does not move as one anyway."""
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
    """The steps but those of what hangs on the robot and carries nothing."""
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


def _words(node: _Node) -> str:
    return f"point {node[1]} of {node[0]}" if node[1] else node[0]


def _chain(posture: Posture, legs: Mapping[str, Array], path: list[_Step]) -> vjm.Chain:
    joints: list[tuple[Array, Array]] = []
    springs: list[tuple[Array, Array]] = []
    for step in path:
        if isinstance(step.across, Joint):
            joint = step.across
            place = interface_position(posture, joint.first)
            passive, gives = _joint(posture, joint)
            joints += [(place, twist) for twist in passive]
            springs += [(place, give) for give in gives]
        else:
            body = posture.mechanism.bodies[step.across]
            place = interface_position(posture, Side(body.name, tuple(body.interfaces)[1]))
            rotation = posture.frames[body.name].rotation
            springs.append((place, turn_matrix(legs[body.name], rotation)))
    tool = posture.mechanism.tool
    end = interface_position(posture, Side(tool.body, tool.point))
    return vjm.serial_chain(end, joints, springs)


def _joint(posture: Posture, joint: Joint) -> tuple[list[Array], list[Array]]:
    """Passive twists (6 each) and compliances (6×6 each) of a joint, base axes.

    A drive takes the place of the first freedom.
    """
    passive, gives = list(free_twists(posture, joint).T), []
    if joint.drive is not None:
        driven, *passive = passive
        if joint.drive.stiffness is not None:
            gives.append(np.outer(driven, driven) / joint.drive.stiffness)
    if joint.compliance is not None:
        since = turned_since_reference(posture, joint.first.body)
        gives.append(turn_matrix(joint.compliance, since))
    return passive, gives
