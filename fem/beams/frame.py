"""Frames in space: prismatic beam members between nodes, and supports.

Members are those of `fem.beams.beam`, so that statics under loads at the nodes are exact and
frequencies converge with the fourth power of the element's length. Nodes have six unknowns in
frame axes; what the members add inside stays in member axes. For small frames: the matrices are
solved densely.
"""

from dataclasses import dataclass
from functools import reduce
from operator import add
from typing import Literal, TypeAlias, get_args

import numpy as np
from scipy.sparse import block_diag, csr_matrix, identity, vstack

from fem.beams.beam import beam_leg
from fem.beams.beam_theory import Kind
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.dense.modes import Modes, solve_modes
from lumped.dense.statics import solve_statics
from lumped.errors import InputError
from lumped.legs import BeamProperties
from lumped.mechanism.body_model import LegMatrices
from lumped.screws import skew, turn

Component: TypeAlias = Literal["x", "y", "z", "φx", "φy", "φz"]
Vector: TypeAlias = tuple[float, float, float]

KINDS: tuple[Kind, ...] = get_args(Kind)
COMPONENTS: tuple[Component, ...] = get_args(Component)


@dataclass(frozen=True)
class Member:
    """Prismatic beam from node `start` to node `end` (numbers from 0), local x along it.

    `normal` (frame axes) lies in the member's x–z plane on the side of +z and fixes the section's
    orientation; y = z × x. `kinds` are the deformations that the member has; along the others its
    inside does not move, and it gives its nodes no stiffness.
    """

    start: int
    end: int
    properties: BeamProperties
    normal: Vector
    elements: int = 8
    kinds: tuple[Kind, ...] = KINDS


@dataclass(frozen=True)
class Support:
    """Components of a node's twist that are held, in frame axes; a pin holds x, y and z."""

    node: int
    held: tuple[Component, ...] = COMPONENTS


@dataclass(frozen=True)
class Frame:
    """Nodes (N×3, m), what is between them and what holds them; `name` is for messages."""

    name: str
    nodes: Array
    members: tuple[Member, ...]
    supports: tuple[Support, ...] = ()


@dataclass(frozen=True)
class AssembledFrame:
    """Stiffness and mass (n×n sparse, SI) of a frame on its n free unknowns.

    `twists` (6N×n) gives the twists of the nodes in frame axes, node by node. `members` gives, per
    member, its free matrices and the sparse matrix from the frame's unknowns to its own:
    `leg.centreline(stations) @ to_own @ shapes` are its twists in member axes.
    """

    name: str
    stiffness: SparseMatrix
    mass: SparseMatrix
    twists: SparseMatrix
    members: tuple[tuple[LegMatrices, SparseMatrix], ...]


def assemble(frame: Frame) -> AssembledFrame:
    """The frame's matrices. Raises InputError for members, supports or numbers that make none."""
    _check(frame)
    built = [_member(frame, member) for member in frame.members]
    node_motion = _free_nodes(frame)
    inner_sizes = [len(one.inner) for one in built]
    # Free unknowns: those of the nodes, then those inside the members, member by member.
    motion = block_diag([node_motion, identity(sum(inner_sizes))], format="csr")
    node_count = 6 * len(frame.nodes)
    size = node_count + sum(inner_sizes)
    starts = node_count + np.cumsum([0, *inner_sizes])
    to_own = [one.placed(start, size) @ motion for one, start in zip(built, starts, strict=False)]
    twists = csr_matrix(identity(size, format="csr")[:node_count] @ motion)
    stiffness = [t.T @ one.stiffness @ t for one, t in zip(built, to_own, strict=True)]
    mass = [t.T @ one.leg.mass @ t for one, t in zip(built, to_own, strict=True)]
    return AssembledFrame(
        name=frame.name,
        stiffness=csr_matrix(reduce(add, stiffness)),
        mass=csr_matrix(reduce(add, mass)),
        twists=twists,
        members=tuple((one.leg, t) for one, t in zip(built, to_own, strict=True)),
    )


def displacements(frame: AssembledFrame, wrenches: Array) -> Array:
    """Twists of the nodes (6N×m, frame axes) under wrenches on them (6N×m, N and N m).

    Raises ComputationError where a part of the frame is free to move.
    """
    unknowns = solve_statics(frame.stiffness, frame.twists.T @ wrenches, frame.name)
    return np.asarray(frame.twists @ unknowns)


