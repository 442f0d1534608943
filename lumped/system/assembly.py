"""Assembly of any mechanism from any models of its bodies: dense, sparse or reduced.

Unknowns of a system: those of its nodes under the constraints of the joints
(`lumped.system.motions`), then the internal unknowns of the bodies in body axes. The matrices of
the internal unknowns are assembled once. For each posture the interfaces' rows and columns of every
body are rotated, for many postures together.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag as dense_block_diag
from scipy.sparse import block_array, block_diag, csr_array, issparse

from lumped.arrays import Array, SparseMatrix
from lumped.mechanism.body import Rigid
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.joint import Joint
from lumped.mechanism.kinematics.postures import shown_pose
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.screws import shift, turn
from lumped.system.joint_motion import Portion, UnevenError, elastic_wrenches
from lumped.system.motions import Frames, Motions, Structure, frames_of, motions, structure_of


@dataclass(frozen=True, eq=False)
class System:
    """Stiffness and mass (n×n, SI, dense or sparse) of a mechanism in one posture.

    The first unknowns are those of `motions`, the others those inside the bodies. `tool` (6×n)
    gives the twist of the loaded point in base axes, `ends` the twists of a body's interfaces in
    body axes from the first unknowns, `inside` the slice of the body's internal unknowns.
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
        """Number of unknowns n."""
        return int(self.stiffness.shape[0])

    @property
    def outer(self) -> int:
        """Number of unknowns of the nodes, which come first."""
        return int(self.motions.twists.shape[2])

    def body_unknowns(self, body: str, unknowns: Array) -> Array:
        """Unknowns of the model of `body` (body axes) from those of the system (n or n×m)."""
        ends = self.ends[body] @ unknowns[: self.outer]
        return np.concatenate([ends, unknowns[self.inside[body]]])

    def wrenches(self, joint: Joint, unknowns: Array) -> Array:
        """Wrenches (6×m) in an elastic joint, from unknowns of the system (n×m).

        At its first interface, in the axes of its compliance.
        """
        frames = frames_of([self.posture])
        position = frames.interface(joint.first.body, joint.first.point)[0]
        first, second = (
            self.motions.at(side.body, side.point, position) for side in (joint.first, joint.second)
        )
        rotations = [frames.since_reference(side.body)[0] for side in (joint.first, joint.second)]
        return elastic_wrenches(
            joint, rotations[0], rotations[1], (second - first) @ unknowns[: self.outer]
        )


@dataclass(frozen=True, eq=False)
class NodeMatrices:
    """Matrices on the nodes' n unknowns in P postures: all that depends on the posture.

    `stiffness`, `mass` (P×n×n) of the nodes alone, `ends` (P×6m×n) and `tool` (P×6×n) as in
    `System`.
    """

    motions: Motions
    stiffness: Array
    mass: Array
    ends: Mapping[str, Array]
    tool: Array


