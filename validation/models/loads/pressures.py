"""Pressures on faces of CAD parts: selected faces, and equivalent wrenches on the interfaces.

Input: a mechanism with loads, and models of its CAD parts. Output: wrenches of unit pressures on
the interfaces (`fem.bodies.part`), and resultants of each pressure. Rule: these wrenches
follow from the work of the pressure on the static displacements of the part due to motions of its
interfaces. The displacements of the interfaces are then exact (Maxwell and Betti). Legs and rigid
bodies that stand for a part carry the same wrenches at its interfaces.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fem.bodies.part import pressure_forces
from lumped.arrays import Array
from lumped.errors import InputError, collect_faults
from lumped.mechanism.body import Body, Selection
from lumped.mechanism.body_model import BodyModel
from lumped.mechanism.load import Pressure, PressureResultant
from lumped.mechanism.mechanism import Mechanism
from lumped.screws import shift
from meshes.part.faces import Face
from meshes.part.interfaces import selected_faces
from validation.models.reduced_parts import condensed, found_in


@dataclass(frozen=True, eq=False)
class PressedFaces:
    """A pressure of the load named `load` on the `faces` of a CAD part.

    `key` is the position of the pressure in the robot file.
    """

    load: str
    key: str
    pressure: Pressure
    faces: tuple[Face, ...]


def pressed_faces(mechanism: Mechanism) -> list[PressedFaces]:
    """Faces of all pressures of all loads. Raises InputError for selections without faces."""
    pressures = [
        (load.name, f"loads[{number}].pressures[{entry}]", pressure)
        for number, load in enumerate(mechanism.loads, start=1)
        for entry, pressure in enumerate(load.pressures, start=1)
    ]

    def with_faces(row: tuple[str, str, Pressure]) -> PressedFaces:
        load, key, pressure = row
        try:
            file, _ = found_in(mechanism.bodies[pressure.body])
            faces = tuple(selected_faces(file, pressure.faces))
        except InputError as error:
            raise InputError(f"{key}: {fault}" for fault in error.faults) from error
        return PressedFaces(load, key, pressure, faces)

    rows, faults = collect_faults(with_faces, pressures)
    if faults:
        raise InputError(faults)
    return rows


def unit_pressures(
    mechanism: Mechanism, parts: Mapping[str, BodyModel] | None = None
) -> dict[tuple[str, Selection], Array]:
    """Wrenches (6m, body axes) on the m interfaces of a part that are equivalent to 1 Pa on faces.

    The keys are pairs of the body's name and the selection of its faces. `parts` are models of the
    CAD parts; if None, the parts are condensed. {} if there are no pressures.
    """
    wrenches = {}
    for row in pressed_faces(mechanism):
        body = row.pressure.body
        model = condensed(mechanism.bodies[body]) if parts is None else parts[body]
        of_faces = [model.unit_pressures[face.number] for face in row.faces]
        wrenches[body, row.pressure.faces] = np.sum(of_faces, axis=0)
    return wrenches


def resultants(mechanism: Mechanism) -> dict[str, list[PressureResultant]]:
    """Resultants of all pressures on the finest meshes of the parts, by name of the load.

    By equilibrium, the resultant of a pressure equals that of its wrenches on the interfaces. Loads
    without pressures are omitted.
    """
    by_load: dict[str, list[PressureResultant]] = {}
    for row in pressed_faces(mechanism):
        body = mechanism.bodies[row.pressure.body]
        of_faces = condensed(body).unit_pressures
        wrenches = np.sum([of_faces[face.number] for face in row.faces], axis=0).reshape(-1, 6)
        total = sum(
            shift(interface.position).T @ wrench
            for interface, wrench in zip(body.interfaces.values(), wrenches, strict=True)
        )
        by_load.setdefault(row.load, []).append(_resultant(body, row, np.asarray(total)))
    return by_load


def surface_resultants(mechanism: Mechanism) -> list[tuple[PressedFaces, PressureResultant]]:
    """Resultants of all pressures on the surfaces in the files of the parts, without any mesh.

    They are exact on plane faces. A curved face of a CAD file is replaced by triangles between
    points on the face.
    """
    return [
        (row, _resultant(body, row, _on_surface(found_in(body)[0].surface, row.faces)))
        for row in pressed_faces(mechanism)
        for body in (mechanism.bodies[row.pressure.body],)
    ]


def _resultant(body: Body, row: PressedFaces, unit: Array) -> PressureResultant:
    """Resultant of the pressure `row`, from the resultant wrench `unit` (6) of 1 Pa."""
    area = float(sum(face.area for face in row.faces))
    numbers = tuple(face.number for face in row.faces)
    force, moment = np.split(row.pressure.pressure * unit, 2)
    return PressureResultant(body.name, numbers, row.pressure.pressure, area, force, moment)


def _on_surface(nodes: Array, faces: Sequence[Face]) -> Array:
    """Force, and moment about the origin, (6) of 1 Pa on faces.

    `nodes` (n×3, in m) are those of the surface in the file of the part.
    """
    total = np.zeros(6)
    for face in faces:
        if face.kind == "plane":
            forces, points = -face.area * face.direction[None], face.centre[None]
        else:
            forces = pressure_forces(nodes, face.facets)
            points = nodes[face.facets.nodes]
        total += np.concatenate([forces.sum(axis=0), np.cross(points, forces).sum(axis=0)])
    return total
