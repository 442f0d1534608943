"""Bodies that are CAD parts, for every model: as solids, condensed, or as equivalent legs.

Meshed, factorised and reduced once, kept on the disk (validation.parts.kept) and in memory.
"""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from fem.bodies.part import grips_of, held_part, meshed_part
from fem.reduction.craig_bampton import reduction
from fem.reduction.held import HeldBody
from lumped.arrays import Array, SparseMatrix
from lumped.caches import lru_cache
from lumped.errors import InputError
from lumped.mechanism.body import Body, Given
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.frame import Frame
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.mechanism.part import Part
from lumped.mechanism.placing import leg_frame
from lumped.screws import turn
from meshes.part.interfaces import Interface, find_interfaces
from meshes.part.read import PartFile, read_part
from meshes.part.volume import ladder, volume_mesh
from validation.parts.identify import Identified, identify
from validation.parts.kept import kept, key_of

# Unknowns of the finest of the three meshes on which a robot's part is identified, and of the mesh
# on which it is reduced.
UNKNOWNS = 60_000
_MODES = 6


def parts_of(mechanism: Mechanism) -> dict[str, Body]:
    """The bodies that are parts, by name."""
    return {name: body for name, body in mechanism.bodies.items() if isinstance(body.shape, Part)}


@lru_cache(maxsize=16)
def _read(path: Path, unit: str | None) -> PartFile:
    return read_part(path, unit)


def shape_of(body: Body) -> Part:
    """The part that a body is; raises InputError for a body that is none."""
    if not isinstance(body.shape, Part):
        raise InputError(f"bodies.{body.name}: is no part from a file")
    return body.shape


def found_in(body: Body) -> tuple[PartFile, tuple[Interface, ...]]:
    """The file of a part and its interfaces at the points of the robot.

    Raises InputError where the file cannot be read or has no faces where the joints are.
    """
    shape = shape_of(body)
    try:
        file = _read(shape.file, shape.unit)
        points = {name: frame.position for name, frame in body.interfaces.items()}
        return file, find_interfaces(file, shape.interfaces, points)
    except InputError as error:
        raise InputError(f"bodies.{body.name}: {fault}" for fault in error.faults) from error


def identified(body: Body, unknowns: int = UNKNOWNS, modes: int = _MODES) -> Identified:
    """The part by its interfaces, in body axes, with its uncertainties."""
    file, interfaces = found_in(body)
    return identify(file, interfaces, shape_of(body).material, unknowns, modes)


def condensed(body: Body) -> BodyModel:
    """The part by the twists of its interfaces alone: exact in statics, mass by Guyan (1965)."""
    found = identified(body)
    return _model(
        "condensed", body, found.stiffness, found.mass, found.interfaces, np.zeros((0, 3))
    )


def reduced(body: Body, highest: float, cutoff: float) -> BodyModel:
    """The part's mesh, reduced by Craig and Bampton for frequencies up to `highest` (Hz)."""
    file, interfaces = found_in(body)
    material = shape_of(body).material

    def compute() -> dict[str, Any]:
        mesh = file.mesh
        if mesh is None:
            mesh = volume_mesh(file, interfaces, ladder(file, interfaces, UNKNOWNS)[-1])
        rooted = held_part(meshed_part(mesh, material), grips_of(mesh, interfaces), body.name)
        found = reduction(HeldBody(rooted), highest, cutoff)
        return {
            "stiffness": found.stiffness,
            "mass": found.mass,
            "nodes": mesh.nodes,
            "recovery": rooted.solid.transformation @ found.recovery,
        }

    key = key_of(file, interfaces, material, "reduced", UNKNOWNS, highest, cutoff)
    arrays = kept(key, compute)
    return _model(
        "solid, reduced",
        body,
        arrays["stiffness"],
        arrays["mass"],
        interfaces,
        arrays["nodes"],
        arrays["recovery"],
    )


def _model(
    model: str,
    body: Body,
    stiffness: Array,
    mass: Array,
    interfaces: Sequence[Interface],
    nodes: Array,
    recovery: Array | None = None,
) -> BodyModel:
    size = len(stiffness)

    def displacements(points: Array) -> SparseMatrix:
        """Those of the nearest node; of the nearest interface, rigidly, where nothing is meshed."""
        if recovery is not None:
            _, nearest = cKDTree(nodes).query(points)
            return csr_array(recovery.reshape(-1, 3, size)[nearest].reshape(-1, size))
        places = np.array([interface.point for interface in interfaces])
        rows = np.zeros((len(points), 3, size))
        for row, point in zip(rows, points, strict=True):
            i = int(np.argmin(np.linalg.norm(places - point, axis=1)))
            arm = point - places[i]
            row[:, 6 * i : 6 * i + 3] = np.eye(3)
            row[:, 6 * i + 3 : 6 * i + 6] = -np.cross(np.eye(3), arm).T
        return csr_array(rows.reshape(-1, size))

    return BodyModel(model, tuple(body.interfaces), stiffness, mass, displacements)


def require_legs(mechanism: Mechanism) -> None:
    """Raise InputError for parts that are no legs: those of one interface, or of three and more."""
    others = [
        f"bodies.{name}: a part of {len(body.interfaces)} interfaces is no link of a serial chain; "
        "take the model links"
        for name, body in parts_of(mechanism).items()
    ]
    if others:
        raise InputError(others)


def as_leg(body: Body) -> tuple[Body, Frame]:
    """A part of two interfaces as a leg given by its 6×6, and the frame of that in body axes."""
    first, second = body.interfaces
    start, end = (frame.position for frame in body.interfaces.values())
    frame = leg_frame(start, end)
    found, block = identified(body), turn(frame.rotation)
    length = float(np.linalg.norm(end - start))
    shape = Given(length, found.total, block.T @ found.compliance @ block)
    tip = Frame(np.array([length, 0.0, 0.0]))
    return Body(body.name, shape, {first: Frame(), second: tip}), frame


def with_legs(postures: Sequence[Posture]) -> list[Posture]:
    """The postures of a mechanism with its parts of two interfaces replaced by given legs."""
    mechanism = postures[0].mechanism
    legs = {
        name: as_leg(body)
        for name, body in parts_of(mechanism).items()
        if len(body.interfaces) == 2
    }
    if not legs:
        return list(postures)

    def moved(frames: Any) -> dict[str, Frame]:
        return {
            name: frame @ legs[name][1] if name in legs else frame for name, frame in frames.items()
        }

    bodies = {
        name: legs[name][0] if name in legs else body for name, body in mechanism.bodies.items()
    }
    replaced = replace(mechanism, bodies=bodies, reference=moved(mechanism.reference))
    return [replace(at, mechanism=replaced, frames=moved(at.frames)) for at in postures]