@dataclass(frozen=True, eq=False)
class Assembly:
    """A mechanism with models of its bodies, for assembly in any posture.

    Bodies without a model are rigid. They have the mass of a `Rigid` shape, and no mass if their
    shape is another one.
    """

    mechanism: Mechanism
    models: Mapping[str, BodyModel]
    structure: Structure

    @cached_property
    def _sparse(self) -> bool:
        return any(issparse(model.stiffness) for model in self.models.values())

    @cached_property
    def _inner(self) -> tuple[Array | SparseMatrix, Array | SparseMatrix]:
        """Stiffness and mass of the internal unknowns, body by body."""
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
        """Blocks of stiffness and mass by body: interfaces, and their coupling to the inside."""
        return {
            name: (_split(model, "stiffness")[:2], _split(model, "mass")[:2])
            for name, model in self.models.items()
        }

    def node_matrices(self, postures: Sequence[Posture]) -> NodeMatrices:
        """Matrices of P postures. Raises UnevenError if their numbers of unknowns differ."""
        frames = frames_of(postures)
        node_motions = motions(self.structure, frames)
        ends = {name: _ends(node_motions, frames, name) for name in self.models}
        tool = self.mechanism.tool
        position = frames.interface(tool.body, tool.point)
        tool_twists = node_motions.at(tool.body, tool.point, position)
        stiffness, mass = self._stiffness_and_mass(node_motions, frames, ends, tool_twists)
        return NodeMatrices(node_motions, stiffness, mass, ends, tool_twists)

    def at(self, posture: Posture) -> System:
        """System in one posture."""
        (system,) = self.along([posture])
        return system

    def along(self, postures: Sequence[Posture]) -> Iterator[System]:
        """Yield the system in each posture."""
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
        """Stiffness and mass (P×n×n) on the nodes' unknowns alone; `tool` as in `System`."""
        shape = (len(tool), tool.shape[2], tool.shape[2])
        stiffness, mass = np.zeros(shape), np.zeros(shape)
        for name, ((body_stiffness, _), (body_mass, _)) in self._split_models.items():
            _add(stiffness, ends[name], body_stiffness)
            _add(mass, ends[name], body_mass)
        for rows in node_motions.springs.values():
            _add(stiffness, rows, None)
        for joint in self.mechanism.joints:
            drive = joint.drive
            if drive is not None and drive.stiffness is not None and drive.inertia:
                rows = node_motions.springs[Portion(joint.name, "drive")]
                _add(mass, np.sqrt(drive.inertia / drive.stiffness) * rows, None)
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
        """Matrix of the nodes bordered by coupling and inner blocks, `kind` 0 stiffness, 1 mass."""
        couplings = [(ends[name].T, blocks[kind][1]) for name, blocks in self._split_models.items()]
        inner = self._inner[kind]
        if not self._sparse:
            border = np.hstack([np.zeros((len(outer), 0)), *(a @ b for a, b in couplings)])
            return np.block([[outer, border], [border.T, inner]])
        borders = csr_array(block_array([[csr_array(a) @ csr_array(b) for a, b in couplings]]))
        return csr_array(block_array([[csr_array(outer), borders], [borders.T, inner]]))


def assembly(mechanism: Mechanism, models: Mapping[str, BodyModel]) -> Assembly:
    """Assembly of a mechanism; `models` by name of the body."""
    return Assembly(mechanism, models, structure_of(mechanism, frozenset(models)))


def assemble(posture: Posture, models: Mapping[str, BodyModel]) -> System:
    """System of a mechanism in one posture; `models` by name of the body, the others are rigid."""
    return assembly(posture.mechanism, models).at(posture)


def _name(posture: Posture) -> str:
    pose = shown_pose(posture.mechanism, posture.pose)
    return f"{posture.mechanism.name} at {pose}" if pose else posture.mechanism.name


def _add(total: Array, rows: Array, matrix: Array | None) -> None:
    """Add the symmetric RᵀMR (M the identity if None) to `total` (P×n×n) for rows R (P×k×n).

    Most bodies depend on few unknowns, so columns of zeros are omitted.
    """
    used = np.flatnonzero(np.any(rows, axis=(0, 1)))
    used_rows = rows[..., used]
    block = np.swapaxes(used_rows, -1, -2) @ (used_rows if matrix is None else matrix @ used_rows)
    total[:, used[:, None], used] += 0.5 * (block + np.swapaxes(block, -1, -2))


def _split(model: BodyModel, matrix: str) -> tuple[Array, Array | SparseMatrix, SparseMatrix]:
    """Blocks of the stiffness or mass: interfaces, their coupling to the inside, the inside."""
    full = getattr(model, matrix)
    count = 6 * len(model.interfaces)
    if not issparse(full):
        return full[:count, :count], full[:count, count:], full[count:, count:]
    full_rows = csr_array(full)
    return full_rows[:count, :count].toarray(), full_rows[:count, count:], full_rows[count:, count:]


def _ends(node_motions: Motions, frames: Frames, body: str) -> Array:
    """Twists (P×6m×n) of the interfaces of a deformable body, in body axes."""
    interfaces = frames.mechanism.bodies[body].interfaces
    first = node_motions.structure.node(body, next(iter(interfaces)))
    twists = node_motions.twists[:, first : first + len(interfaces)]
    count, size = twists.shape[0], twists.shape[-1]
    axes = np.swapaxes(frames.rotations[body], -1, -2)[:, None]
    body_twists: Array = axes @ twists.reshape(count, -1, 3, size)
    return body_twists.reshape(count, -1, size)


def rigid_mass(shape: Rigid) -> Array:
    """6×6 mass at the origin of the body's axes."""
    to_centre = shift(shape.centre)
    at_centre = np.zeros((6, 6))
    at_centre[:3, :3] = shape.mass * np.eye(3)
    at_centre[3:, 3:] = shape.inertia
    mass: Array = to_centre.T @ at_centre @ to_centre
    return mass
