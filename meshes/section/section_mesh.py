"""Finite element meshes of cross-sections, made by gmsh.

The elements are nine-node quadrilaterals, structured in blocks. Polygons with edges that are not
parallel to y or z are filled with unstructured quadrilaterals as large as the walls are thick. The
centroid is the origin.
"""

from dataclasses import dataclass
from types import ModuleType

import numpy as np
import scipy

from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError, InputError
from lumped.memo import memo
from lumped.sections import (
    Composite,
    OutlinedSection,
    Partition,
    Rectangle,
    Section,
    distances_to_edges,
    distances_to_segments,
    partition_edges,
)
from meshes.elements import ELEMENTS, SectionElement
from meshes.gmsh_session import connectivity, gmsh_model, numbered
from meshes.section.section_blocks import (
    Blocks,
    Divisions,
    has_blocks,
    refinements,
    section_blocks,
)


@dataclass(frozen=True, eq=False)
class SectionMesh:
    """Mesh of a section in the y–z plane of the leg. Cells are counter-clockwise seen from +x.

    `nodes` (N×2) are y and z in m. `cells` (M×k) are node numbers in the order of
    `meshes.elements`. In a section of several materials, `regions` (M) are the indices of the parts
    to which the cells belong. None in other sections.
    """

    nodes: Array
    cells: IntArray
    element: SectionElement
    regions: IntArray | None = None


# Memoised, because studies of one leg use the same few meshes repeatedly.
@memo(64)
def section_mesh(section: Section, divisions: Divisions) -> SectionMesh:
    """Mesh of a section with `divisions` elements across its smaller side (see `section_blocks`).

    All nodes on curved sides lie exactly on the curve. Raises InputError if the section has no
    outline or a faulty one, or if the divisions do not suit it, ComputationError if gmsh fails.
    """
    require_section(section, divisions)
    part = f"section mesh ({section.shape})"
    free = isinstance(section, OutlinedSection | Composite) and not has_blocks(section)
    with gmsh_model(part) as gmsh:
        if free and isinstance(section, Composite):
            surfaces = _fill_parts(gmsh, section, refinements(divisions))
            owners = list(range(len(surfaces)))
        elif free and isinstance(section, OutlinedSection):
            surfaces = [_fill(gmsh, section, refinements(divisions))]
            owners = []
        else:
            blocks = section_blocks(section, divisions)
            surfaces, owners = _add_blocks(gmsh, blocks), list(blocks.regions)
            gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(2)
        if owners:
            by_surface = [connectivity(gmsh, "quad9", surface) for surface in surfaces]
            tagged = np.vstack(by_surface)
            regions = np.repeat(owners, [len(cells) for cells in by_surface])
        else:
            tagged, regions = connectivity(gmsh, "quad9"), None
        tags, places = numbered(gmsh, tagged)
    nodes = places[:, 1:]
    if section.is_doubly_symmetric:
        nodes = symmetrised(nodes, part)
    cells = counter_clockwise(nodes, np.searchsorted(tags, tagged), "quad9")
    return SectionMesh(nodes, cells, "quad9", regions)


def _fill_parts(gmsh: ModuleType, section: Composite, refinements: int) -> list[int]:
    """Mesh all parts of a composite section without blocks. Return gmsh's tags of their surfaces.

    Each element of the coarsest mesh is divided into four `refinements` times (see `_fill`).
    """
    loops_by_part = section.centred_loops
    partition = partition_edges(loops_by_part)
    geo = gmsh.model.geo
    sizes = _vertex_sizes(partition, 0.25 * min(section.extent))
    points = [
        geo.addPoint(0.0, *vertex, 2.0 * size)
        for vertex, size in zip(partition.vertices.tolist(), sizes.tolist(), strict=True)
    ]
    lines: dict[tuple[int, int], int] = {}
    for start, end in partition.ends.tolist():
        lines[start, end] = geo.addLine(points[start], points[end])
        lines[end, start] = -lines[start, end]
    surfaces = []
    for loops in loops_by_part:
        rings = [partition.vertices_along(loop) for loop in loops]
        curves = [
            geo.addCurveLoop([lines[pair] for pair in zip(ring, [*ring[1:], ring[0]], strict=True)])
            for ring in rings
        ]
        surfaces.append(int(geo.addPlaneSurface(curves)))
    _generate_quadrilaterals(gmsh, refinements)
    return surfaces


