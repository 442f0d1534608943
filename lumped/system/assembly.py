"""One assembler for any mechanism and any models of its bodies: dense, sparse or reduced.

Unknowns of a system: those of its nodes as the joints leave them (`lumped.system.motions`), then
what is inside the bodies, which stays in body axes. What does not turn from posture to posture is
put together once; a posture turns the interfaces' rows and columns of every body, those of many
postures together.
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
from lumped.system.joint_motion import Portion, UnevenError, carried
from lumped.system.motions import Frames, Motions, Structure, frames_of, motions, structure_of


@dataclass(frozen=True, eq=False)
class System:
    """Stiffness and mass (n×n, SI, dense or sparse) of a mechanism in one posture.

    The first unknowns are those of `motions`, the rest those inside the bodies. `tool` (6×n) gives
    the twist of the loaded point in base axes; `ends` the twists of a body's interfaces in body
    axes from the first unknowns, `inside` where the body's other unknowns are.
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
        """How many of the unknowns belong to nodes: they come first."""
        return int(self.motions.twists.shape[2])

    def own(self, body: str, unknowns: Array) -> Array:
        """Unknowns of the model of `body` (body axes) from those of the system (n or n×m)."""
        ends = self.ends[body] @ unknowns[: self.outer]
        return np.concatenate([ends, unknowns[self.inside[body]]])

    def wrenches(self, joint: Joint, unknowns: Array) -> Array:
        """Wrenches (6×m) that an elastic joint carries, from unknowns of the system (n×m).

        At its first interface, in the axes of its compliance.
        """
        frames = frames_of([self.posture])
        place = frames.interface(joint.first.body, joint.first.point)[0]
        first, second = (
            self.motions.at(side.body, side.point, place) for side in (joint.first, joint.second)
        )
        turned = [frames.since_reference(side.body)[0] for side in (joint.first, joint.second)]
        return carried(joint, turned[0], turned[1], (second - first) @ unknowns[: self.outer])


@dataclass(frozen=True, eq=False)
class Outside:
    """What P postures say of the nodes' n unknowns: all that changes from one to the next.

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
    """A mechanism with models of its bodies, ready for any of its postures.

    Bodies without a model are rigid; they have the mass that their shape gives a rigid body, and
    none where it is another shape.
    """

    mechanism: Mechanism
    models: Mapping[str, BodyModel]
    structure: Structure

    @cached_property
    def _sparse(self) -> bool:
        return any(issparse(model.stiffness) for model in self.models.values())

    @cached_property
    def _inner(self) -> tuple[Array | SparseMatrix, Array | SparseMatrix]:
        """Stiffness and mass inside the bodies, body after body."""
        blocks = [
            [_split(model, matrix)[2] for model in self.models.values()]
            for matrix in ("stiffness", "mass")
        ]
        if self._sparse:
            stiffness, mass = (block_diag(of, format="csr") for of in blocks)
        else:
            stiffness, mass = (dense_block_diag(np.zeros((0, 0)), *of) for of in blocks)
        return stiffness, mass

    @cached_property
    def _split_models(self) -> Mapping[str, tuple[tuple[Array, Array | SparseMatrix], ...]]:
        """Per body, of stiffness and of mass: the interfaces' block, their coupling to the rest."""
        return {
            name: (_split(model, "stiffness")[:2], _split(model, "mass")[:2])
            for name, model in self.models.items()
        }

    def outside(self, postures: Sequence[Posture]) -> Outside:
        """What changes from posture to posture; raises UnevenError where numbers of unknowns do."""
        frames = frames_of(postures)
        moved = motions(self.structure, frames)
        ends = {name: _ends(moved, frames, name) for name in self.models}
        tool = self.mechanism.tool
        felt = moved.at(tool.body, tool.point, frames.interface(tool.body, tool.point))
        stiffness, mass = self._node_matrices(moved, frames, ends, felt)
        return Outside(moved, stiffness, mass, ends, felt)

    def at(self, posture: Posture) -> System:
        """The system in one posture."""
        (system,) = self.along([posture])
        return system

    def along(self, postures: Sequence[Posture]) -> Iterator[System]:
        """The system in each posture."""
        try:
            outside = self.outside(postures)
        except UnevenError:
            yield from map(self.at, postures)
            return
        outer = size = outside.tool.shape[2]
        inside = {}
        for name, model in self.models.items():
            inside[name] = slice(size, size + model.size - outside.ends[name].shape[1])
            size = inside[name].stop
        for number, posture in enumerate(postures):
            ends = {name: rows[number] for name, rows in outside.ends.items()}
            tool = np.zeros((6, size))
            tool[:, :outer] = outside.tool[number]
            matrices = outside.stiffness[number], outside.mass[number]
            stiffness, mass = (self._bordered(of, kind, ends) for kind, of in enumerate(matrices))
            yield System(
                name=_name(posture),
                posture=posture,
                models=self.models,
                motions=outside.motions.of(number),
                stiffness=stiffness,
                mass=mass,
                tool=tool,
                ends=ends,
                inside=inside,
            )

    def _node_matrices(
        self, moved: Motions, frames: Frames, ends: Mapping[str, Array], tool: Array
    ) -> tuple[Array, Array]:
        """Stiffness and mass (P×n×n) on the nodes' unknowns alone."""
        shape = (len(tool), tool.shape[2], tool.shape[2])
        stiffness, mass = np.zeros(shape), np.zeros(shape)
        for name, ((own_stiffness, _), (own_mass, _)) in self._split_models.items():
            _add(stiffness, ends[name], own_stiffness)
            _add(mass, ends[name], own_mass)
        for rows in moved.springs.values():
            _add(stiffness, rows, None)
        for joint in self.mechanism.joints:
            drive = joint.drive
            if drive is not None and drive.stiffness is not None and drive.inertia:
                rows = moved.springs[Portion(joint.name, "drive")]
                _add(mass, np.sqrt(drive.inertia / drive.stiffness) * rows, None)
        for number, (name, point) in enumerate(self.structure.nodes):
            shape_of = self.mechanism.bodies[name].shape
            if not point and isinstance(shape_of, Rigid) and (own := rigid_mass(shape_of)).any():
                axes = np.swapaxes(turn(frames.rotations[name]), -1, -2)
                _add(mass, axes @ moved.twists[:, number], own)
        if self.mechanism.tool.mass:
            _add(mass, np.sqrt(self.mechanism.tool.mass) * tool[:, :3], None)
        return stiffness, mass

    def _bordered(self, outer: Array, kind: int, ends: Mapping[str, Array]) -> Array | SparseMatrix:
        """The nodes' matrix, bordered by what couples it to the bodies' inside, in their order."""
        couplings = [(ends[name].T, of[kind][1]) for name, of in self._split_models.items()]
        inner = self._inner[kind]
        if not self._sparse:
            border = np.hstack([np.zeros((len(outer), 0)), *(a @ b for a, b in couplings)])
            return np.block([[outer, border], [border.T, inner]])
        borders = csr_array(block_array([[csr_array(a) @ csr_array(b) for a, b in couplings]]))
        return csr_array(block_array([[csr_array(outer), borders], [borders.T, inner]]))