def modes(frame: AssembledFrame, count: int) -> Modes:
    """The lowest `count` modes (shapes on the frame's free unknowns).

    Raises ComputationError where a part is free to move or fewer modes have mass.
    """
    return solve_modes(frame.stiffness, frame.mass, count, frame.name)


@dataclass(frozen=True)
class _BuiltMember:
    """A member's matrices and how it hangs on the nodes.

    `ends` (12×6N) gives its end twists in member axes, `inner` the unknowns inside that its kinds
    of deformation move, `stiffness` that of these kinds.
    """

    leg: LegMatrices
    stiffness: SparseMatrix
    ends: SparseMatrix
    inner: IntArray

    def placed(self, first: int, size: int) -> SparseMatrix:
        """Sparse matrix from all nodes' and inner unknowns (`size`) to those of the member."""
        rows = identity(size, format="csr")
        nodes = self.ends @ rows[: self.ends.shape[1]]
        chosen = identity(self.leg.size - 12, format="csr")[:, self.inner - 12]
        return vstack([nodes, chosen @ rows[first : first + len(self.inner)]], format="csr")


def _member(frame: Frame, member: Member) -> _BuiltMember:
    start, end = _member_ends(frame, member)
    leg = beam_leg(member.properties, float(np.linalg.norm(end - start)), member.elements)
    to_member_axes = turn(_member_axes(frame, member)).T
    rows = identity(6 * len(frame.nodes), format="csr")
    ends = [
        csr_matrix(to_member_axes) @ rows[6 * node : 6 * node + 6]
        for node in (member.start, member.end)
    ]
    stiffness = csr_matrix(reduce(add, (leg.parts[kind] for kind in member.kinds)))
    moved = np.flatnonzero(stiffness.diagonal() > 0.0)
    return _BuiltMember(leg, stiffness, vstack(ends, format="csr"), moved[moved >= 12])


def _member_ends(frame: Frame, member: Member) -> tuple[Array, Array]:
    nodes = np.asarray(frame.nodes, dtype=float)
    return nodes[member.start], nodes[member.end]


def _member_axes(frame: Frame, member: Member) -> Array:
    """3×3, the member's x, y, z as columns in frame axes."""
    start, end = _member_ends(frame, member)
    x = (end - start) / np.linalg.norm(end - start)
    y = np.cross(np.array(member.normal), x)
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])


def _free_nodes(frame: Frame) -> SparseMatrix:
    """6N × free: twists of the nodes from the components that no support holds."""
    blocks = [np.eye(6) for _ in frame.nodes]
    for support in frame.supports:
        free = [i for i, component in enumerate(COMPONENTS) if component not in support.held]
        blocks[support.node] = np.eye(6)[:, free]
    return block_diag(blocks, format="csr")


def _check(frame: Frame) -> None:
    faults: list[str] = []
    count = len(frame.nodes)
    used = [node for member in frame.members for node in (member.start, member.end)]
    used += [support.node for support in frame.supports]
    faults += [f"node {n}: there are {count}" for n in sorted(set(used)) if not 0 <= n < count]
    held = [support.node for support in frame.supports]
    faults += [f"node {n}: supported twice" for n in sorted({n for n in held if held.count(n) > 1})]
    if not faults:
        faults += [
            fault
            for number, member in enumerate(frame.members)
            for fault in _member_faults(frame, number, member)
        ]
    if faults:
        raise InputError(f"{frame.name}: {fault}" for fault in faults)


def _member_faults(frame: Frame, number: int, member: Member) -> list[str]:
    start, end = _member_ends(frame, member)
    length, normal = float(np.linalg.norm(end - start)), np.array(member.normal)
    if not length > 0.0:
        return [f"member {number}: its two ends are at one place"]
    if not member.kinds:
        return [f"member {number}: kinds is empty: it must deform in some way"]
    across = float(np.linalg.norm(skew((end - start) / length) @ normal))
    if not across > 1e-9 * float(np.linalg.norm(normal)):
        return [f"member {number}: normal = {member.normal}: must not lie along the member"]
    return []
