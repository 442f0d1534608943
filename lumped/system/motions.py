"""Which motions the joints leave to the nodes of a mechanism, exactly and without penalties.

A node is a rigid body or one interface of a deformable one. Joints are taken one after the other
from what moves already to what does not yet: the node behind a joint moves with the one before it
and by what the joint lets happen; along what is free it moves by itself. A joint between two nodes
that move already closes a loop of rigid bodies; what it forbids is taken out by the null space of
those conditions. Where bodies between the joints are deformable, there are no such loops, however
the mechanism is joined.

All postures that are asked for are done together, the first axis of every array. What a joint lets
happen turns with its bodies and is found once; that of universal joints changes with their angle.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.mechanism.joint import AXES, Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.screws import shift
from lumped.system.joint_motion import (
    JointMotion,
    Portion,
    joint_motion,
    rotor_moves_alone,
    same_rank,
)

# Loops are closed to 1e-12 of the mechanism's size: conditions that depend on each other differ by
# as much, those that do not by the sine of an angle that a designer can see.
_DEPENDENT = 1e-9
_HELD = -1


@dataclass(frozen=True, eq=False)
class Structure:
    """How the nodes hang together, in every posture the same.

    `nodes` are (body, interface), with interface "" for a rigid body. `tree` lists the joints (by
    number) in the order of elimination with the number of the node that each sets in motion, or
    None and a node that moves freely; `closing` the joints between nodes that move already.
    `described` is what each joint lets happen in the reference posture, base axes. `length` (m) is
    the size of the mechanism.
    """

    mechanism: Mechanism
    nodes: tuple[tuple[str, str], ...]
    tree: tuple[tuple[int | None, int], ...]
    closing: tuple[int, ...]
    described: tuple[JointMotion, ...]
    length: float

    def node(self, body: str, point: str) -> int:
        """Number of the node that an interface belongs to; −1 for the ground."""
        if body == GROUND:
            return _HELD
        rigid = (body, "")
        return self.nodes.index(rigid if rigid in self.nodes else (body, point))


@dataclass(frozen=True, eq=False)
class Motions:
    """What the nodes do: twists of all nodes = `twists` y, n unknowns y.

    `twists` is …×N×6×n, base axes, at `places` (…×N×3, m), of one posture or of many; a unit of y
    moves about as far as the mechanism is long. `springs`: D (…×k×n) of every elastic part of a
    joint, energy ½|D y|² (J); `locks` (…×l×n): what the springs feel, without units.
    """

    structure: Structure
    twists: Array
    places: Array
    springs: Mapping[Portion, Array]
    locks: Array

    def at(self, body: str, point: str, position: Array) -> Array:
        """Twist (…×6×n) at `position` (…×3, m, base axes) of what the interface belongs to."""
        node = self.structure.node(body, point)
        if node == _HELD:
            return np.zeros_like(self.twists[..., 0, :, :])
        moved: Array = shift(position - self.places[..., node, :]) @ self.twists[..., node, :, :]
        return moved

    def of(self, number: int) -> "Motions":
        """Those of one posture of many."""
        return replace(
            self,
            twists=self.twists[number],
            places=self.places[number],
            springs={part: rows[number] for part, rows in self.springs.items()},
            locks=self.locks[number],
        )


@dataclass(frozen=True, eq=False)
class Frames:
    """Frames of all bodies in P postures: `positions` (P×3, m) and `rotations` (P×3×3) by body."""

    mechanism: Mechanism
    positions: Mapping[str, Array]
    rotations: Mapping[str, Array]

    def interface(self, body: str, point: str) -> Array:
        """Where an interface is (P×3, m, base axes)."""
        own = self.mechanism.bodies[body].interfaces[point].position
        return np.asarray(self.positions[body] + self.rotations[body] @ own)

    def since_reference(self, body: str) -> Array:
        """Rotations (P×3×3) of a body from the reference posture, base axes."""
        return np.asarray(self.rotations[body] @ self.mechanism.reference[body].rotation.T)


def frames_of(postures: Sequence[Posture]) -> Frames:
    """The frames of postures of one mechanism, body by body."""
    mechanism = postures[0].mechanism
    frames = {name: [at.frames[name] for at in postures] for name in mechanism.bodies}
    return Frames(
        mechanism,
        {name: np.array([frame.position for frame in of]) for name, of in frames.items()},
        {name: np.array([frame.rotation for frame in of]) for name, of in frames.items()},
    )


def structure_of(mechanism: Mechanism, deformable: Collection[str]) -> Structure:
    """The order of elimination for a mechanism whose bodies are rigid but for `deformable`."""
    nodes = [
        (name, point)
        for name, body in mechanism.bodies.items()
        if name != GROUND
        for point in (body.interfaces if name in deformable else ("",))
    ]
    number = {node: i for i, node in enumerate(nodes)}

    def of(side: Side) -> int:
        if side.body == GROUND:
            return _HELD
        return number[side.body, side.point if side.body in deformable else ""]

    sides = [(of(joint.first), of(joint.second)) for joint in mechanism.joints]
    tree: list[tuple[int | None, int]] = []
    moving = {_HELD}
    left = list(range(len(sides)))
    # Rigid bodies are the hubs that many joints meet at: they start what the ground does not hold.
    starts = sorted(range(len(nodes)), key=lambda i: nodes[i][1] != "")
    while True:
        found = next((j for j in left if len(moving & set(sides[j])) == 1), None)
        if found is not None:
            (reached,) = set(sides[found]) - moving
            tree.append((found, reached))
            left.remove(found)
        elif (free := next((i for i in starts if i not in moving), None)) is not None:
            reached = free
            tree.append((None, reached))
        else:
            break
        moving.add(reached)
    # A joint from a node to itself is one whose sides move alike: nothing is left to it.
    size = mechanism.size
    described = tuple(joint_motion(joint, np.eye(3), np.eye(3), size) for joint in mechanism.joints)
    return Structure(mechanism, tuple(nodes), tuple(tree), tuple(left), described, size)


def motions(structure: Structure, frames: Frames) -> Motions:
    """The motions that all joints allow in P postures.

    Raises UnevenError where their numbers differ.
    """
    joints = structure.mechanism.joints
    allowed = [_allowed(structure, frames, j) for j in range(len(joints))]
    places = np.stack([_place(frames, *node) for node in structure.nodes], axis=1)
    count = len(places)
    unit = np.array([1.0 / structure.length] * 3 + [1.0] * 3)
    size = sum(6 if j is None else allowed[j].basis.shape[-1] for j, _ in structure.tree)
    twists = np.zeros((count, len(structure.nodes), 6, size))
    springs: dict[Portion, Array] = {}
    locks = [np.zeros((0, size))]
    done = 0
    for j, node in structure.tree:
        if j is None:
            twists[:, node, :, done : done + 6] = np.diag([structure.length] * 3 + [1.0] * 3)
            done += 6
            continue
        joint, motion = joints[j], allowed[j]
        mine = slice(done, done + motion.basis.shape[-1])
        forward = structure.node(joint.second.body, joint.second.point) == node
        before = joint.first if forward else joint.second
        other = structure.node(before.body, before.point)
        if other != _HELD:
            # What moves it is what has been taken so far.
            arm = shift(places[:, node] - places[:, other])
            twists[:, node, :, :done] = arm @ twists[:, other, :, :done]
        arm = shift(places[:, node] - frames.interface(joint.first.body, joint.first.point))
        own = arm @ (motion.basis if forward else -motion.basis)
        twists[:, node, :, mine] = own
        # Of its own where nothing couples both sides: soft beside stiff would be lost in the sum of
        # what is only their difference.
        passive = own[..., : own.shape[-1] - motion.elastic]
        twists[:, node, :, :done] -= _along(passive, unit) @ twists[:, node, :, :done]
        done = mine.stop
        for part, rows in motion.springs.items():
            springs[part] = np.zeros((count, rows.shape[-2], size))
            springs[part][..., mine] = rows
        locks.append(np.eye(size)[done - motion.elastic : done])
    locked = np.broadcast_to(np.vstack(locks), (count, sum(map(len, locks)), size))
    open_loops = Motions(structure, twists, places, springs, locked)
    closing = [(joints[j], allowed[j]) for j in structure.closing]
    return _closed(open_loops, frames, closing) if closing else open_loops


def _along(free: Array, unit: Array) -> Array:
    """…×6×6: of a twist, without units by `unit` (6), what lies along the `free` ones (…×6×k)."""
    return np.asarray(free @ np.linalg.pinv(unit[:, None] * free) * unit)


def _allowed(structure: Structure, frames: Frames, number: int) -> JointMotion:
    """What a joint lets happen in P postures, base axes."""
    joint = structure.mechanism.joints[number]
    first = frames.since_reference(joint.first.body)
    if AXES[joint.kind] < 2:
        return structure.described[number].turned(first)
    second = frames.since_reference(joint.second.body)
    return joint_motion(joint, first, second, structure.length)


def _closed(
    motions: Motions, frames: Frames, closing: Sequence[tuple[Joint, JointMotion]]
) -> Motions:
    unit = np.array([1.0 / motions.structure.length] * 3 + [1.0] * 3)[:, None]
    forbidden, locks = [], [motions.locks]
    springs = dict(motions.springs)
    for joint, motion in closing:
        if rotor_moves_alone(joint):
            raise ComputationError(
                f"joint {joint.name}: closes a loop of rigid bodies, where the rotor of its drive "
                "needs a body of its own beside the joint's compliance"
            )
        at = frames.interface(joint.first.body, joint.first.point)
        first, second = (
            motions.at(side.body, side.point, at) for side in (joint.first, joint.second)
        )
        apart = unit * (second - first)
        basis = unit * motion.basis
        count = basis.shape[-1]
        directions = np.linalg.qr(basis, mode="complete")[0]
        forbidden.append(np.swapaxes(directions[..., count:], -1, -2) @ apart)
        if motion.springs:
            let: Array = np.linalg.pinv(basis) @ apart
            springs |= {part: rows @ let for part, rows in motion.springs.items()}
            locks.append(let[..., count - motion.elastic :, :])
    _, values, right = np.linalg.svd(np.concatenate(forbidden, axis=-2), full_matrices=True)
    largest = np.maximum(values.max(axis=-1, keepdims=True, initial=0.0), 1.0)
    rank = same_rank(values > _DEPENDENT * largest)
    allowed = np.swapaxes(right[:, rank:], -1, -2)
    return Motions(
        motions.structure,
        motions.twists @ allowed[:, None],
        motions.places,
        {part: rows @ allowed for part, rows in springs.items()},
        np.concatenate(locks, axis=-2) @ allowed,
    )


def _place(frames: Frames, body: str, point: str) -> Array:
    return frames.interface(body, point) if point else frames.positions[body]
