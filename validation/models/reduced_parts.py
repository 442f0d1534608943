"""Bodies that are CAD parts as solids: condensed on their interfaces, or with modes of their own.

Meshed, factorised and reduced once, kept on the disk and in memory (validation.run.cache).
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
import scipy
from scipy.linalg import eigh
from scipy.sparse import csr_array

from fem.bodies.part import grips_of, held_part, meshed_part, require_memory
from fem.reduction.craig_bampton import Reduction, heavier_at_interfaces, reduction
from fem.reduction.free_interface import FreeTruncation, free_interface
from fem.reduction.held import held_body
from lumped.arrays import Array, SparseMatrix, dense
from lumped.errors import ComputationError, InputError
from lumped.mechanism.body import Body, Frame, Part
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.mechanism import Mechanism
from lumped.mechanism.placing import leg_frame
from lumped.memo import memo
from lumped.text import counted
from meshes.part.boundary import PartMesh
from meshes.part.interfaces import Interface, find_interfaces
from meshes.part.reading.read import PartFile
from validation.models.options import ReductionBy
from validation.parts import identify
from validation.parts.identify import Identified, more_unknowns
from validation.parts.meshes import COARSE, FINEST, mesh_entries, part_file, part_key, part_mesh
from validation.run.cache import Arrays, CacheEntry, require_shape

# Unknowns of the finest of the three meshes on which a robot's part is identified and reduced, if
# no others are wanted.
UNKNOWNS = 60_000
_MODES = 6
# Nodes that a displacement between them is taken from; nearer than this share of the part a point
# is a node.
_NEIGHBOURS, _AT_NODE = 16, 1e-9
# Eigenvalues of a reduction are those of its modes to rounding: what is farther off is no such one.
_SAME_MODE = 1e-6

Hold: TypeAlias = Literal["rigid", "average"]


@dataclass(frozen=True, eq=False)
class ReducedPart(BodyModel):
    """A part reduced for frequencies up to `highest` (Hz), by Craig and Bampton.

    With its interfaces held `counted` modes lie below `cutoff` (Hz), by inertia, and all are kept;
    `truncated` W (6m×6m) is what bounds the error (fem.reduction.craig_bampton). By MacNeal and
    Rubin cut-off and count are those of the free part's elastic modes, and `free` is its bound.
    """

    highest: float = field(kw_only=True)
    cutoff: float = field(kw_only=True)
    counted: int = field(kw_only=True)
    truncated: Array = field(kw_only=True)
    free: FreeTruncation | None = field(kw_only=True, default=None)

    @property
    def kept(self) -> int:
        """How many modes below the cut-off, held or free, its matrices have."""
        if self.free is None:
            return _below(np.diag(self.stiffness)[len(self.truncated) :], self.cutoff)
        squared = eigh(dense(self.stiffness), dense(self.mass), eigvals_only=True)[6:]
        known = self.free.squared[6 : -len(self.truncated)]
        found = squared[: len(known)]
        return _below(found[np.abs(found / known - 1.0) < _SAME_MODE], self.cutoff)

    def loosened(self, squared: float) -> tuple[Array, Array]:
        """As `fem.reduction.craig_bampton.Truncated` wants it."""
        if self.free is None:
            return heavier_at_interfaces(self.truncated, self.cutoff, self.size, squared)
        stiffness, mass = self.free.loosened(squared)
        return np.asarray(stiffness - self.stiffness), np.asarray(mass - self.mass)


def _below(squared: Array, cutoff: float) -> int:
    return int((squared < (2.0 * np.pi * cutoff) ** 2).sum())


@memo(16)
def _read(path: Path, unit: str | None, _written: tuple[int, int] | None) -> PartFile:
    return part_file(path, unit)


def _written(path: Path) -> tuple[int, int] | None:
    """Size and time of a file: one that was written again in the meantime is read again."""
    try:
        found = path.stat()
    except (OSError, ValueError):
        return None
    return found.st_size, found.st_mtime_ns


def shape_of(body: Body) -> Part:
    """The part that a body is; raises InputError for a body that is none."""
    if not isinstance(body.shape, Part):
        raise InputError(f"bodies.{body.name}: is not a part from a file")
    return body.shape


def is_held_as_said(body: Body) -> bool:
    """Whether the robot file says of every interface how its faces are held."""
    return all(interface.coupling for interface in shape_of(body).interfaces.values())


def is_leg(body: Body) -> bool:
    """Whether a part is a leg: between two interfaces."""
    return len(body.interfaces) == 2


def leg_axes(body: Body) -> Frame:
    """Axes of a part of two interfaces as a leg, in those of the body."""
    start, end = (frame.position for frame in body.interfaces.values())
    return leg_frame(start, end)


def found_in(body: Body) -> tuple[PartFile, tuple[Interface, ...]]:
    """The file of a part and its interfaces at the points of the robot.

    Raises InputError where the file cannot be read or has no faces where the joints are.
    """
    shape = shape_of(body)
    try:
        file = _read(shape.file, shape.unit, _written(shape.file))
        points = {name: frame.position for name, frame in body.interfaces.items()}
        return file, find_interfaces(file, shape.interfaces, points)
    except InputError as error:
        raise InputError(f"bodies.{body.name}: {fault}" for fault in error.faults) from error


def unknowns_of(body: Body) -> int:
    """Unknowns of the finest of the three meshes of a part."""
    return shape_of(body).unknowns or UNKNOWNS


def with_unknowns(mechanism: Mechanism, unknowns: Mapping[str, int]) -> Mechanism:
    """The mechanism with so many unknowns in the finest meshes of these parts."""
    parts = mechanism.parts
    finer = {
        name: replace(parts[name], shape=replace(shape_of(parts[name]), unknowns=count))
        for name, count in unknowns.items()
    }
    return replace(mechanism, bodies={**mechanism.bodies, **finer})


def with_finer_parts(mechanism: Mechanism, factor: float) -> Mechanism:
    """The mechanism with meshes of its parts that leave so many times less open.

    Raises InputError where one is a mesh, which has no finer one, and ComputationError where there
    is not memory enough.
    """
    finer = {}
    for name, body in mechanism.parts.items():
        if found_in(body)[0].mesh is not None:
            raise InputError(f"bodies.{name}: a mesh that is given has no finer one")
        finer[name] = more_unknowns(unknowns_of(body), factor)
        require_memory(finer[name], name)
    return with_unknowns(mechanism, finer)


def identified(body: Body, unknowns: int | None = None, modes: int = _MODES) -> Identified:
    """The part by its interfaces, in body axes, with its uncertainties."""
    return identified_entry(body, unknowns, modes).value()


def identified_entry(
    body: Body, unknowns: int | None = None, modes: int = _MODES
) -> CacheEntry[Identified]:
    """Cache entry of what `identified` returns."""
    file, interfaces = found_in(body)
    material = shape_of(body).material
    return identify.identified_entry(
        file, interfaces, material, unknowns or unknowns_of(body), modes
    )


def coarsest_mesh(body: Body) -> PartMesh:
    """The coarsest of the part's meshes, body axes, or the one that is given: enough to draw it."""
    file, interfaces = found_in(body)
    return part_mesh(file, interfaces, unknowns_of(body), COARSE)


