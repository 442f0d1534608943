"""CAD parts as solids: condensed to their interfaces, or reduced with modes.

Input: a body that is a CAD part, the mesh level, end conditions and a cut-off frequency. Output:
its model on the twists of its interfaces and modal coordinates. Rule: a part is meshed, factorised
and reduced once; the result is stored on disk and in memory (`validation.run.cache`). Modes are
counted by Sylvester's law of inertia; a reduction that lacks a counted mode is an error.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
import scipy
from scipy.linalg import eigh
from scipy.sparse import csr_array

from fem.bodies.part import (
    as_columns,
    from_columns,
    grips_of,
    held_part,
    meshed_part,
    require_memory,
    wrenches_of_faces,
)
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
from lumped.model_choices import ReductionBy
from lumped.text import counted
from meshes.part.boundary import PartMesh
from meshes.part.interfaces import Interface, find_interfaces
from meshes.part.reading.read import PartFile
from validation.parts import identify
from validation.parts.free_modes import FreePart, free_entry
from validation.parts.identify import Identified, more_unknowns
from validation.parts.meshes import COARSE, FINEST, mesh_entries, part_file, part_key, part_mesh
from validation.run.cache import Arrays, CacheEntry, require_shape

# Unknowns of the finest of the three meshes of a part, if the robot file does not specify them.
UNKNOWNS = 60_000
_MODES = 6
# Number of nodes from which the displacement of a point is interpolated, and the distance, over the
# size of the part, below which a point is at the node.
_NEIGHBOURS, _AT_NODE = 16, 1e-9
# Largest relative difference, due to round-off, between the eigenvalue of a reduction and that of
# its mode.
_SAME_MODE = 1e-6

Hold: TypeAlias = Literal["rigid", "average"]


@dataclass(frozen=True, eq=False)
class ReducedPart(BodyModel):
    """CAD part reduced by Craig and Bampton, accurate for frequencies up to `highest` (Hz).

    `counted`: number of modes with fixed interfaces below `cutoff` (Hz), by Sylvester's law of
    inertia; all are kept. `truncated` W (6m×6m, m interfaces): bound of the error due to higher
    modes (`fem.reduction.craig_bampton`). In a reduction by MacNeal and Rubin, cut-off and count
    are those of the elastic modes of the free part, and the bound is `free`, which is None
    otherwise.
    """

    highest: float = field(kw_only=True)
    cutoff: float = field(kw_only=True)
    counted: int = field(kw_only=True)
    truncated: Array = field(kw_only=True)
    free: FreeTruncation | None = field(kw_only=True, default=None)

    @property
    def kept(self) -> int:
        """Number of modes below the cut-off that the reduced matrices contain.

        They are modes with fixed interfaces or, if `free` is set, elastic modes of the free part.
        """
        if self.free is None:
            return _below(np.diag(self.stiffness)[len(self.truncated) :], self.cutoff)
        all_squares = eigh(dense(self.stiffness), dense(self.mass), eigvals_only=True)[6:]
        expected = self.free.squared[6 : -len(self.truncated)]
        squares = all_squares[: len(expected)]
        return _below(squares[np.abs(squares / expected - 1.0) < _SAME_MODE], self.cutoff)

    def loosened(self, squared: float) -> tuple[Array, Array]:
        """Changes of stiffness and mass (n×n) that bound the effect of omitted modes on frequency.

        `squared` is the square of an angular frequency (rad²/s²); see
        `fem.reduction.craig_bampton.Truncated`.
        """
        if self.free is None:
            return heavier_at_interfaces(self.truncated, self.cutoff, self.size, squared)
        stiffness, mass = self.free.loosened(squared)
        return np.asarray(stiffness - self.stiffness), np.asarray(mass - self.mass)


def _below(squared: Array, cutoff: float) -> int:
    return int((squared < (2.0 * np.pi * cutoff) ** 2).sum())


@memo(16)
def _read(path: Path, unit: str | None, _version: tuple[int, int] | None) -> PartFile:
    return part_file(path, unit)


def _version(path: Path) -> tuple[int, int] | None:
    """Size and modification time of a file, from which a change of the file is detected.

    None if the file cannot be read.
    """
    try:
        status = path.stat()
    except (OSError, ValueError):
        return None
    return status.st_size, status.st_mtime_ns


def shape_of(body: Body) -> Part:
    """CAD part of a body. Raises InputError if the body is not a CAD part."""
    if not isinstance(body.shape, Part):
        raise InputError(f"bodies.{body.name}: must be a part from a file (step or mesh)")
    return body.shape


def has_specified_couplings(body: Body) -> bool:
    """True if the robot file specifies the coupling of every interface of a CAD part."""
    return all(interface.coupling for interface in shape_of(body).interfaces.values())


def is_leg(body: Body) -> bool:
    """True if a CAD part has two interfaces, so that it can be modelled as a leg."""
    return len(body.interfaces) == 2


def leg_axes(body: Body) -> Frame:
    """Leg axes of a CAD part with two interfaces, in body axes."""
    start, end = (frame.position for frame in body.interfaces.values())
    return leg_frame(start, end)


def found_in(body: Body) -> tuple[PartFile, tuple[Interface, ...]]:
    """File of a CAD part, and its interfaces: the faces at the points of the robot's joints.

    Raises InputError if the file cannot be read or has no faces at the points of the joints.
    """
    shape = shape_of(body)
    version = _version(shape.file)
    try:
        file = _read(shape.file, shape.unit, version)
        points = {name: frame.position for name, frame in body.interfaces.items()}
        return file, find_interfaces(file, shape.interfaces, points)
    except InputError as error:
        raise InputError(f"bodies.{body.name}: {fault}" for fault in error.faults) from error


def unknowns_of(body: Body) -> int:
    """Unknowns of the finest of the three meshes of a CAD part."""
    return shape_of(body).unknowns or UNKNOWNS


def with_unknowns(mechanism: Mechanism, unknowns: Mapping[str, int]) -> Mechanism:
    """Mechanism whose CAD parts have finest meshes with `unknowns` unknowns, by body name."""
    parts = mechanism.parts
    finer = {
        name: replace(parts[name], shape=replace(shape_of(parts[name]), unknowns=count))
        for name, count in unknowns.items()
    }
    return replace(mechanism, bodies={**mechanism.bodies, **finer})


def with_finer_parts(mechanism: Mechanism, factor: float) -> Mechanism:
    """Mechanism with finer meshes of CAD parts: half-widths are divided by `factor`.

    Raises InputError if the file of a part is a mesh, which cannot be refined, and ComputationError
    if there is not enough memory.
    """
    finer = {}
    for name, body in mechanism.parts.items():
        if found_in(body)[0].mesh is not None:
            raise InputError(f"bodies.{name}: a mesh from a file cannot be refined")
        finer[name] = more_unknowns(unknowns_of(body), factor)
        require_memory(finer[name], name)
    return with_unknowns(mechanism, finer)


def identified(body: Body, unknowns: int | None = None, modes: int = _MODES) -> Identified:
    """Stiffness, compliance, mass and modes of a CAD part on its interfaces, with uncertainties.

    The matrices are in body axes. `unknowns`: number of unknowns of the finest mesh; if None, the
    number that the body specifies. `modes`: number of modes.
    """
    return identified_entry(body, unknowns, modes).value()


def identified_entry(
    body: Body, unknowns: int | None = None, modes: int = _MODES
) -> CacheEntry[Identified]:
    """Cache entry for the result of `identified`."""
    file, interfaces = found_in(body)
    material, unknowns = shape_of(body).material, unknowns or unknowns_of(body)
    return identify.identified_entry(file, interfaces, material, unknowns, modes)


def free_body_part(body: Body, unknowns: int | None = None, modes: int = _MODES) -> FreePart:
    """Frequencies of a CAD part without supports. Arguments as for `identified`."""
    file, _ = found_in(body)
    material, unknowns = shape_of(body).material, unknowns or unknowns_of(body)
    return free_entry(file, material, unknowns, modes).value()


def coarsest_mesh(body: Body) -> PartMesh:
    """Coarsest mesh of a CAD part, in body axes, which is sufficient for drawing."""
    file, interfaces = found_in(body)
    return part_mesh(file, interfaces, unknowns_of(body), COARSE)


def condensed(body: Body) -> BodyModel:
    """CAD part condensed to its interfaces: exact in statics, with the mass matrix of Guyan."""
    part = identified(body)
    displacements = interpolated(part.places, part.shapes)
    return BodyModel(
        "condensed",
        tuple(body.interfaces),
        part.stiffness,
        part.mass,
        displacements,
        unit_pressures=from_columns(part.pressed, part.pressures),
    )


def reduced(
    body: Body,
    highest: float,
    cutoff: float,
    level: int = FINEST,
    hold: Hold = "rigid",
    by: ReductionBy = "fixed",
) -> ReducedPart:
    """CAD part on one of its meshes, reduced for frequencies up to `highest` (Hz).

    Modes are kept up to `cutoff` (Hz). `level` is the number of the mesh, 0 for the coarsest.
    `hold`: coupling of the interfaces for which the robot file specifies none. `by`: "fixed" or
    "free" interfaces in the modes of the reduction. Raises ComputationError if the reduction does
    not contain all modes below its cut-off.
    """
    part = reduced_entry(body, highest, cutoff, level, hold, by).value()
    if part.kept != part.counted:
        raise ComputationError(
            f"{body.name}, reduced: {counted(part.counted, 'mode was', 'modes were')} "
            f"counted below {part.cutoff:.6g} Hz, but the reduction has {part.kept}; "
            "modes are missing"
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
    """Cache entry for the result of `reduced`."""
    file, found_interfaces = found_in(body)
    shape, unknowns = shape_of(body), unknowns_of(body)
    if file.mesh is not None:
        # A part given as a mesh has only one level.
        level = FINEST
    interfaces = tuple(
        interface
        if shape.interfaces[interface.name].coupling
        else replace(interface, coupling=hold)
        for interface in found_interfaces
    )

    def compute() -> dict[str, Any]:
        mesh = part_mesh(file, found_interfaces, unknowns, level)
        meshed = meshed_part(body.name, mesh, shape.material)
        rooted = held_part(meshed, grips_of(mesh, interfaces))
        shapes = rooted.solid.transformation @ rooted.constraint_modes
        pressed, pressures = as_columns(wrenches_of_faces(mesh, shapes))
        truncation_arrays: dict[str, Array] = {}
        reduction_result: Reduction
        if by == "free":
            reduction_result, truncation = free_interface(rooted, highest, cutoff)
            truncation_arrays = {"squared": truncation.squared, "shares": truncation.shares}
        else:
            reduction_result = reduction(held_body(rooted), highest, cutoff)
        return truncation_arrays | {
            "pressed": pressed,
            "pressures": pressures,
            "stiffness": reduction_result.stiffness,
            "mass": reduction_result.mass,
            "nodes": mesh.nodes,
            "recovery": rooted.solid.transformation @ reduction_result.recovery,
            "cutoff": reduction_result.cutoff,
            "counted": reduction_result.counted,
            "truncated": reduction_result.truncated,
        }

    key = part_key(
        file, interfaces, shape.material, "reduced", unknowns, level, highest, cutoff, by
    )

    def read(arrays: Arrays) -> ReducedPart:
        n = len(arrays["stiffness"])
        square = {"stiffness": (n, n), "mass": (n, n)}
        require_shape(arrays, **square, nodes=(None, 3), recovery=(3 * len(arrays["nodes"]), n))
        pressed, ends = arrays["pressed"], 6 * len(body.interfaces)
        require_shape(arrays, pressed=(None,), pressures=(len(pressed), ends))
        cutoff, truncated = float(arrays["cutoff"]), arrays["truncated"]
        free = None
        if by == "free":
            free = FreeTruncation(cutoff, arrays["squared"], arrays["shares"], truncated)
        return ReducedPart(
            "solid, reduced",
            tuple(body.interfaces),
            arrays["stiffness"],
            arrays["mass"],
            interpolated(arrays["nodes"], arrays["recovery"]),
            unit_pressures=from_columns(pressed, arrays["pressures"]),
            highest=highest,
            cutoff=cutoff,
            counted=int(arrays["counted"]),
            truncated=truncated,
            free=free,
        )

    return CacheEntry(key, compute, read, mesh_entries(file, found_interfaces, unknowns, [level]))


def interpolated(nodes: Array, recovery: Array) -> Callable[[Array], SparseMatrix]:
    """Function that returns, for m points (m×3), the matrix (3m×n) of their displacements.

    The matrix maps n unknowns of a model to the displacements of the points, as `recovery` (3N×n)
    does for the `nodes` (N×3) of its mesh. At a node the result is the node's displacement.
    Elsewhere it is a mean over the nearest nodes, with weights that reproduce linear fields
    exactly.
    """
    fields = recovery.reshape(len(nodes), -1)
    size = float(np.ptp(nodes, axis=0).max())

    def displacements(points: Array) -> SparseMatrix:
        count = min(_NEIGHBOURS, len(nodes))
        distances, nearest = scipy.spatial.cKDTree(nodes).query(points, k=np.arange(1, count + 1))
        weights = np.eye(1, count).repeat(len(points), axis=0)
        between = distances[:, 0] > _AT_NODE * size
        arms = (nodes[nearest] - points[:, None])[between] / distances[between, -1][:, None, None]
        linear = np.concatenate([np.ones((*arms.shape[:2], 1)), arms], axis=2)
        # Minimise Σ w²|arm|² subject to Σ w = 1 and Σ w·arm = 0.
        scaled = linear / np.linalg.norm(arms, axis=2, keepdims=True)
        inverse = np.linalg.pinv(np.swapaxes(scaled, 1, 2), rcond=1e-6)
        weights[between] = inverse[..., 0] / np.linalg.norm(arms, axis=2)
        rows = np.repeat(np.arange(len(points)), count)
        shape = (len(points), len(nodes))
        mean = csr_array((weights.ravel(), (rows, nearest.ravel())), shape=shape)
        return csr_array((mean @ fields).reshape(3 * len(points), -1))

    return displacements