def _generate_quadrilaterals(gmsh: ModuleType, refinements: int) -> None:
    """Fill all surfaces with quadrilaterals, each divided into four `refinements` times."""
    gmsh.model.geo.synchronize()
    for option, value in _QUADRILATERALS.items():
        gmsh.option.setNumber(option, value)
    gmsh.model.mesh.generate(2)
    for _ in range(refinements):
        gmsh.model.mesh.refine()


def _vertex_sizes(partition: Partition, largest: float) -> Array:
    """Element size (m) at each vertex: the distance to the nearest edge not meeting there.

    `partition` contains the vertices and edges of all parts of a section. The size is at most
    `largest` (m).
    """
    starts, ends = (partition.vertices[partition.ends[:, i]] for i in (0, 1))
    sizes = np.full(len(partition.vertices), largest)
    for number, vertex in enumerate(partition.vertices):
        is_elsewhere = ~(partition.ends == number).any(axis=1)
        distances = distances_to_segments(vertex, starts[is_elsewhere], ends[is_elsewhere])
        sizes[number] = min(largest, float(distances.min()))
    return sizes


def _add_blocks(gmsh: ModuleType, blocks: Blocks) -> list[int]:
    """Add blocks to the gmsh model in the plane x = 0, as surfaces with structured quadrilaterals.

    Return gmsh's tags of the surfaces.
    """
    geo = gmsh.model.geo
    points = [geo.addPoint(0.0, y, z) for y, z in blocks.points]
    curves: dict[tuple[int, int], int] = {}
    for (start, end), count in blocks.counts.items():
        if (start, end) in blocks.arc_centres:
            centre = geo.addPoint(0.0, *blocks.arc_centres[start, end])
            curve = geo.addCircleArc(points[start], centre, points[end])
        else:
            curve = geo.addLine(points[start], points[end])
        geo.mesh.setTransfiniteCurve(curve, count + 1)
        curves[start, end], curves[end, start] = curve, -curve
    surfaces = []
    for corners in blocks.corners:
        sides = zip(corners, (*corners[1:], corners[0]), strict=True)
        loop = geo.addCurveLoop([curves[side] for side in sides])
        surface = geo.addPlaneSurface([loop])
        geo.mesh.setTransfiniteSurface(surface, cornerTags=[points[i] for i in corners])
        geo.mesh.setRecombine(2, surface)
        surfaces.append(int(surface))
    geo.synchronize()
    return surfaces


def _fill(gmsh: ModuleType, section: OutlinedSection, refinements: int) -> int:
    """Mesh a polygon with quadrilaterals. Return gmsh's tag of its surface.

    gmsh first fills it with triangles and quadrilaterals of twice the element size, and divides
    these into quadrilaterals. Then each quadrilateral is divided into four, `refinements` times.
    """
    geo = gmsh.model.geo
    curves = []
    for loop, sizes in zip(section.centred_loops, _corner_sizes(section), strict=True):
        points = [
            geo.addPoint(0.0, *corner, 2.0 * size)
            for corner, size in zip(loop.tolist(), sizes.tolist(), strict=True)
        ]
        ends = [*points[1:], points[0]]
        lines = [geo.addLine(start, end) for start, end in zip(points, ends, strict=True)]
        curves.append(geo.addCurveLoop(lines))
    surface = int(geo.addPlaneSurface(curves))
    _generate_quadrilaterals(gmsh, refinements)
    return surface


def _corner_sizes(section: OutlinedSection) -> list[Array]:
    """Element size (m) at each corner: the distance to the nearest edge not meeting there.

    This is the wall thickness at the corner. It is limited to a quarter of the section's smaller
    side. The list has one array for each outline of the section.
    """
    largest = 0.25 * min(section.extent)
    sizes = []
    for which, loop in enumerate(section.centred_loops):
        loop_sizes = []
        for number, corner in enumerate(loop):
            nearest = largest
            for other, rim in enumerate(section.centred_loops):
                distances = distances_to_edges(corner, rim)
                if other == which:
                    # The two edges that meet in the corner do not count.
                    distances[[number - 1, number]] = np.inf
                nearest = min(nearest, float(distances.min()))
            loop_sizes.append(nearest)
        sizes.append(np.array(loop_sizes))
    return sizes