def condensed(body: Body) -> BodyModel:
    """The part by the twists of its interfaces alone: exact in statics, mass by Guyan (1965)."""
    found = identified(body)
    moved = interpolated(found.places, found.shapes)
    return BodyModel("condensed", tuple(body.interfaces), found.stiffness, found.mass, moved)


def reduced(
    body: Body,
    highest: float,
    cutoff: float,
    level: int = FINEST,
    hold: Hold = "rigid",
    by: ReductionBy = "fixed",
) -> ReducedPart:
    """One of the part's meshes, reduced for frequencies up to `highest` (Hz).

    `hold`: how interfaces are held of which the robot file does not say it; `by` its modes with
    interfaces fixed or free. Raises ComputationError where it has not the modes that were counted.
    """
    part = reduced_entry(body, highest, cutoff, level, hold, by).value()
    if part.kept != part.counted:
        raise ComputationError(
            f"{body.name}, reduced: {counted(part.counted, 'mode was', 'modes were')} counted "
            f"below {part.cutoff:.6g} Hz, its reduction has {part.kept}"
        )
    return part


def reduced_entry(
    body: Body,
    highest: float,
    cutoff: float,
    level: int = FINEST,
    hold: Hold = "rigid",
    by: ReductionBy = "fixed",
) -> CacheEntry[ReducedPart]:
    """Cache entry of what `reduced` returns."""
    file, known = found_in(body)
    shape, unknowns = shape_of(body), unknowns_of(body)
    if file.mesh is not None:
        # A mesh is on one level alone: it is not reduced anew for the others.
        level = FINEST
    interfaces = tuple(
        one if shape.interfaces[one.name].coupling else replace(one, coupling=hold) for one in known
    )

    def compute() -> dict[str, Any]:
        mesh = part_mesh(file, known, unknowns, level)
        meshed = meshed_part(mesh, shape.material)
        rooted = held_part(meshed, grips_of(mesh, interfaces), body.name)
        dropped: dict[str, Array] = {}
        found: Reduction
        if by == "free":
            found, truncation = free_interface(rooted, highest, cutoff)
            dropped = {"squared": truncation.squared, "shares": truncation.shares}
        else:
            found = reduction(held_body(rooted), highest, cutoff)
        return dropped | {
            "stiffness": found.stiffness,
            "mass": found.mass,
            "nodes": mesh.nodes,
            "recovery": rooted.solid.transformation @ found.recovery,
            "cutoff": found.cutoff,
            "counted": found.counted,
            "truncated": found.truncated,
        }

    key = part_key(
        file, interfaces, shape.material, "reduced", unknowns, level, highest, cutoff, by
    )

    def read(found: Arrays) -> ReducedPart:
        n = len(found["stiffness"])
        square = {"stiffness": (n, n), "mass": (n, n)}
        require_shape(found, **square, nodes=(None, 3), recovery=(3 * len(found["nodes"]), n))
        cutoff, truncated = float(found["cutoff"]), found["truncated"]
        free = None
        if by == "free":
            free = FreeTruncation(cutoff, found["squared"], found["shares"], truncated)
        return ReducedPart(
            "solid, reduced",
            tuple(body.interfaces),
            found["stiffness"],
            found["mass"],
            interpolated(found["nodes"], found["recovery"]),
            highest=highest,
            cutoff=cutoff,
            counted=int(found["counted"]),
            truncated=truncated,
            free=free,
        )

    return CacheEntry(key, compute, read, mesh_entries(file, known, unknowns, [level]))


