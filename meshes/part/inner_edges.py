"""Tetrahedra at sharp re-entrant edges cut near these: short across the edge, as long along it.

Where material fills more than half of the space about an edge, stresses grow without bound towards
it: at a right angle the warping function of torsion goes as r^(2/3), so that the energy of elements
of size h misses as h^(4/3), whatever their order (Grisvard, Elliptic Problems in Nonsmooth Domains,
§2.4). Elements that are short all round would be many. So every side that leaves such an edge is
cut (anisotropic grading: Apel, Anisotropic Finite Elements, ch. 4); the shape stays, and the new
mesh holds all displacements of the old one.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lumped.arrays import Array, IntArray
from meshes.elements import SIMPLEX_EDGES
from meshes.part.boundary import CREASE, Facets, PartMesh, boundary
from meshes.part.straighten import are_folded
from meshes.shape_functions import gradients, values

# Where sides are cut, as a share from the edge. Measured on a box tube and on a leg with lugs: once
# there, at equal numbers of unknowns, is nearer than not at all (three times) and than twice.
_CUT = 0.25
# A side's number holds those of its two ends, of so many bits.
_BITS = 31
# A corner of a piece: (i, i) is the whole's corner i, (i, j) the cut of its side from i to j.
_Corner = tuple[int, int]


def inner_edges(mesh: PartMesh) -> IntArray:
    """Corner nodes on the sharp re-entrant edges between faces of tetrahedra, ascending.

    Sharp is what turns where the faces meet: those of a rounding turn in themselves.
    """
    facets = boundary(mesh)
    corners, order = facets.corners, np.array([(0, 1), (1, 2), (2, 0)])
    slopes = gradients(facets.element, np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5]]))
    tangents = np.einsum("fki,kjs->sfji", mesh.nodes[facets.cells], slopes)
    normals = np.cross(tangents[:, :, 0], tangents[:, :, 1]).reshape(-1, 3)
    normals = normals / np.linalg.norm(normals, axis=1)[:, None]
    sides = np.sort(np.vstack([corners[:, ends] for ends in order]), axis=1)
    opposite, face = corners[:, [2, 0, 1]].T.ravel(), np.tile(_face_of(corners, mesh), 3)
    # Of a closed surface every side belongs to two facets.
    paired = np.lexsort(sides.T)
    one, other = paired[::2], paired[1::2]
    turn = np.einsum("ij,ij->i", normals[one], normals[other])
    reach = mesh.nodes[opposite[other]] - mesh.nodes[sides[one, 0]]
    inner = (face[one] != face[other]) & (turn < np.cos(CREASE))
    inner &= np.einsum("ij,ij->i", normals[one], reach) > 0.0
    return np.unique(sides[one[inner]])


def _face_of(corners: IntArray, mesh: PartMesh) -> IntArray:
    """The face on which each facet of the boundary (F×3) lies."""
    known = np.vstack([facets.corners for facets in mesh.faces.values()])
    numbers = np.repeat(list(mesh.faces), [len(f.cells) for f in mesh.faces.values()])
    order, wanted = (np.lexsort(np.sort(c, axis=1).T) for c in (known, corners))
    found = np.empty(len(corners), dtype=np.int64)
    found[wanted] = numbers[order]
    return found


def second_order_unknowns(mesh: PartMesh, *, cut: bool) -> int:
    """Displacements of the second-order mesh that one of corners (tet4) gives, `cut` or not."""
    cells = mesh.cells
    if cut:
        _, cells = _renumbered(_cut(cells, inner_edges(mesh)).corners)
    return 3 * (len(np.unique(cells)) + len(np.unique(_middles(cells))))


def cut_at_inner_edges(mesh: PartMesh) -> PartMesh:
    """A mesh of tet10 with every side cut that leaves a re-entrant edge; as it is without one.

    Nodes of the edge about which a piece of a curved element would be folded are left out.
    """
    edges = inner_edges(mesh)
    while edges.size:
        cut = _cut(mesh.cells[:, :4], edges)
        places = cut.places(mesh)
        folded = np.unique(mesh.cells[cut.owner[are_folded(places)]][:, :4])
        if not np.isin(folded, edges).any():
            return _renewed(mesh, edges, cut, places)
        edges = np.setdiff1d(edges, folded)
    return mesh


def _renewed(mesh: PartMesh, edges: IntArray, cut: "_Cut", places: Array) -> PartMesh:
    """The mesh of all pieces, whose nodes (P×10×3) lie at `places`."""
    known, corners = _renumbered(cut.corners)
    sides, middles = np.unique(_middles(corners), return_inverse=True)
    cells = np.hstack([corners, len(known) + middles.reshape(-1, 6)])
    nodes = np.empty((len(known) + len(sides), 3))
    nodes[cells] = places

    def renumbered(facets: Facets) -> Facets:
        ends = np.searchsorted(known, _cut(facets.corners, edges).corners)
        found = len(known) + np.searchsorted(sides, _middles(ends))
        return Facets(np.hstack([ends, found.reshape(-1, 3)]), facets.element)

    faces = {number: renumbered(facets) for number, facets in mesh.faces.items()}
    return replace(mesh, nodes=nodes, cells=cells, faces=faces)


@dataclass(frozen=True, eq=False)
class _Cut:
    """Pieces of simplices: `owner` (P), the whole; `corners` (P×k), numbered as sides of wholes.

    `shares` (P×k×k): the barycentric coordinates of each corner in the whole.
    """

    owner: IntArray
    corners: IntArray
    shares: Array

    def places(self, mesh: PartMesh) -> Array:
        """Where the pieces' nodes (P×10×3) lie in the curved wholes."""
        middles = self.shares[:, SIMPLEX_EDGES[4]].mean(axis=2)
        shares = np.concatenate([self.shares, middles], axis=1)
        shapes = values("tet10", shares[:, :, 1:].reshape(-1, 3).T).reshape(10, len(shares), -1)
        return np.asarray(np.einsum("kpq,pki->pqi", shapes, mesh.nodes[mesh.cells[self.owner]]))


