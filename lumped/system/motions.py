"""Motions of the nodes of a mechanism that satisfy the constraints of its joints exactly.

A node is a rigid body, or one interface of a deformable body. No penalties are used. The unknowns
that a joint constrains are eliminated, joint by joint. Each step starts from a node whose motion is
already expressed by the remaining unknowns, at first the ground. The second node of the joint has
the motion of the first node plus the relative motion of the joint. Along passive free twists,
however, the motion of the second node has its own unknowns.

If the motions of both nodes of a joint are already expressed, the joint closes a loop of rigid
bodies. Its constraints are then satisfied by a basis of their null space. Such loops do not occur
if the bodies between the joints are deformable.

All postures are evaluated together along the first axis of every array. The relative motion of a
joint rotates with its first body and is computed once. It is computed for each posture if it
depends on the coordinates of the joint: in universal joints, and in drives with a ball screw.
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

# Relative singular value below which loop constraints count as dependent. Dependent constraints
# differ by the accuracy of loop closure, 1e-12 of the mechanism's size. Independent constraints
# differ by the sine of an angle that is visible in a drawing.
_DEPENDENT = 1e-9
# Index of the ground in place of a node.
_FIXED = -1


@dataclass(frozen=True, eq=False)
class Structure:
    """Nodes of a mechanism and the order in which its joints are eliminated, for all postures.

    `nodes` are pairs (body, interface), with "" for the interface of a rigid body. `tree` contains,
    in the order of elimination, pairs of the index of a joint and the index of the node whose
    motion the joint determines. The index of the joint is None for a node that moves freely.
    `closing` are the indices of joints that close loops of rigid bodies. `reference_motions` are
    the relative motions of all joints in the reference posture (base axes). `length` (m) is the
    size of the mechanism.
    """

    mechanism: Mechanism
    nodes: tuple[tuple[str, str], ...]
    tree: tuple[tuple[int | None, int], ...]
    closing: tuple[int, ...]
    reference_motions: tuple[JointMotion, ...]
    length: float

    def node(self, body: str, point: str) -> int:
        """Index of the node to which an interface of `body` belongs. −1 for the ground."""
        if body == GROUND:
            return _FIXED
        rigid = (body, "")
        return self.nodes.index(rigid if rigid in self.nodes else (body, point))


@dataclass(frozen=True, eq=False)
class Motions:
    """Twists of the nodes, as linear functions of n unknowns y.

    The arrays are for one posture, or for several postures (…). Multiplied by y, `twists`
    (…×N×6×n) gives the twists of the N nodes (base axes) at `places` (…×N×3, in m). A unit of y
    corresponds to a translation of about the size of the mechanism. `springs` contains, for each
    elastic part of a joint, the matrix D (…×k×n) of its strain energy ½|D y|² (J). Multiplied by y,
    `locks` (…×l×n) gives dimensionless deflections of all springs. They are zero for motions with
    locked springs.
    """

    structure: Structure
    twists: Array
    places: Array
    springs: Mapping[Portion, Array]
    locks: Array

    def at(self, body: str, point: str, position: Array) -> Array:
        """Matrix (…×6×n) that maps the n unknowns to the twist of the node of an interface.

        The twist is taken at `position` (…×3, in m). Twist and position are in base axes.
        """
        node = self.structure.node(body, point)
        if node == _FIXED:
            return np.zeros_like(self.twists[..., 0, :, :])
        twists: Array = shift(position - self.places[..., node, :]) @ self.twists[..., node, :, :]
        return twists

    def of_posture(self, number: int) -> "Motions":
        """Motions in the posture with the index `number`, from those in several postures."""
        return replace(
            self,
            twists=self.twists[number],
            places=self.places[number],
            springs={part: rows[number] for part, rows in self.springs.items()},
            locks=self.locks[number],
        )


@dataclass(frozen=True, eq=False)
class Frames:
    """Frames of all bodies in P postures, in base axes.

    `positions` (P×3, in m) are the origins and `rotations` (P×3×3, axes as columns) the axes, each
    by name of the body.
    """

    mechanism: Mechanism
    positions: Mapping[str, Array]
    rotations: Mapping[str, Array]

    def interface(self, body: str, point: str) -> Array:
        """Positions (P×3, in m, base axes) of an interface of a body."""
        position_in_body = self.mechanism.bodies[body].interfaces[point].position
        return np.asarray(self.positions[body] + self.rotations[body] @ position_in_body)

    def since_reference(self, body: str) -> Array:
        """Rotations (P×3×3, base axes) of a body from the reference posture."""
        return np.asarray(self.rotations[body] @ self.mechanism.reference[body].rotation.T)


def frames_of(postures: Sequence[Posture]) -> Frames:
    """Frames of all bodies in several postures of one mechanism."""
    mechanism = postures[0].mechanism
    frames = {name: [posture.frames[name] for posture in postures] for name in mechanism.bodies}
    return Frames(
        mechanism,
        {name: np.array([f.position for f in of_body]) for name, of_body in frames.items()},
        {name: np.array([f.rotation for f in of_body]) for name, of_body in frames.items()},
    )


def structure_of(mechanism: Mechanism, deformable: Collection[str]) -> Structure:
    """Nodes and order of elimination for a mechanism with the given `deformable` bodies.

    All other bodies are rigid.
    """
    nodes = [
        (name, point)
        for name, body in mechanism.bodies.items()
        if name != GROUND
        for point in (body.interfaces if name in deformable else ("",))
    ]
    number = {node: i for i, node in enumerate(nodes)}

    def node_of(side: Side) -> int:
        if side.body == GROUND:
            return _FIXED
        return number[side.body, side.point if side.body in deformable else ""]

    sides = [(node_of(joint.first), node_of(joint.second)) for joint in mechanism.joints]
    tree: list[tuple[int | None, int]] = []
    moving = {_FIXED}
    remaining = list(range(len(sides)))
    # A group of nodes without connection to the ground starts at a rigid body, where joints meet.
    starts = sorted(range(len(nodes)), key=lambda i: nodes[i][1] != "")
    while True:
        joint = next((j for j in remaining if len(moving & set(sides[j])) == 1), None)
        if joint is not None:
            (node,) = set(sides[joint]) - moving
            tree.append((joint, node))
            remaining.remove(joint)
        elif (free := next((i for i in starts if i not in moving), None)) is not None:
            node = free
            tree.append((None, node))
        else:
            break
        moving.add(node)
    # A joint from a node to itself closes a loop, because both sides have the same motion.
    size = mechanism.size
    reference_motions = tuple(
        joint_motion(joint, np.eye(3), np.eye(3), size) for joint in mechanism.joints
    )
    return Structure(
        mechanism, tuple(nodes), tuple(tree), tuple(remaining), reference_motions, size
    )


def motions(structure: Structure, frames: Frames) -> Motions:
    """Motions of the nodes in P postures that satisfy the constraints of all joints.

    Raises UnevenError if the number of unknowns depends on the posture.
    """
    joints = structure.mechanism.joints
    joint_motions = [_joint_motion(structure, frames, j) for j in range(len(joints))]
    places = np.stack([_place(frames, *node) for node in structure.nodes], axis=1)
    count = len(places)
    unit = np.array([1.0 / structure.length] * 3 + [1.0] * 3)
    size = sum(6 if j is None else joint_motions[j].basis.shape[-1] for j, _ in structure.tree)
    twists = np.zeros((count, len(structure.nodes), 6, size))
    springs: dict[Portion, Array] = {}
    locks = [np.zeros((0, size))]
    assigned = 0
    for j, node in structure.tree:
        if j is None:
            twists[:, node, :, assigned : assigned + 6] = np.diag(
                [structure.length] * 3 + [1.0] * 3
            )
            assigned += 6
            continue
        joint, motion = joints[j], joint_motions[j]
        columns = slice(assigned, assigned + motion.basis.shape[-1])
        forward = structure.node(joint.second.body, joint.second.point) == node
        driving_side = joint.first if forward else joint.second
        driving_node = structure.node(driving_side.body, driving_side.point)
        if driving_node != _FIXED:
            # The node moves with the unknowns assigned so far.
            arm = shift(places[:, node] - places[:, driving_node])
            twists[:, node, :, :assigned] = arm @ twists[:, driving_node, :, :assigned]
        arm = shift(places[:, node] - frames.interface(joint.first.body, joint.first.point))
        relative = arm @ (motion.basis if forward else -motion.basis)
        twists[:, node, :, columns] = relative
        # Along passive free twists the node has its own unknowns. If the motion of the other node
        # were added, small differences of large motions would lose the soft directions.
        passive = relative[..., : relative.shape[-1] - motion.elastic]
        twists[:, node, :, :assigned] -= _projector(passive, unit) @ twists[:, node, :, :assigned]
        assigned = columns.stop
        for part, rows in motion.springs.items():
            springs[part] = np.zeros((count, rows.shape[-2], size))
            springs[part][..., columns] = rows
        locks.append(np.eye(size)[assigned - motion.elastic : assigned])
    locked = np.broadcast_to(np.vstack(locks), (count, sum(map(len, locks)), size))
    open_loops = Motions(structure, twists, places, springs, locked)
    closing = [(joints[j], joint_motions[j]) for j in structure.closing]
    return _closed(open_loops, frames, closing) if closing else open_loops


def _projector(free: Array, unit: Array) -> Array:
    """Matrix (…×6×6) that projects twists onto the span of `free` (…×6×k) by least squares.

    The components are made dimensionless by the factors `unit` (6).
    """
    return np.asarray(free @ np.linalg.pinv(unit[:, None] * free) * unit)


def _joint_motion(structure: Structure, frames: Frames, number: int) -> JointMotion:
    """Relative motion (base axes) of the joint with index `number` in P postures."""
    joint = structure.mechanism.joints[number]
    first = frames.since_reference(joint.first.body)
    has_screw = joint.drive is not None and joint.drive.screw is not None
    if AXES[joint.kind] < 2 and not has_screw:
        return structure.reference_motions[number].rotated(first)
    second = frames.since_reference(joint.second.body)
    stiffness = drive_stiffnesses(joint, frames)
    return joint_motion(joint, first, second, structure.length, stiffness)


def drive_stiffnesses(joint: Joint, frames: Frames) -> Array | None:
    """Stiffness (N/m or N m/rad) of the drive of a joint. None if there is none, or if it is rigid.

    It is one number for each of P postures if the drive has a ball screw, otherwise one number for
    all.
    """
    drive = joint.drive
    if drive is None or drive.stiffness is None:
        return None
    if drive.screw is None:
        return np.asarray(drive.stiffness)
    mechanism = frames.mechanism
    first, second = (
        frames.interface(side.body, side.point) for side in (joint.first, joint.second)
    )
    first_reference, second_reference = (
        mechanism.reference[side.body] @ mechanism.bodies[side.body].interfaces[side.point]
        for side in (joint.first, joint.second)
    )
    axis = frames.since_reference(joint.first.body) @ joint.axes[0]
    reference_distance = (second_reference.position - first_reference.position) @ joint.axes[0]
    return drive.screw.stiffness(np.sum(axis * (second - first), axis=-1) - reference_distance)


def _closed(
    motions: Motions, frames: Frames, closing: Sequence[tuple[Joint, JointMotion]]
) -> Motions:
    unit = np.array([1.0 / motions.structure.length] * 3 + [1.0] * 3)[:, None]
    constraint_rows, locks = [], [motions.locks]
    springs = dict(motions.springs)
    for joint, motion in closing:
        if rotor_moves_alone(joint):
            raise ComputationError(
                f"joint {joint.name}: closes a loop of rigid bodies and has both a rotor and a "
                "compliance, so that the motion of the rotor is undetermined; describe the rotor "
                "as a body"
            )
        position = frames.interface(joint.first.body, joint.first.point)
        first, second = (
            motions.at(side.body, side.point, position) for side in (joint.first, joint.second)
        )
        relative = unit * (second - first)
        basis = unit * motion.basis
        count = basis.shape[-1]
        directions = np.linalg.qr(basis, mode="complete")[0]
        constraint_rows.append(np.swapaxes(directions[..., count:], -1, -2) @ relative)
        if motion.springs:
            coordinates: Array = np.linalg.pinv(basis) @ relative
            springs |= {part: rows @ coordinates for part, rows in motion.springs.items()}
            locks.append(coordinates[..., count - motion.elastic :, :])
    _, values, right = np.linalg.svd(np.concatenate(constraint_rows, axis=-2), full_matrices=True)
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