def interpolated(nodes: Array, recovery: Array) -> Callable[[Array], SparseMatrix]:
    """Displacements at any points, from the recovery (3N×n) of those at `nodes` (N×3).

    At a node its own, elsewhere the mean of the nearest whose weights give linear fields exactly.
    """
    fields = recovery.reshape(len(nodes), -1)
    size = float(np.ptp(nodes, axis=0).max())

    def displacements(points: Array) -> SparseMatrix:
        count = min(_NEIGHBOURS, len(nodes))
        away, nearest = scipy.spatial.cKDTree(nodes).query(points, k=np.arange(1, count + 1))
        weights = np.eye(1, count).repeat(len(points), axis=0)
        between = away[:, 0] > _AT_NODE * size
        arms = (nodes[nearest] - points[:, None])[between] / away[between, -1][:, None, None]
        linear = np.concatenate([np.ones((*arms.shape[:2], 1)), arms], axis=2)
        # Least Σ w²|arm|² with Σ w = 1 and Σ w·arm = 0.
        scaled = linear / np.linalg.norm(arms, axis=2, keepdims=True)
        inverse = np.linalg.pinv(np.swapaxes(scaled, 1, 2), rcond=1e-6)
        weights[between] = inverse[..., 0] / np.linalg.norm(arms, axis=2)
        rows = np.repeat(np.arange(len(points)), count)
        shape = (len(points), len(nodes))
        mean = csr_array((weights.ravel(), (rows, nearest.ravel())), shape=shape)
        return csr_array((mean @ fields).reshape(3 * len(points), -1))

    return displacements
