"""Refinement of tetrahedra at sharp re-entrant edges, in the direction away from the edge only.

If material fills more than half of the space about an edge, stresses grow without bound towards the
edge: at a right angle the warping function of torsion varies as r^(2/3), so that the energy error
of elements of size h is of order h^(4/3) for any element order (Grisvard, Elliptic Problems in
Nonsmooth Domains, §2.4). Uniform refinement would need many elements. Instead, each element side
that starts on such an edge and ends elsewhere is cut near the edge (anisotropic grading: Apel,
Anisotropic Finite Elements, ch. 4). The shape of the part does not change, and the new mesh can
represent all displacements of the old one.

A *simplex* is a tetrahedron, or a triangle of the boundary. It is cut into *pieces*, which are
simplices, too.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lumped.arrays import Array, IntArray
from meshes.elements import SIMPLEX_EDGES
from meshes.part.boundary import CREASE, Facets, PartMesh, boundary
from meshes.part.straighten import are_folded
from meshes.shape_functions import gradients, values

# Distance of the cut from the edge, as a fraction of the side's length. At equal numbers of
# unknowns a box tube and a leg with lugs have a third of the error without cuts, and less than with
# two cuts.
_CUT = 0.25
# Number of bits of a node number. The number of a side combines the numbers of its two ends.
_BITS = 31
# A corner of a piece: (i, i) is corner i of the simplex, (i, j) the cut on the side from i to j.
_Corner = tuple[int, int]


def inner_edges(mesh: PartMesh) -> IntArray:
    """Corner nodes on the sharp re-entrant edges between faces of a mesh of tetrahedra, ascending.

    An edge is sharp if the normal changes abruptly there. On a fillet the normal changes gradually.
    """
    facets = boundary(mesh)
    corners, order = facets.corners, np.array([(0, 1), (1, 2), (2, 0)])
    slopes = gradients(facets.element, np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5]]))
    tangents = np.einsum("fki,kjs->sfji", mesh.nodes[facets.cells], slopes)
    normals = np.cross(tangents[:, :, 0], tangents[:, :, 1]).reshape(-1, 3)
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    sides = np.sort(np.vstack([corners[:, ends] for ends in order]), axis=1)
    opposite, face = corners[:, [2, 0, 1]].T.ravel(), np.tile(_face_of(corners, mesh), 3)
    # In a closed surface every side belongs to two facets.
    pairs = np.lexsort(sides.T)
    first, second = pairs[::2], pairs[1::2]
    turn = np.einsum("ij,ij->i", normals[first], normals[second])
    reach = mesh.nodes[opposite[second]] - mesh.nodes[sides[first, 0]]
    inner = (face[first] != face[second]) & (turn < np.cos(CREASE))
    inner &= np.einsum("ij,ij->i", normals[first], reach) > 0.0
    return np.unique(sides[first[inner]])


def _face_of(corners: IntArray, mesh: PartMesh) -> IntArray:
    """Face number of each triangle of the boundary (`corners`, F×3)."""
    face_corners = np.vstack([facets.corners for facets in mesh.faces.values()])
    numbers = np.repeat(list(mesh.faces), [len(f.cells) for f in mesh.faces.values()])
    order, order_of_corners = (np.lexsort(np.sort(c, axis=1).T) for c in (face_corners, corners))
    face_of_facet = np.empty(len(corners), dtype=np.int64)
    face_of_facet[order_of_corners] = numbers[order]
    return face_of_facet


def second_order_unknowns(mesh: PartMesh, *, cut: bool) -> int:
    """Number of displacement unknowns of a mesh of tet4 after its conversion to second order.

    If `cut` is True, elements at re-entrant edges are cut first.
    """
    cells = mesh.cells
    if cut:
        _, cells = _renumbered(_cut(cells, inner_edges(mesh)).corners)
    return 3 * (len(np.unique(cells)) + len(np.unique(_middles(cells))))


def cut_at_inner_edges(mesh: PartMesh) -> PartMesh:
    """Mesh of tet10 in which each element side from a re-entrant edge into the solid is cut.

    The mesh is unchanged if there is no such edge. If cutting would fold a piece of a curved
    element, the sides that start at the nodes of this element are not cut.
    """
    edges = inner_edges(mesh)
    while edges.size:
        cut = _cut(mesh.cells[:, :4], edges)
        positions = cut.positions(mesh)
        folded = np.unique(mesh.cells[cut.owner[are_folded(positions)]][:, :4])
        if not np.isin(folded, edges).any():
            return _cut_mesh(mesh, edges, cut, positions)
        edges = np.setdiff1d(edges, folded)
    return mesh


def _cut_mesh(mesh: PartMesh, edges: IntArray, cut: "_Cut", positions: Array) -> PartMesh:
    """Mesh of all P pieces of `cut`, whose nodes have the given `positions` (P×10×3, in m).

    `mesh` is the mesh that was cut. `edges` are its corner nodes on re-entrant edges.
    """
    corner_numbers, corners = _renumbered(cut.corners)
    sides, middles = np.unique(_middles(corners), return_inverse=True)
    cells = np.hstack([corners, len(corner_numbers) + middles.reshape(-1, 6)])
    nodes = np.empty((len(corner_numbers) + len(sides), 3))
    nodes[cells] = positions

    def renumbered(facets: Facets) -> Facets:
        ends = np.searchsorted(corner_numbers, _cut(facets.corners, edges).corners)
        middle_nodes = len(corner_numbers) + np.searchsorted(sides, _middles(ends))
        return Facets(np.hstack([ends, middle_nodes.reshape(-1, 3)]), facets.element)

    faces = {number: renumbered(facets) for number, facets in mesh.faces.items()}
    return replace(mesh, nodes=nodes, cells=cells, faces=faces)


@dataclass(frozen=True, eq=False)
class _Cut:
    """P pieces of cut simplices.

    `owner` (P) is the index of the simplex to which a piece belongs. Each corner of a piece lies on
    a side of the simplex or at one of its nodes. `corners` (P×k) are the numbers of these sides or
    nodes (see `_side`). `shares` (P×k×k) are the barycentric coordinates of the corners in the
    simplex.
    """

    owner: IntArray
    corners: IntArray
    shares: Array

    def positions(self, mesh: PartMesh) -> Array:
        """Positions (P×10×3, in m) of the nodes of all pieces of `mesh`.

        The pieces lie in curved elements, so that their sides may be curved.
        """
        middles = self.shares[:, SIMPLEX_EDGES[4]].mean(axis=2)
        shares = np.concatenate([self.shares, middles], axis=1)
        shapes = values("tet10", shares[:, :, 1:].reshape(-1, 3).T).reshape(10, len(shares), -1)
        return np.asarray(np.einsum("kpq,pki->pqi", shapes, mesh.nodes[mesh.cells[self.owner]]))


def _side(start: IntArray, end: IntArray) -> IntArray:
    """Unique number of the element side between the nodes `start` and `end`.

    If both are the same node, the number stands for the node.
    """
    return (start << _BITS) + end


def _renumbered(corners: IntArray) -> tuple[IntArray, IntArray]:
    """Different numbers in `corners`, ascending, and for each corner the index of its number."""
    distinct, numbers = np.unique(corners, return_inverse=True)
    return distinct, numbers.reshape(corners.shape)


def _middles(corners: IntArray) -> IntArray:
    """Numbers of all sides of triangles (`corners` M×3) or tetrahedra (M×4).

    These numbers are those of `_side`, from the lower to the higher node number.
    """
    ends = np.sort(corners[:, SIMPLEX_EDGES[corners.shape[1]]].reshape(-1, 2), axis=1)
    return _side(ends[:, 0], ends[:, 1])


def _cut(cells: IntArray, edges: IntArray) -> _Cut:
    """Pieces of simplices, cut between their nodes on re-entrant edges and their other nodes.

    `cells` (M×k) are the node numbers of the simplices, `edges` the numbers of the nodes on
    re-entrant edges.
    """
    size = cells.shape[1]
    on, order = np.isin(cells, edges), np.argsort(cells, axis=1)
    kinds, kind_of_cell = np.unique(np.hstack([on, order]), axis=0, return_inverse=True)
    pieces = []
    for number, kind in enumerate(kinds):
        rows = np.flatnonzero(kind_of_cell.ravel() == number)
        i, j = np.moveaxis(_pieces(kind[:size].astype(bool), kind[size:]), -1, 0)
        corners_of_whole = np.eye(size)
        share = np.where(
            (i == j)[..., None],
            corners_of_whole[i],
            (1.0 - _CUT) * corners_of_whole[i] + _CUT * corners_of_whole[j],
        )
        # Pieces must have the orientation of the simplex.
        left_handed = np.linalg.det(share) < 0.0
        for array in (i, j, share):
            array[left_handed, :2] = array[left_handed, 1::-1]
        corners = _side(cells[rows][:, i], cells[rows][:, j]).reshape(-1, size)
        pieces.append((np.repeat(rows, len(i)), corners, np.tile(share, (len(rows), 1, 1))))
    return _Cut(*(np.concatenate(arrays) for arrays in zip(*pieces, strict=True)))


def _pieces(on: Array, order: IntArray) -> IntArray:
    """Corners (P×k×2) of the P pieces of one simplex that has corners on a re-entrant edge.

    `on` (k) is True for the corners of the simplex on the edge. A corner of a piece is a pair of
    indices of corners of the simplex. The pair (i, i) is corner i itself. The pair (i, j) is the
    cut on the side from corner i, on the edge, to corner j. `order` contains the corners of the
    simplex in ascending order of their node numbers. Diagonals start at the lower number, so that
    neighbouring simplices are cut along the same diagonals.
    """
    inner = [int(i) for i in order if on[i]]
    outer = [int(i) for i in order if not on[i]]
    corner = {i: (i, i) for i in (*inner, *outer)}
    if not inner or not outer:
        return np.array([[corner[i] for i in (*inner, *outer)]])
    if len(inner) == 1 or len(outer) == 1:
        near = [(i, j) for i in inner for j in outer]
        foot, tip = (outer, inner) if len(inner) == 1 else (inner, outer)
        return np.array([[*near, corner[tip[0]]], *_prism([corner[i] for i in foot], near)])
    (a, b), (c, d) = inner, outer
    along = _prism([corner[a], (a, c), (a, d)], [corner[b], (b, c), (b, d)])
    across = _prism([corner[c], (a, c), (b, c)], [corner[d], (a, d), (b, d)])
    return np.array([*along, *across])


def _prism(foot: Sequence[_Corner], head: Sequence[_Corner]) -> Iterator[list[_Corner]]:
    """Simplices that fill a prism between its faces `foot` and `head`, each given by its corners.

    Both faces have their corners in the same order. Diagonals of the prism's other sides run from a
    corner of `foot` to a later corner of `head`.
    """
    for i in range(len(foot)):
        yield [*foot[: i + 1], *head[i:]]
