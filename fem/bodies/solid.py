"""One prismatic leg as a solid: mesh, stiffness and mass, compliance, modes, leg matrices."""

from collections.abc import Callable
from dataclasses import dataclass
from math import ceil

import numpy as np
from scipy.sparse import csr_array, eye_array, kron, vstack

from fem.bodies.rooted import RootedBody, rooted_body
from fem.couplings.coupled_solid import CoupledSolid, coupled_solid
from fem.couplings.grips import Grip, rigid_motions, saint_venant_loads, unknowns
from fem.elasticity import (
    anisotropic_stiffness_and_mass,
    composite_stiffness_and_mass,
    on_three_components,
    stiffness_and_mass,
)
from fem.sections.composite import wrench_states
from fem.sections.moduli import Moduli, leg_moduli, part_materials
from fem.sections.saint_venant import section_quadrature
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.centre_line import CentreLine
from lumped.errors import InputError, naming
from lumped.legs import LineLeg, SectionedLeg
from lumped.mechanism.body_model import LegMatrices
from lumped.model_choices import Ends
from lumped.screws import turn
from meshes.elements import ELEMENTS
from meshes.loft import LoftedMesh, loft, slices_along
from meshes.part.boundary import Facets
from meshes.prism import extrude, stations
from meshes.section.section_blocks import Divisions, element_length
from meshes.section.section_mesh import SectionMesh, require_leg, section_mesh
from meshes.solid_mesh import EndFace, SolidMesh

# Length of a slice divided by the element size in the section. For the cubic deflection under a tip
# load, quadratic slices have a relative error of 0.08 (slice²/(b L))²: 1e-5 at four divisions and
# L = 5b.
_SLICE_ASPECT = 1.0
# Tolerance for stations beyond the end of the leg, relative to its length.
_ROUNDING = 1e-9


@dataclass(frozen=True, eq=False)
class SolidLeg:
    """A leg on a mesh: `stiffness` (csr 3N×3N, in N/m) and `mass` (csr 3N×3N, in kg)."""

    leg: SectionedLeg
    mesh: SolidMesh
    stiffness: SparseMatrix
    mass: SparseMatrix


def solid_mesh(
    leg: SectionedLeg, divisions: Divisions, section: Divisions | None = None
) -> SolidMesh:
    """Extruded or lofted mesh of a leg, `divisions` elements across the section's smaller side.

    `section` are the divisions of the section mesh. None if they equal `divisions`. The length of
    the slices always follows from `divisions`. Raises InputError if the leg or the divisions are
    not valid.
    """
    if isinstance(leg, LineLeg):
        return loft(leg, section or divisions, slices_along(leg, divisions))
    with naming(leg.name):
        require_leg(leg.section, leg.length, divisions)
    count = min(divisions) if isinstance(divisions, tuple) else divisions
    size = element_length(leg.section, count)
    slices = max(2, ceil(leg.length / (_SLICE_ASPECT * size)))
    face = section_mesh(leg.section, section or divisions)
    return extrude(face, stations(leg.length, slices))


def solid_leg(leg: SectionedLeg, mesh: SolidMesh) -> SolidLeg:
    """Stiffness and mass of a leg on a mesh. Raises ComputationError for folded elements."""
    with naming(leg.name):
        if mesh.regions is not None and (materials := part_materials(leg)):
            K, scalar_mass = composite_stiffness_and_mass(mesh, mesh.regions, materials)
        elif moduli := leg_moduli(leg, mesh.root.mesh):
            K, scalar_mass = _anisotropic(mesh, moduli)
        else:
            K, scalar_mass = stiffness_and_mass(mesh, leg.material)
    return SolidLeg(leg, mesh, K, on_three_components(scalar_mass))


