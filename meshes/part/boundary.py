"""Boundary of a volume mesh: outward facets, and the smooth faces that they form."""

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from lumped.arrays import Array, IntArray
from lumped.memo import memo
from meshes.elements import ELEMENTS, SectionElement, SolidElement
from meshes.shape_functions import gradients, values
from meshes.solid_mesh import VolumeMesh

FACET: dict[SolidElement, SectionElement] = {
    "tet4": "tri3",
    "tet10": "tri6",
    "hex8": "quad4",
    "hex20": "quad8",
    "hex27": "quad9",
}
# Corners of the facets of a cell, counter-clockwise seen from outside, as indices into
# `corner_nodes`.
_TETRAHEDRON = ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2))
_HEXAHEDRON = (
    (0, 3, 2, 1),
    (4, 5, 6, 7),
    (0, 1, 5, 4),
    (1, 2, 6, 5),
    (2, 3, 7, 6),
    (3, 0, 4, 7),
)
# Angle (rad) above which adjacent facets belong to different faces. It is 30 degrees between the
# sides of a circle approximated by twelve sides, and more at intended edges of parts.
CREASE = np.radians(40.0)


@dataclass(frozen=True, eq=False)
class Facets:
    """Facets of a surface, with outward normals.

    `cells` (F×k) are their node numbers, `element` the type of plane element.
    """

    cells: IntArray
    element: SectionElement

    @property
    def nodes(self) -> IntArray:
        """Indices of the nodes of the facets, ascending."""
        return np.unique(self.cells)

    @property
    def corners(self) -> IntArray:
        """Corner nodes of each facet (F×3 or F×4)."""
        return self.cells[:, : len(ELEMENTS[self.element].corner_nodes)]

    def at(self, rows: IntArray) -> "Facets":
        """The facets with the indices `rows`."""
        return Facets(self.cells[rows], self.element)


@dataclass(frozen=True, eq=False)
class PartMesh(VolumeMesh):
    """Mesh of a part in the axes of its file (m).

    `faces` contains the outward facets of each face, by face number. `names` contains the names of
    the faces that have one, by face number. `empty_sets` are the names of node sets of the file
    that do not contain a complete facet. `straightened` is the number of elements whose edges were
    made straight because the elements were folded.
    """

    faces: Mapping[int, Facets]
    names: Mapping[int, str] = field(default_factory=dict)
    empty_sets: tuple[str, ...] = ()
    straightened: int = 0

    @property
    def unknowns(self) -> int:
        """Number of displacement unknowns: three per node."""
        return 3 * len(self.nodes)


@memo(8)
def _local_facets(element: SolidElement) -> IntArray:
    """Local nodes (facets × nodes) of each facet of a cell of the type `element`.

    The nodes are in the order of the plane element that `FACET` contains for this type.
    """
    kind, flat = ELEMENTS[element], ELEMENTS[FACET[element]]
    corners = _TETRAHEDRON if element.startswith("tet") else _HEXAHEDRON
    linear: SectionElement = "tri3" if element.startswith("tet") else "quad4"
    # Nodes of the facet element, mapped linearly from its corners, coincide with nodes of the cell.
    weights = values(linear, flat.nodes.T)
    vertices = kind.nodes[list(kind.corner_nodes)]
    positions = np.array([weights.T @ vertices[list(facet)] for facet in corners])
    distances = np.abs(positions[:, :, None] - kind.nodes).sum(axis=-1)
    return np.asarray(distances.argmin(axis=-1))


def facets_of_cells(mesh: VolumeMesh) -> tuple[Facets, IntArray]:
    """All facets of all cells, with outward normals, and the index of the cell of each facet."""
    local = _local_facets(mesh.element)
    cells = mesh.cells[:, local].reshape(-1, local.shape[1])
    return Facets(cells, FACET[mesh.element]), np.repeat(np.arange(len(mesh.cells)), len(local))


def boundary(mesh: VolumeMesh) -> Facets:
    """Facets of the boundary: those that belong to a single cell."""
    facets, _ = facets_of_cells(mesh)
    corners = np.sort(facets.corners, axis=1)
    _, first, counts = np.unique(corners, axis=0, return_index=True, return_counts=True)
    return facets.at(np.sort(first[counts == 1]))


def area_vectors(nodes: Array, facets: Facets) -> Array:
    """Normal vector times area (F×3, in m²) of each facet, evaluated at its centre."""
    flat = ELEMENTS[facets.element]
    corners = flat.nodes[list(flat.corner_nodes)]
    slopes = gradients(facets.element, corners.mean(axis=0)[:, None])[:, :, 0]
    tangents = np.einsum("fki,kj->fji", nodes[facets.cells], slopes)
    reference = 0.5 if len(corners) == 3 else 1.0
    return np.asarray(reference * np.cross(tangents[:, 0], tangents[:, 1]))


def smooth_faces(nodes: Array, facets: Facets) -> list[IntArray]:
    """Smooth faces of a surface: for each face the indices of its `facets`.

    Two facets belong to one face if the normal turns by less than the angle CREASE at their common
    edge. Faces are in the order of their first facets. `nodes` are N×3 (m).
    """
    normals = area_vectors(nodes, facets)
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    count = facets.corners.shape[1]
    ring = [*range(count), 0]
    edges = np.concatenate([facets.corners[:, ring[i : i + 2]] for i in range(count)])
    owner = np.tile(np.arange(len(facets.cells)), count)
    _, group = np.unique(np.sort(edges, axis=1), axis=0, return_inverse=True)
    order = np.argsort(group.ravel(), kind="stable")
    duplicates = np.flatnonzero(np.diff(group.ravel()[order]) == 0)
    first, second = owner[order[duplicates]], owner[order[duplicates + 1]]
    flat = np.einsum("ij,ij->i", normals[first], normals[second]) > np.cos(CREASE)
    pairs = (np.ones(int(flat.sum())), (first[flat], second[flat]))
    size = len(facets.cells)
    _, label = connected_components(csr_array(pairs, shape=(size, size)), directed=False)
    starts = [int(np.argmax(label == face)) for face in range(label.max() + 1)]
    return [np.flatnonzero(label == label[start]) for start in sorted(starts)]