# Options of gmsh: sizes from the corners; pairs of triangles recombined into quadrilaterals, and
# all cells divided into quadrilaterals.
_QUADRILATERALS = {
    "Mesh.MeshSizeFromPoints": 1,
    "Mesh.MeshSizeExtendFromBoundary": 1,
    "Mesh.RecombineAll": 1,
    "Mesh.RecombinationAlgorithm": 1,
    "Mesh.SubdivisionAlgorithm": 1,
}

_REVERSED: dict[SectionElement, list[int]] = {
    "quad9": [0, 3, 2, 1, 7, 6, 5, 4, 8],
    "tri6": [0, 2, 1, 5, 4, 3],
}


def counter_clockwise(nodes: Array, cells: IntArray, element: SectionElement) -> IntArray:
    """Cells (M×k) in counter-clockwise order about +x: clockwise ones are reversed.

    `nodes` (N×2) are y and z of the nodes.
    """
    origin, first, last = (
        nodes[cells[:, i]] for i in (0, 1, len(ELEMENTS[element].corner_nodes) - 1)
    )
    (ay, az), (y_b, bz) = (first - origin).T, (last - origin).T
    clockwise = ay * bz < az * y_b
    return np.where(clockwise[:, None], cells[:, _REVERSED[element]], cells)


def quadrilaterals(across: int, along: int, period: int) -> IntArray:
    """Cells (M×9) on a grid of `across` × `along` nodes, numbered row by row.

    Nodes of a row are numbered modulo `period`: a row is closed if it has one node more.
    """
    column, row = np.meshgrid(np.arange(0, across - 1, 2), np.arange(0, along - 1, 2))
    steps = [(0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1), (1, 1)]
    return np.column_stack([((column + i) % period + (row + j) * period).ravel() for i, j in steps])


def symmetrised(nodes: Array, part: str) -> Array:
    """Nodes (N×2, in m) of a section mesh, made exactly symmetric about both axes.

    For each axis in turn, a node is moved to the mean of its position and of the mirror image of
    its partner, the node on the other side of the axis. gmsh positions points on arcs with errors
    of about 1e-9 of their length. After averaging, products of inertia and couplings vanish to
    round-off. Raises ComputationError, with `part` in its message, if a node has no partner whose
    mirror image is within 1e-6 of the section's size.
    """
    tolerance = 1e-6 * float(np.ptp(nodes, axis=0).max())
    for mirror in ([-1.0, 1.0], [1.0, -1.0]):
        images = nodes * mirror
        distance, partner = scipy.spatial.cKDTree(images).query(nodes)
        if distance.max() > tolerance:
            raise ComputationError(
                "the section mesh is not symmetric about the axes of the section", part=part
            )
        nodes = (nodes + images[partner]) / 2.0
    return nodes


def require_section(section: Section, divisions: Divisions) -> None:
    """Raise InputError with all faults of the shape of a section and of its divisions.

    A section given by constants is a fault, too, because it has no outline that could be meshed.
    """
    if not section.has_outline:
        raise InputError(
            f"{section.shape}: solids need a section with an outline, such as a polygon"
        )
    faults = section.faults() + _division_faults(section, divisions)
    if faults:
        raise InputError(f"{section.shape}: {fault}" for fault in faults)


def require_one_material(mesh: SectionMesh) -> None:
    """Raise InputError for the mesh of a section of several materials."""
    if mesh.regions is not None:
        raise InputError("composite: this comparison takes sections of one material")


def require_leg(section: Section, length: float, divisions: Divisions) -> None:
    """Raise InputError with all faults of a prismatic leg of `length` (m).

    A body shorter than the larger side of its section is not a leg: its end effects, which decay
    over about this length in compact sections (Saint-Venant's principle), would overlap.
    """
    require_section(section, divisions)
    if not length > 0.0:
        raise InputError(f"length = {length!r}: must be above 0 m")
    if length < max(section.extent):
        raise InputError(
            f"length = {length!r}: shorter than its {section.shape} section, "
            f"{max(section.extent):g} m; a leg must be at least as long as its section is large"
        )


def _division_faults(section: Section, divisions: Divisions) -> list[str]:
    if isinstance(divisions, tuple):
        if not isinstance(section, Rectangle):
            return [f"divisions = {divisions}: two numbers are allowed only for a solid rectangle"]
        if min(divisions) < 1:
            return [f"divisions = {divisions}: both must be at least 1"]
    elif divisions < 1:
        return [f"divisions = {divisions}: must be at least 1 element across the smaller side"]
    return []