def assembly(mechanism: Mechanism, models: Mapping[str, BodyModel]) -> Assembly:
    """A mechanism made ready for its postures; `models` by name of the body."""
    return Assembly(mechanism, models, structure_of(mechanism, frozenset(models)))


def assemble(posture: Posture, models: Mapping[str, BodyModel]) -> System:
    """The mechanism in one posture; `models` by name of the body, the others are rigid."""
    return assembly(posture.mechanism, models).at(posture)


def _name(posture: Posture) -> str:
    place = shown_pose(posture.mechanism, posture.pose)
    return f"{posture.mechanism.name} at {place}" if place else posture.mechanism.name


def _add(total: Array, rows: Array, matrix: Array | None) -> None:
    """Add RᵀMR (M the identity where None) to `total` (P×n×n) for rows R (P×k×n), symmetric.

    Most bodies hang on few of the unknowns: the others are left out.
    """
    used = np.flatnonzero(np.any(rows, axis=(0, 1)))
    own = rows[..., used]
    block = np.swapaxes(own, -1, -2) @ (own if matrix is None else matrix @ own)
    total[:, used[:, None], used] += 0.5 * (block + np.swapaxes(block, -1, -2))


def _split(model: BodyModel, matrix: str) -> tuple[Array, Array | SparseMatrix, SparseMatrix]:
    """Blocks of the stiffness or mass: interfaces, their coupling to the rest, the rest."""
    whole = getattr(model, matrix)
    count = 6 * len(model.interfaces)
    if not issparse(whole):
        return whole[:count, :count], whole[:count, count:], whole[count:, count:]
    rows = csr_array(whole)
    return rows[:count, :count].toarray(), rows[:count, count:], rows[count:, count:]


def _ends(moved: Motions, frames: Frames, body: str) -> Array:
    """Twists (P×6m×n) of the interfaces of a deformable body, in body axes."""
    interfaces = frames.mechanism.bodies[body].interfaces
    first = moved.structure.node(body, next(iter(interfaces)))
    twists = moved.twists[:, first : first + len(interfaces)]
    count, size = twists.shape[0], twists.shape[-1]
    axes = np.swapaxes(frames.rotations[body], -1, -2)[:, None]
    own: Array = axes @ twists.reshape(count, -1, 3, size)
    return own.reshape(count, -1, size)


def rigid_mass(shape: Rigid) -> Array:
    """6×6 mass at the origin of the body's axes."""
    to_centre = shift(shape.centre)
    at_centre = np.zeros((6, 6))
    at_centre[:3, :3] = shape.mass * np.eye(3)
    at_centre[3:, 3:] = shape.inertia
    mass: Array = to_centre.T @ at_centre @ to_centre
    return mass