def _anisotropic(mesh: SolidMesh, moduli: Moduli) -> tuple[SparseMatrix, SparseMatrix]:
    """Stiffness (csr 3N×3N) and mass (csr N×N) of an extruded mesh, `moduli` equal in all slices.

    The moduli are given for the cells of the section's mesh.
    """
    cells = len(moduli.densities)

    def at(points: Array, numbers: IntArray) -> Array:
        return moduli.at(numbers % cells, points[..., 1:])

    densities = np.tile(moduli.densities, len(mesh.cells) // cells)
    return anisotropic_stiffness_and_mass(mesh, at, densities)


def coupled_leg(solid: SolidLeg, ends: Ends = "rigid") -> CoupledSolid:
    """Solid leg on the twists of root and tip and the displacements of all other nodes as unknowns.

    `ends` is the condition on the end faces: "rigid", or "free" to warp and contract as in
    Saint-Venant's theory. With "free" ends, the displacements of the nodes of the end faces are
    unknowns, and the twists of root and tip are not.
    """
    mesh, grips = solid.mesh, []
    for face, x in ((mesh.root, 0.0), (mesh.tip, mesh.length)):
        facets, point = Facets(face.nodes[face.mesh.cells], face.mesh.element), np.array([x, 0, 0])
        if ends == "rigid":
            grips.append(Grip("rigid", facets, point))
        else:
            tractions = _end_tractions(solid, face, point)
            grips.append(Grip("saint-venant", facets, point, tractions=tractions))
    return coupled_solid(solid.stiffness, solid.mass, mesh.nodes, grips)


def _end_tractions(solid: SolidLeg, face: EndFace, point: Array) -> Array:
    """Nodal loads (3n×6, leg axes) of unit wrenches at a `point` (3, in m) of an end face."""
    leg, points = solid.leg, solid.mesh.nodes[face.nodes]
    if moduli := leg_moduli(leg, face.mesh):
        # The axis of the leg goes through the centroid of the stiffness of every section.
        return wrench_states(face.mesh, moduli).tractions
    if face.axes is None:
        return saint_venant_loads(face, points, point, leg.material)
    local = saint_venant_loads(face, (points - point) @ face.axes, np.zeros(3), leg.material)
    if isinstance(leg, LineLeg):
        span, share = (leg.spans[0], 0.0) if face is solid.mesh.root else (leg.spans[-1], 1.0)
        local = _along_fibres(local, face.mesh, span.taper_rates(np.array([share]))[0])
    turned = np.einsum("ij,njk->nik", face.axes, local.reshape(-1, 3, 6)) @ turn(face.axes).T
    return np.asarray(turned.reshape(-1, 6))


def _along_fibres(tractions: Array, section: SectionMesh, rates: Array) -> Array:
    """Nodal loads (3n×6) of unit wrenches on the end of a taper, along its inclined fibres.

    `tractions` (3n×6) are the loads on the end of a prism. A fibre of the taper at (y, z) has the
    slope (λy y, λz z), and `rates` (2, in 1/m) are λy and λz. The axial tractions alone would bend
    thin walls near the end. Loads across the line are therefore added, so that the tension has the
    direction of the walls. Shear stresses balance the resultants of these loads (see
    `lumped.line_sections`).
    """
    quad = section_quadrature(section)
    y, z = quad.points
    unit = np.ones_like(y)
    # Area and second moments are those of the mesh's polygon: with those of the exact section, the
    # added loads would have a resultant.
    area, inertia_z, inertia_y = (quad.integral(values) for values in (unit, y * y, z * z))
    inclined = tractions.reshape(-1, 3, 6).copy()
    for column, tension in ((0, unit / area), (4, z / inertia_y), (5, -y / inertia_z)):
        inclined[:, 1, column] += quad.load(rates[0] * y * tension)
        inclined[:, 2, column] += quad.load(rates[1] * z * tension)
    loads = inclined.reshape(-1, 6)
    loads[:, 5] += rates[0] * tractions[:, 1]
    loads[:, 4] -= rates[1] * tractions[:, 2]
    return loads


def clamped_leg(solid: SolidLeg, ends: Ends = "rigid") -> RootedBody:
    """Solid leg with clamped root and factorised stiffness.

    `ends` is the condition on the end faces, see `coupled_leg`. Raises ComputationError if the leg
    cannot be clamped or the memory is insufficient.
    """
    coupled = coupled_leg(solid, ends)
    part = f"{solid.leg.name or 'leg'} as a solid, {ends} ends"
    # The matrices are released for the factor, unless the caller has a reference to them.
    del solid
    return rooted_body(coupled, part)


def solid_leg_matrices(solid: SolidLeg) -> LegMatrices:
    """Free leg matrices of a solid leg with rigid end faces.

    Unknowns: twist of root (6), twist of tip (6), displacements of the other nodes (3 each).
    """
    coupled = coupled_leg(solid)
    return LegMatrices(
        model="solid",
        length=solid.leg.length,
        line=line_of(solid.mesh),
        stiffness=coupled.stiffness,
        mass=coupled.mass,
        centreline=centreline_of(solid.mesh, coupled),
    )


def line_of(mesh: SolidMesh) -> CentreLine | None:
    """Centre line of a leg's mesh. None if it is the x axis."""
    return mesh.line if isinstance(mesh, LoftedMesh) else None


def centreline_of(mesh: SolidMesh, coupled: CoupledSolid) -> Callable[[Array], SparseMatrix]:
    """Function that returns the matrix from the unknowns of a coupled leg to twists of sections.

    The function is called with the positions of k sections (m from the root). Its matrix is 6k×n
    for the n unknowns of `coupled`.
    """
    # The function must not refer to the other matrices of the coupled solid, which are larger.
    transformation = coupled.transformation
    return lambda stations_x: csr_array(section_twists(mesh, stations_x) @ transformation)


def section_twists(mesh: SolidMesh, stations_x: Array) -> SparseMatrix:
    """6k × 3N matrix (csr) that maps nodal displacements u to twists of k sections.

    `stations_x` are the distances (m) of the sections from the root along the centre line.
    Translations are means over the section. Rotations follow from first moments over the section:
    φy and φz from those of u_x, φx from that of the displacement about the axis. Between planes of
    nodes the shape functions interpolate. Raises InputError for positions outside the leg and for a
    mesh that is neither extruded nor lofted.
    """
    if mesh.slices is None:
        raise InputError(
            "twists of sections need an extruded mesh: tetrahedra have no planes of nodes"
        )
    stations_at = np.asarray(stations_x, dtype=float)
    planes = (
        mesh.positions if isinstance(mesh, LoftedMesh) else mesh.nodes[:: len(mesh.root.nodes), 0]
    )
    if not np.all((stations_at >= 0.0) & (stations_at <= planes[-1] * (1.0 + _ROUNDING))):
        raise InputError(f"stations must lie between 0 m and {planes[-1]:g} m")
    order = ELEMENTS[mesh.element].order
    count = len(stations_at)
    first = order * np.clip(
        np.searchsorted(planes[::order], stations_at, side="right") - 1, 0, mesh.slices - 1
    )
    used = first[:, None] + np.arange(order + 1)
    weights = np.empty(used.shape)
    for local in range(order + 1):
        other_planes = planes[np.delete(used, local, axis=1)]
        weights[:, local] = np.prod(
            (stations_at[:, None] - other_planes) / (planes[used[:, [local]]] - other_planes),
            axis=1,
        )
    station = np.repeat(np.arange(count), order + 1)
    interpolation = csr_array(
        (weights.ravel(), (station, used.ravel())), shape=(count, len(planes))
    )
    if isinstance(mesh, LoftedMesh):
        return csr_array(kron(interpolation, eye_array(6), format="csr") @ _plane_twists(mesh))
    face = mesh.root.mesh
    section_twist = csr_array(_section_twist(face, np.zeros(len(face.nodes))))
    return csr_array(kron(interpolation, section_twist, format="csr"))


def _plane_twists(mesh: LoftedMesh) -> SparseMatrix:
    """Matrix (csr 6p × 3N, leg axes) from nodal displacements to the twists of p node planes."""
    pieces = np.searchsorted(mesh.line.ends, mesh.positions, side="left") - 1
    _, axes = mesh.line.frames(mesh.positions, np.clip(pieces, 0, len(mesh.line.pieces) - 1))
    planes = []
    for face, along, numbers, frame in zip(mesh.faces, mesh.along, mesh.numbers, axes, strict=True):
        local = _section_twist(face, along).reshape(6, -1, 3)
        twists = (turn(frame) @ (local @ frame.T).reshape(6, -1)).ravel()
        columns = np.tile(unknowns(numbers), 6)
        rows = np.repeat(np.arange(6), 3 * len(numbers))
        planes.append(csr_array((twists, (rows, columns)), shape=(6, mesh.nodes.size)))
    return csr_array(vstack(planes, format="csr"))


def _section_twist(mesh: SectionMesh, along: Array) -> Array:
    """Matrix (6 × 3n) from the displacements of a section's n nodes to its twist at y = z = 0.

    `along` (n, in m) are the coordinates x of the nodes. They differ from zero if the plane of the
    nodes is inclined to the leg's line, as at a mitre.
    """
    quad = section_quadrature(mesh)
    y, z = quad.points
    mean = quad.load(np.ones_like(y))
    first_y, first_z = quad.load(y), quad.load(z)
    twist = np.zeros((6, len(mesh.nodes), 3))
    for component in range(3):
        twist[component, :, component] = mean
    twist[3, :, 1], twist[3, :, 2] = -first_z, first_y
    twist[4, :, 0], twist[5, :, 0] = first_z, -first_y
    rows = twist.reshape(6, -1)
    # The moments of the six rigid motions are area and moments of area. After division by these, a
    # rigid motion has exactly its own twist.
    points = np.column_stack([along, mesh.nodes])
    return np.asarray(np.linalg.solve(rows @ rigid_motions(points, np.zeros(3)), rows))
