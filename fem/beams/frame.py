"""Frames in space: prismatic beam members between nodes, and supports.

Members are those of `fem.beams.beam`, so that statics under loads at the nodes are exact and
frequencies converge with the fourth power of the element's length. Nodes have six unknowns in
frame axes; what the members add inside stays in member axes. For small frames: the matrices are
solved densely.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias, get_args

import numpy as np
from scipy.sparse import block_diag, csr_matrix, identity, vstack

from fem.beams.beam import beam_leg
from fem.beams.beam_theory import Kind
from lumped.arrays import Array, SparseMatrix
from lumped.dense.modes import Modes, solve_modes
from lumped.dense.statics import solve_statics
from lumped.legs import BeamProperties
from lumped.mechanism.body_model import LegMatrices
from lumped.screws import turn

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
class BeamFrame:
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


def assemble(frame: BeamFrame) -> AssembledFrame:
    """The frame's matrices on the free unknowns of its nodes, then those inside its members."""
    free = _free_nodes(frame)
    legs = [_leg(frame, member) for member in frame.members]
    parts = [
        csr_matrix(sum(leg.parts[kind] for kind in member.kinds))
        for leg, member in zip(legs, frame.members, strict=True)
    ]
    # Those that its kinds of deformation move.
    inner = [np.flatnonzero(part.diagonal()[12:] > 0.0) for part in parts]
    stops = free.shape[1] + np.cumsum([len(moved) for moved in inner])
    rows = identity(int(stops[-1]), format="csr")
    to_own = []
    for member, leg, moved, stop in zip(frame.members, legs, inner, stops, strict=True):
        inside = identity(leg.size - 12, format="csr")[:, moved]
        own = block_diag([_ends(frame, member) @ free, inside], format="csr")
        to_own.append(csr_matrix(own @ rows[np.r_[: free.shape[1], stop - len(moved) : stop]]))
    return AssembledFrame(
        name=frame.name,
        stiffness=csr_matrix(sum(t.T @ k @ t for k, t in zip(parts, to_own, strict=True))),
        mass=csr_matrix(sum(t.T @ leg.mass @ t for leg, t in zip(legs, to_own, strict=True))),
        twists=csr_matrix(free @ rows[: free.shape[1]]),
        members=tuple(zip(legs, to_own, strict=True)),
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


def _leg(frame: BeamFrame, member: Member) -> LegMatrices:
    length = float(np.linalg.norm(frame.nodes[member.end] - frame.nodes[member.start]))
    return beam_leg(member.properties, length, member.elements)


def _ends(frame: BeamFrame, member: Member) -> SparseMatrix:
    """End twists (12×6N) in member axes from those of the nodes."""
    to_member_axes = turn(_member_axes(frame, member)).T
    rows = identity(6 * len(frame.nodes), format="csr")
    nodes = (rows[6 * node : 6 * node + 6] for node in (member.start, member.end))
    return vstack([csr_matrix(to_member_axes) @ twists for twists in nodes], format="csr")


def _member_axes(frame: BeamFrame, member: Member) -> Array:
    """3×3, the member's x, y, z as columns in frame axes."""
    along = frame.nodes[member.end] - frame.nodes[member.start]
    x = along / np.linalg.norm(along)
    y = np.cross(np.array(member.normal), x)
    y /= np.linalg.norm(y)
    return np.column_stack([x, y, np.cross(x, y)])


def _free_nodes(frame: BeamFrame) -> SparseMatrix:
    """6N × free: twists of the nodes from the components that no support holds."""
    blocks = [np.eye(6) for _ in frame.nodes]
    for support in frame.supports:
        free = [i for i, component in enumerate(COMPONENTS) if component not in support.held]
        blocks[support.node] = np.eye(6)[:, free]
    return block_diag(blocks, format="csr")
