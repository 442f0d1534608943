"""Stress fields of legs and CAD parts as solids under the forces on their interfaces.

Input: a posture, a load, and the wrenches and twists of the interfaces by a model of the robot.
Output: `SolidStress` for each body. Rule: the first interface is clamped, the other interfaces have
their wrenches, and weight and inertia act on the mass. By equilibrium of the body, the reaction of
the first interface is then the wrench that acts on it. Pressures act on the faces of a CAD part.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

import numpy as np

from fem.bodies.part import forces_on_faces, grips_of, held_part, meshed_part
from fem.bodies.rooted import RootedBody
from fem.bodies.solid import clamped_leg, solid_leg, solid_mesh
from fem.bodies.stresses import COMPONENTS, away_from, nodal_stresses, von_mises
from fem.elasticity import on_three_components
from fem.sections.stresses import rim_edges
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.errors import InputError
from lumped.legs import LineLeg, Material, SectionedLeg
from lumped.mechanism.body import Body
from lumped.mechanism.kinematics.accelerations import REST, Motion, accelerations
from lumped.mechanism.load import Load
from lumped.mechanism.mechanism import Mechanism, Posture
from meshes.elements import ELEMENTS
from meshes.loft import LoftedMesh, leg_sections
from meshes.part.boundary import CREASE, PartMesh
from meshes.part.inner_edges import inner_edges
from meshes.reentrant_edges import reentrant_nodes
from meshes.solid_mesh import EndFace, VolumeMesh
from validation.models.loads.pressures import pressed_faces
from validation.models.loads.statics import BodyEnds
from validation.models.options import DEFAULT_OPTIONS, ModelOptions
from validation.models.reduced_parts import found_in, shape_of, unknowns_of
from validation.models.robot_bodies import sectioned_legs
from validation.parts.meshes import FINEST, part_mesh
from validation.solve.uncertainty import second_divisions
from validation.uncertainty.half_widths import MeshPolicy

if TYPE_CHECKING:
    import pyvista


# Distance from singular edges within which stresses are ignored, as a fraction of the smallest side
# of a leg's sections, or of a part's bounding box.
_NEAR = 0.1
# Order of convergence of stresses for half-widths: the lowest, that of stresses near edges.
_ORDER = 1.0


@dataclass(frozen=True, eq=False)
class SolidStress:
    """Stress field of one body as a solid under a load.

    `mesh` in base axes (m). `displacements` (N×3, m) in base axes and `stresses` (N×6, Pa) in body
    axes at its N nodes. `largest` (Pa): largest von Mises stress farther than `distance` (m) from
    singular edges, at `place` (3, m, base axes). `half_width` (Pa): its uncertainty due to the
    mesh, infinite if the mesh cannot be refined.
    """

    body: str
    mesh: VolumeMesh
    displacements: Array
    stresses: Array
    largest: float
    half_width: float
    place: tuple[float, float, float]
    distance: float


@dataclass(frozen=True, eq=False)
class _Solid:
    """Body on one mesh, factorised with its first interface clamped, with its nodal masses.

    `side` (m): smallest side of a leg's sections, or of a part's bounding box. `singular`: nodes on
    edges with singular stresses. `pressures`: nodal forces (3N) of pressures.
    """

    mesh: VolumeMesh
    material: Material
    rooted: RootedBody
    mass: SparseMatrix
    side: float
    singular: IntArray
    pressures: Array


def require_fields(mechanism: Mechanism, load: Load) -> None:
    """Raise InputError for a load along legs and for legs of several materials.

    Stress fields need the distribution of a load over the sections, which is not known of the
    former, and the solid of a composite leg has one mean material.
    """
    if load.lines:
        raise InputError(
            f"--vtu: load {load.name} acts along legs; stress fields need its distribution "
            "over the sections, which is not known"
        )
    for name, leg, _ in sectioned_legs(mechanism, DEFAULT_OPTIONS):
        sections = leg_sections(leg) if isinstance(leg, LineLeg) else (leg.section,)
        if not all(section.is_uniform for section in sections):
            raise InputError(
                f"--vtu: {name} has no stress field, its section has several materials"
            )


def solid_stresses(
    posture: Posture, load: Load, ends: Mapping[str, BodyEnds], options: ModelOptions
) -> dict[str, SolidStress]:
    """Stress fields of all legs and CAD parts under a load, by name.

    `ends`: wrenches and twists of the interfaces, by name of the body. `require_fields` must accept
    the mechanism and the load.
    """
    pressures = _pressures(posture.mechanism, load)
    motions = accelerations(posture, load.speed, load.acceleration) if load.moves_tool else {}
    legs = {
        name: (leg, leg_options)
        for name, leg, leg_options in sectioned_legs(posture.mechanism, options)
    }
    fields = {}
    for name, of_body in ends.items():
        body = posture.mechanism.bodies[name]
        motion = motions.get(name, REST)
        rotation = posture.frames[name].rotation
        in_body = Motion(
            rotation.T @ (motion.linear_acceleration - load.gravity),
            rotation.T @ motion.angular_acceleration,
            rotation.T @ motion.angular_velocity,
        )
        if name in legs:
            leg, leg_options = legs[name]
            fine = _leg(leg, leg_options, leg_options.divisions)
            coarse = _leg(leg, leg_options, second_divisions(leg_options, [leg]))
        else:
            on_faces = pressures.get(name, {})
            fine, coarse = (_part(body, level, on_faces) for level in (FINEST, FINEST - 1))
        fields[name] = _field(posture, body, (fine, coarse), of_body, in_body)
    return fields


def _leg(leg: SectionedLeg, options: ModelOptions, divisions: int) -> _Solid:
    mesh = solid_mesh(leg, divisions)
    solid = solid_leg(leg, mesh)
    faces = mesh.faces if isinstance(mesh, LoftedMesh) else (mesh.root.mesh,)
    side = min(float(np.ptp(face.nodes, axis=0).min()) for face in faces)
    singular = reentrant_nodes(mesh)
    if options.ends == "rigid":
        singular = np.unique(np.concatenate([singular, _rim(mesh.root), _rim(mesh.tip)]))
    clamped = clamped_leg(solid, options.ends)
    no_pressures = np.zeros(mesh.nodes.size)
    return _Solid(mesh, leg.material, clamped, solid.mass, side, singular, no_pressures)


def _rim(face: EndFace) -> IntArray:
    """Indices of the corner nodes of cells on the edges of an end face."""
    return np.asarray(face.nodes[np.unique(rim_edges(face.mesh))])


def _pressures(mechanism: Mechanism, load: Load) -> dict[str, dict[int, float]]:
    """Pressures (Pa) of a load on faces of CAD parts, by body and face number."""
    pressures: dict[str, dict[int, float]] = {}
    for row in pressed_faces(replace(mechanism, loads=(load,))):
        on_faces = pressures.setdefault(row.pressure.body, {})
        for face in row.faces:
            on_faces[face.number] = on_faces.get(face.number, 0.0) + row.pressure.pressure
    return pressures


def _part(body: Body, level: int, pressures: Mapping[int, float]) -> _Solid:
    file, interfaces = found_in(body)
    mesh = part_mesh(file, interfaces, unknowns_of(body), level)
    meshed = meshed_part(body.name, mesh, shape_of(body).material)
    grips = grips_of(mesh, interfaces)
    faces = np.concatenate([grip.nodes for grip in grips])
    singular = np.union1d(_edges(mesh), faces)
    rooted = held_part(meshed, grips)
    mass = on_three_components(meshed.scalar_mass)
    forces = forces_on_faces(mesh, pressures)
    side = float(np.ptp(mesh.nodes, axis=0).min())
    return _Solid(mesh, meshed.material, rooted, mass, side, singular, forces)


def _edges(mesh: PartMesh) -> IntArray:
    """Nodes on the sharp re-entrant edges of a part."""
    is_tetrahedral = mesh.element in {"tet4", "tet10"}
    return inner_edges(mesh) if is_tetrahedral else reentrant_nodes(mesh, CREASE)


def _field(
    posture: Posture, body: Body, solids: tuple[_Solid, _Solid], ends: BodyEnds, motion: Motion
) -> SolidStress:
    fine, coarse = solids
    distance = _NEAR * fine.side
    displacements, stresses = _solved(fine, ends, motion)
    counted = away_from(fine.mesh.nodes, fine.singular, distance)
    sizes = np.where(counted, von_mises(stresses), 0.0)
    node = int(np.argmax(sizes))
    half_width = np.inf
    if len(coarse.mesh.nodes) != len(fine.mesh.nodes):
        counted = away_from(coarse.mesh.nodes, coarse.singular, distance)
        other = float(von_mises(_solved(coarse, ends, motion)[1])[counted].max(initial=0.0))
        ratio = (len(fine.mesh.nodes) / len(coarse.mesh.nodes)) ** (1.0 / 3.0)
        half_width = MeshPolicy.of_order(ratio, _ORDER).half_width(float(sizes[node]) - other)
    frame = posture.frames[body.name]
    places = frame.position + fine.mesh.nodes @ frame.rotation.T
    return SolidStress(
        body.name,
        VolumeMesh(places, fine.mesh.cells, fine.mesh.element),
        displacements @ frame.rotation.T,
        stresses,
        float(sizes[node]),
        half_width,
        tuple(places[node].tolist()),
        distance,
    )


def _solved(solid: _Solid, ends: BodyEnds, motion: Motion) -> tuple[Array, Array]:
    """Displacements (N×3, m) and stresses (N×6, Pa) at the N nodes of a solid, in body axes.

    `ends`: wrenches and twists of its interfaces. `motion`: motion that causes its inertia forces.
    """
    coupled, nodes = solid.rooted.solid, solid.mesh.nodes
    accelerations_of_nodes = np.array([motion.acceleration_at(arm) for arm in nodes])
    inertia = -(solid.mass @ accelerations_of_nodes.ravel())
    inside = inertia + solid.pressures
    forces = coupled.transformation.T @ inside + solid.rooted.loads @ ends.wrenches[6:]
    unknowns = solid.rooted.flexibility(np.asarray(forces)[:, None])[:, 0]
    deformed = (coupled.transformation @ unknowns).reshape(-1, 3)
    stresses = nodal_stresses(solid.mesh, solid.material, deformed)
    carried = (coupled.transformation @ (coupled.motions @ ends.twists[:6])).reshape(-1, 3)
    return deformed + carried, stresses


def vtu_of(solids: Iterable[SolidStress]) -> bytes:
    """Content of a VTU file with the stress fields of bodies, in base axes, for ParaView.

    Point data: "displacement" (m), "von Mises stress" and the stresses in the axes of the body
    (Pa). Cell data "body": number of the body in the order of the robot file.
    """
    # VTK takes seconds to load and needs system libraries.
    import pyvista  # noqa: PLC0415

    grids = [_grid(number, solid) for number, solid in enumerate(solids, start=1)]
    merged = pyvista.merge(grids, merge_points=False)
    with TemporaryDirectory(prefix="flexproof-vtu-") as folder:
        path = Path(folder) / "forces.vtu"
        merged.save(path)
        return path.read_bytes()


def _grid(number: int, solid: SolidStress) -> "pyvista.UnstructuredGrid":
    import pyvista  # noqa: PLC0415

    kind = ELEMENTS[solid.mesh.element]
    cells = {kind.vtk_type: solid.mesh.cells[:, list(kind.vtk_order)]}
    grid = pyvista.UnstructuredGrid(cells, solid.mesh.nodes)
    grid.point_data["displacement"] = solid.displacements
    grid.point_data["von Mises stress"] = von_mises(solid.stresses)
    for name, values in zip(COMPONENTS, solid.stresses.T, strict=True):
        grid.point_data[f"stress {name}"] = values
    grid.cell_data["body"] = np.full(grid.n_cells, number)
    return grid
