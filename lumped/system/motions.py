"""Which motions the joints leave to the nodes of a mechanism, exactly and without penalties.

A node is a rigid body or one interface of a deformable one. Joints are taken one after the other
from what moves already to what does not yet: the node behind a joint moves with the one before it
and by what the joint lets happen. A joint between two nodes that move already closes a loop of
rigid bodies; what it forbids is taken out by the null space of those conditions. Where bodies
between the joints are deformable, there are no such loops, however the mechanism is joined.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array
from lumped.mechanism.free_twists import interface_position
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.mechanism import GROUND, Mechanism, Posture
from lumped.screws import shift
from lumped.system.joint_motion import JointMotion, joint_motion

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
    `length` (m) is the size of the mechanism.
    """

    mechanism: Mechanism
    nodes: tuple[tuple[str, str], ...]
    tree: tuple[tuple[int | None, int], ...]
    closing: tuple[int, ...]
    length: float

    def node(self, body: str, point: str) -> int:
        """Number of the node that an interface belongs to; −1 for the ground."""
        if body == GROUND:
            return _HELD
        rigid = (body, "")
        return self.nodes.index(rigid if rigid in self.nodes else (body, point))


@dataclass(frozen=True, eq=False)
class Motions:
    """What the nodes do in one posture: twists of all nodes = `twists` y, n unknowns y.

    `twists` is N×6×n, base axes, at `places` (N×3, m); a unit of y moves about as far as the
    mechanism is long. `springs`: D (k×n) of every elastic part of a joint, energy ½|D y|² (J);
    `locks` (l×n): what the springs feel, without units.
    """

    structure: Structure
    twists: Array
    places: Array
    springs: Mapping[str, Array]
    locks: Array

    def at(self, body: str, point: str, position: Array) -> Array:
        """Twist (6×n) at `position` (3, m, base axes) of what the interface belongs to."""
        node = self.structure.node(body, point)
        if node == _HELD:
            return np.zeros((6, self.twists.shape[2]))
        moved: Array = shift(position - self.places[node]) @ self.twists[node]
        return moved


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
    return Structure(mechanism, tuple(nodes), tuple(tree), tuple(left), mechanism.size)


def motions(structure: Structure, posture: Posture) -> Motions:
    """The motions that all joints allow in `posture`."""
    joints = structure.mechanism.joints
    allowed = [joint_motion(posture, joint, structure.length) for joint in joints]
    places = np.array([_place(posture, *node) for node in structure.nodes]).reshape(-1, 3)
    free = np.diag([structure.length] * 3 + [1.0] * 3)
    size = sum(6 if j is None else allowed[j].basis.shape[1] for j, _ in structure.tree)
    twists = np.zeros((len(structure.nodes), 6, size))
    springs: dict[str, Array] = {}
    locks = [np.zeros((0, size))]
    done = 0
    for j, node in structure.tree:
        if j is None:
            twists[node, :, done : done + 6] = free
            done += 6
            continue
        joint, motion = joints[j], allowed[j]
        at = interface_position(posture, joint.first)
        mine = slice(done, done + motion.basis.shape[1])
        done = mine.stop
        forward = structure.node(joint.second.body, joint.second.point) == node
        before = joint.first if forward else joint.second
        other = structure.node(before.body, before.point)
        if other != _HELD:
            twists[node] = shift(places[node] - places[other]) @ twists[other]
        arm = shift(places[node] - at)
        twists[node, :, mine] += arm @ motion.basis if forward else -arm @ motion.basis
        for name, rows in motion.springs.items():
            springs[name] = np.zeros((len(rows), size))
            springs[name][:, mine] = rows
        locks.append(np.eye(size)[done - motion.elastic : done])
    open_loops = Motions(structure, twists, places, springs, np.vstack(locks))
    closing = [(joints[j], allowed[j]) for j in structure.closing]
    return _closed(open_loops, posture, closing) if closing else open_loops


def _closed(
    motions: Motions, posture: Posture, closing: list[tuple[Joint, JointMotion]]
) -> Motions:
    unit = np.array([1.0 / motions.structure.length] * 3 + [1.0] * 3)[:, None]
    forbidden, locks = [], [motions.locks]
    springs = dict(motions.springs)
    for joint, motion in closing:
        at = interface_position(posture, joint.first)
        first, second = (
            motions.at(side.body, side.point, at) for side in (joint.first, joint.second)
        )
        apart = unit * (second - first)
        basis = unit * motion.basis
        count = basis.shape[1]
        directions = np.linalg.qr(basis, mode="complete")[0]
        forbidden.append(directions[:, count:].T @ apart)
        if motion.springs:
            let: Array = np.linalg.lstsq(basis, apart, rcond=None)[0].astype(float)
            springs |= {name: rows @ let for name, rows in motion.springs.items()}
            locks.append(let[count - motion.elastic :])
    conditions = np.vstack(forbidden)
    _, values, right = np.linalg.svd(conditions, full_matrices=True)
    rank = int(np.sum(values > _DEPENDENT * max(values.max(initial=0.0), 1.0)))
    allowed = right[rank:].T
    return Motions(
        motions.structure,
        motions.twists @ allowed,
        motions.places,
        {name: rows @ allowed for name, rows in springs.items()},
        np.vstack(locks) @ allowed,
    )


def _place(posture: Posture, body: str, point: str) -> Array:
    if not point:
        return posture.frames[body].position
    return interface_position(posture, Side(body, point))