def _side(start: IntArray, end: IntArray) -> IntArray:
    """One number for each side from node to node, or from a node to itself."""
    return (start << _BITS) + end


def _renumbered(corners: IntArray) -> tuple[IntArray, IntArray]:
    """The corners that there are, ascending, and each one's number among them."""
    known, numbers = np.unique(corners, return_inverse=True)
    return known, numbers.reshape(corners.shape)


def _middles(corners: IntArray) -> IntArray:
    """The sides (P·s) of triangles or tetrahedra, each from its lower end."""
    ends = np.sort(corners[:, SIMPLEX_EDGES[corners.shape[1]]].reshape(-1, 2), axis=1)
    return _side(ends[:, 0], ends[:, 1])


def _cut(cells: IntArray, edges: IntArray) -> _Cut:
    """Simplices (M×k) cut between those of their nodes that lie on `edges` and the others."""
    size = cells.shape[1]
    on, order = np.isin(cells, edges), np.argsort(cells, axis=1)
    kinds, which = np.unique(np.hstack([on, order]), axis=0, return_inverse=True)
    found = []
    for number, one in enumerate(kinds):
        rows = np.flatnonzero(which.ravel() == number)
        i, j = np.moveaxis(_pieces(one[:size].astype(bool), one[size:]), -1, 0)
        whole = np.eye(size)
        share = np.where((i == j)[..., None], whole[i], (1.0 - _CUT) * whole[i] + _CUT * whole[j])
        # As right-handed as the whole is.
        turned = np.linalg.det(share) < 0.0
        for array in (i, j, share):
            array[turned, :2] = array[turned, 1::-1]
        corners = _side(cells[rows][:, i], cells[rows][:, j]).reshape(-1, size)
        found.append((np.repeat(rows, len(i)), corners, np.tile(share, (len(rows), 1, 1))))
    return _Cut(*(np.concatenate(arrays) for arrays in zip(*found, strict=True)))


def _pieces(on: Array, order: IntArray) -> IntArray:
    """Corners (P×k×2) of the pieces of a simplex, some of whose corners are `on` the edge.

    `order` of the corners' numbers: diagonals start at the lower one, alike in both neighbours.
    """
    inner = [int(i) for i in order if on[i]]
    outer = [int(i) for i in order if not on[i]]
    own = {i: (i, i) for i in (*inner, *outer)}
    if not inner or not outer:
        return np.array([[own[i] for i in (*inner, *outer)]])
    if len(inner) == 1 or len(outer) == 1:
        near = [(i, j) for i in inner for j in outer]
        foot, tip = (outer, inner) if len(inner) == 1 else (inner, outer)
        return np.array([[*near, own[tip[0]]], *_prism([own[i] for i in foot], near)])
    (a, b), (c, d) = inner, outer
    along = _prism([own[a], (a, c), (a, d)], [own[b], (b, c), (b, d)])
    across = _prism([own[c], (a, c), (b, c)], [own[d], (a, d), (b, d)])
    return np.array([*along, *across])


def _prism(foot: Sequence[_Corner], head: Sequence[_Corner]) -> Iterator[list[_Corner]]:
    """Simplices between two simplices: diagonals lead from the foot up to later corners."""
    for i in range(len(foot)):
        yield [*foot[: i + 1], *head[i:]]
