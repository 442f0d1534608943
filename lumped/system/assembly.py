"""Assembly of the stiffness and mass matrices of a mechanism from models of its bodies.

The models are dense, sparse or reduced. A node is a rigid body, or one interface of a deformable
body. The first unknowns of a system describe all motions of its nodes that the joints allow
(`lumped.system.motions`). The remaining unknowns are the internal ones of the bodies in body axes,
whose matrices are assembled once. For each posture only the rows and columns of the interfaces are
rotated, for many postures together.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag as dense_block_diag
from scipy.sparse import block_array, block_diag, csr_array, issparse

from lumped.arrays import Array, SparseMatrix
from lumped.mechanism.body import Rigid
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.free_twists import drive_in
from lumped.mechanism.joint import Joint
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.screws import shift, turn
from lumped.system.joint_motion import Portion, UnevenError, elastic_wrenches
from lumped.system.motions import (
    Frames,
    Motions,
    Structure,
    drive_stiffnesses,
    frames_of,
    motions,
    structure_of,
)


@dataclass(frozen=True, eq=False)
class System:
    """Stiffness and mass matrices (n×n, SI, dense or sparse) of a mechanism in one posture.

    The first unknowns are those of the nodes (`motions`), the remaining ones are internal to the
    bodies. `models` are the models of the deformable bodies, by name. `tool` (6×n) maps the
    unknowns to the twist of the loaded point in base axes. `ends` contains, by body, the matrix (6m
    × unknowns of the nodes) that maps the unknowns of the nodes to the twists of the body's m
    interfaces in body axes. `inside` contains, by body, the slice of the body's internal unknowns.
    """

    name: str
    posture: Posture
    models: Mapping[str, BodyModel]
    motions: Motions
    stiffness: Array | SparseMatrix
    mass: Array | SparseMatrix
    tool: Array
    ends: Mapping[str, Array]
    inside: Mapping[str, slice]

    @property
    def size(self) -> int:
        """Number n of unknowns of the system."""
        return int(self.stiffness.shape[0])

    @property
    def outer(self) -> int:
        """Number of unknowns of the nodes. They precede the internal unknowns of the bodies."""
        return int(self.motions.twists.shape[2])

    def body_unknowns(self, body: str, unknowns: Array) -> Array:
        """Unknowns of the model of `body` (body axes) for `unknowns` of the system (n or n×m)."""
        ends = self.ends[body] @ unknowns[: self.outer]
        return np.concatenate([ends, unknowns[self.inside[body]]])

    def wrenches(self, joint: Joint, unknowns: Array) -> Array:
        """Wrenches (6×m) transmitted by an elastic joint, for `unknowns` of the system (n×m).

        They act at the first interface of the joint and are expressed in the axes of
        `Joint.compliance`, which rotate with the first body.
        """
        frames = frames_of([self.posture])
        position = frames.interface(joint.first.body, joint.first.point)[0]
        first, second = (
            self.motions.at(side.body, side.point, position) for side in (joint.first, joint.second)
        )
        rotations = [frames.since_reference(side.body)[0] for side in (joint.first, joint.second)]
        joint_here = replace(joint, drive=drive_in(self.posture, joint))
        relative = (second - first) @ unknowns[: self.outer]
        return elastic_wrenches(joint_here, rotations[0], rotations[1], relative)


@dataclass(frozen=True, eq=False)
class NodeMatrices:
    """Matrices for the n unknowns of the nodes in P postures. No other matrices depend on posture.

    `stiffness` and `mass` are P×n×n. `ends` (P×6m×n, by body) and `tool` (P×6×n) map the unknowns
    of the nodes to the twists of a body's m interfaces and of the loaded point, as in `System`.
    """

    motions: Motions
    stiffness: Array
    mass: Array
    ends: Mapping[str, Array]
    tool: Array


@dataclass(frozen=True, eq=False)
class Assembly:
    """A mechanism with models of its bodies, from which its system in any posture is assembled.

    `models` are the models of deformable bodies, by name. Bodies without a model are rigid. They
    are massless unless their shape is `Rigid`, which has a mass.
    """

    mechanism: Mechanism
    models: Mapping[str, BodyModel]
    structure: Structure

    @cached_property
    def _sparse(self) -> bool:
        return any(issparse(model.stiffness) for model in self.models.values())

    @cached_property
    def _inner(self) -> tuple[Array | SparseMatrix, Array | SparseMatrix]:
        """Block-diagonal stiffness and mass matrices of the internal unknowns of all bodies."""
        blocks = [
            [_split(model, matrix)[2] for model in self.models.values()]
            for matrix in ("stiffness", "mass")
        ]
        if self._sparse:
            stiffness, mass = (block_diag(matrices, format="csr") for matrices in blocks)
        else:
            stiffness, mass = (dense_block_diag(np.zeros((0, 0)), *matrices) for matrices in blocks)
        return stiffness, mass

    @cached_property
    def _split_models(self) -> Mapping[str, tuple[tuple[Array, Array | SparseMatrix], ...]]:
        """Two blocks of the stiffness, and two blocks of the mass, of each body, by name.

        The first block is that of the interfaces. The second block couples them to the internal
        unknowns.
        """
        return {
            name: (_split(model, "stiffness")[:2], _split(model, "mass")[:2])
            for name, model in self.models.items()
        }

    def node_matrices(self, postures: Sequence[Posture]) -> NodeMatrices:
        """Matrices for the unknowns of the nodes in P postures.

        Raises UnevenError if the postures differ in the number of unknowns.
        """
        frames = frames_of(postures)
        node_motions = motions(self.structure, frames)
        ends = {name: _ends(node_motions, frames, name) for name in self.models}
        tool = self.mechanism.tool
        position = frames.interface(tool.body, tool.point)
        tool_twists = node_motions.at(tool.body, tool.point, position)
        stiffness, mass = self._stiffness_and_mass(node_motions, frames, ends, tool_twists)
        return NodeMatrices(node_motions, stiffness, mass, ends, tool_twists)

    def at(self, posture: Posture) -> System:
        """Stiffness and mass of the mechanism in one posture."""
        (system,) = self.along([posture])
        return system

    def along(self, postures: Sequence[Posture]) -> Iterator[System]:
        """Yield the system of the mechanism in each posture."""
        try:
            nodes = self.node_matrices(postures)
        except UnevenError:
            yield from map(self.at, postures)
            return
        outer = size = nodes.tool.shape[2]
        inside = {}
        for name, model in self.models.items():
            inside[name] = slice(size, size + model.size - nodes.ends[name].shape[1])
            size = inside[name].stop
        for number, posture in enumerate(postures):
            ends = {name: rows[number] for name, rows in nodes.ends.items()}
            tool = np.zeros((6, size))
            tool[:, :outer] = nodes.tool[number]
            matrices = nodes.stiffness[number], nodes.mass[number]
            stiffness, mass = (
                self._bordered(matrix, kind, ends) for kind, matrix in enumerate(matrices)
            )
            yield System(
                name=_name(posture),
                posture=posture,
                models=self.models,
                motions=nodes.motions.of_posture(number),
                stiffness=stiffness,
                mass=mass,
                tool=tool,
                ends=ends,
                inside=inside,
            )

    def _stiffness_and_mass(
        self, node_motions: Motions, frames: Frames, ends: Mapping[str, Array], tool: Array
    ) -> tuple[Array, Array]:
        """Stiffness and mass matrices (P×n×n) for the n unknowns of the nodes in P postures.

        `ends` and `tool` map these unknowns to twists, as in `NodeMatrices`.
        """
        shape = (len(tool), tool.shape[2], tool.shape[2])
        stiffness, mass = np.zeros(shape), np.zeros(shape)
        for name, ((body_stiffness, _), (body_mass, _)) in self._split_models.items():
            _add(stiffness, ends[name], body_stiffness)
            _add(mass, ends[name], body_mass)
        for rows in node_motions.springs.values():
            _add(stiffness, rows, None)
        for joint in self.mechanism.joints:
            drive = joint.drive
            springs = drive_stiffnesses(joint, frames)
            if drive is not None and springs is not None and drive.inertia:
                rows = node_motions.springs[Portion(joint.name, "drive")]
                _add(mass, np.sqrt(drive.inertia / springs)[..., None, None] * rows, None)
        for number, (name, point) in enumerate(self.structure.nodes):
            body_shape = self.mechanism.bodies[name].shape
            if (
                not point
                and isinstance(body_shape, Rigid)
                and (body_mass_at_origin := rigid_mass(body_shape)).any()
            ):
                axes = np.swapaxes(turn(frames.rotations[name]), -1, -2)
                _add(mass, axes @ node_motions.twists[:, number], body_mass_at_origin)
        if self.mechanism.tool.mass:
            _add(mass, np.sqrt(self.mechanism.tool.mass) * tool[:, :3], None)
        return stiffness, mass

    def _bordered(self, outer: Array, kind: int, ends: Mapping[str, Array]) -> Array | SparseMatrix:
        """Full stiffness or mass matrix of a system, from the block `outer` of the nodes.

        The block of the internal unknowns, and the blocks that couple them to the nodes, are added.
        `kind` is 0 for the stiffness, 1 for the mass. `ends` maps the unknowns of the nodes to the
        twists of a body's interfaces, as in `System`.
        """
        couplings = [(ends[name].T, blocks[kind][1]) for name, blocks in self._split_models.items()]
        inner = self._inner[kind]
        if not self._sparse:
            border = np.hstack([np.zeros((len(outer), 0)), *(a @ b for a, b in couplings)])
            return np.block([[outer, border], [border.T, inner]])
        borders = csr_array(block_array([[csr_array(a) @ csr_array(b) for a, b in couplings]]))
        return csr_array(block_array([[csr_array(outer), borders], [borders.T, inner]]))


def assembly(mechanism: Mechanism, models: Mapping[str, BodyModel]) -> Assembly:
    """Assembly of a mechanism with `models` of its deformable bodies, by body name."""
    return Assembly(mechanism, models, structure_of(mechanism, frozenset(models)))


def assemble(posture: Posture, models: Mapping[str, BodyModel]) -> System:
    """System of a mechanism in one posture. Bodies without an entry in `models` are rigid."""
    return assembly(posture.mechanism, models).at(posture)


def _name(posture: Posture) -> str:
    pose = shown_pose(posture.mechanism, posture.pose)
    return f"{posture.mechanism.name} at {pose}" if pose else posture.mechanism.name


def _add(total: Array, rows: Array, matrix: Array | None) -> None:
    """Add RᵀMR to `total` (P×n×n), with the `rows` R (P×k×n) and a symmetric `matrix` M.

    If `matrix` is None, M is the identity. Columns of R that are zero are omitted from the product,
    because most bodies depend on few unknowns.
    """
    used = np.flatnonzero(np.any(rows, axis=(0, 1)))
    used_rows = rows[..., used]
    block = np.swapaxes(used_rows, -1, -2) @ (used_rows if matrix is None else matrix @ used_rows)
    total[:, used[:, None], used] += 0.5 * (block + np.swapaxes(block, -1, -2))


def _split(model: BodyModel, matrix: str) -> tuple[Array, Array | SparseMatrix, SparseMatrix]:
    """Three blocks of a `matrix` ("stiffness" or "mass") of a body.

    They are the block of the interfaces, the block that couples them to the internal unknowns, and
    the block of the internal unknowns.
    """
    full = getattr(model, matrix)
    count = 6 * len(model.interfaces)
    if not issparse(full):
        return full[:count, :count], full[:count, count:], full[count:, count:]
    full_rows = csr_array(full)
    return full_rows[:count, :count].toarray(), full_rows[:count, count:], full_rows[count:, count:]


def _ends(node_motions: Motions, frames: Frames, body: str) -> Array:
    """Matrices (P×6m×n) that map the n unknowns of the nodes to twists of a body's m interfaces.

    There is one matrix for each of P postures. The twists are in body axes.
    """
    interfaces = frames.mechanism.bodies[body].interfaces
    first = node_motions.structure.node(body, next(iter(interfaces)))
    twists = node_motions.twists[:, first : first + len(interfaces)]
    count, size = twists.shape[0], twists.shape[-1]
    axes = np.swapaxes(frames.rotations[body], -1, -2)[:, None]
    body_twists: Array = axes @ twists.reshape(count, -1, 3, size)
    return body_twists.reshape(count, -1, size)


def rigid_mass(shape: Rigid) -> Array:
    """6×6 mass matrix (SI, body axes) of a rigid body, referred to the origin of its axes."""
    to_centre = shift(shape.centre)
    at_centre = np.zeros((6, 6))
    at_centre[:3, :3] = shape.mass * np.eye(3)
    at_centre[3:, 3:] = shape.inertia
    mass: Array = to_centre.T @ at_centre @ to_centre
    return mass
