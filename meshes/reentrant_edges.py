"""Sharp re-entrant edges of the boundary of a solid mesh, where stresses have no bound.

Input: a mesh of hexahedra or tetrahedra. Output: its nodes on edges about which material fills more
than half of the space: re-entrant corners of sections, steps, and the inner sides of mitres.
"""

import numpy as np

from lumped.arrays import Array, IntArray
from meshes.elements import ELEMENTS
from meshes.part.boundary import boundary
from meshes.shape_functions import gradients
from meshes.solid_mesh import VolumeMesh

# Smallest turn (rad) of the normal at a sharp edge, also at a corner of a section. Between elements
# of second order on an arc, of angle θ each, the normal turns by θ³/16: by 0.06 for 1 rad.
SHARP = 0.1


def reentrant_nodes(mesh: VolumeMesh, sharp: float = SHARP) -> IntArray:
    """Nodes on the sharp re-entrant edges of the boundary of a mesh, ascending.

    The normal turns by more than `sharp` (rad) at such an edge. The angle is that of the facets at
    both ends of an edge, so that curved surfaces have none. An edge at which more than two facets
    meet is re-entrant: cells on both sides have only this edge in common.
    """
    facets = boundary(mesh)
    kind = ELEMENTS[facets.element]
    count = len(kind.corner_nodes)
    corners = facets.corners
    slopes = gradients(facets.element, kind.nodes[:count].T)
    tangents = np.einsum("fki,kjs->fsji", mesh.nodes[facets.cells], slopes, optimize=True)
    normals = np.cross(tangents[:, :, 0], tangents[:, :, 1])
    normals = normals / np.linalg.norm(normals, axis=2)[:, :, None]
    ahead = np.roll(np.arange(count), -1)
    # Sides of all facets, ends in ascending order, with the normals at both ends.
    ends = np.stack([corners, corners[:, ahead]], axis=2).reshape(-1, 2)
    at_ends = np.stack([normals, normals[:, ahead]], axis=2).reshape(-1, 2, 3)
    at_ends = np.take_along_axis(at_ends, np.argsort(ends, axis=1)[:, :, None], axis=1)
    middles = facets.cells[:, count : 2 * count].ravel()
    edges, edge_of_side, shared = np.unique(
        np.sort(ends, axis=1), axis=0, return_inverse=True, return_counts=True
    )
    order = np.argsort(edge_of_side.ravel(), kind="stable")
    starts = np.cumsum(shared) - shared
    first, second = order[starts], order[starts + 1]
    # Sides run counter-clockwise, seen from outside: about them, convex edges have positive turns.
    along = mesh.nodes[ends[first, 1]] - mesh.nodes[ends[first, 0]]
    along = along / np.linalg.norm(along, axis=1)[:, None]
    turns = _turns(at_ends[first], at_ends[second], along)
    is_sharp = (turns.max(axis=1) < -sharp) | (shared > 2)
    return np.unique(np.concatenate([edges[is_sharp].ravel(), middles[first[is_sharp]]]))


def _turns(normals: Array, next_normals: Array, along: Array) -> Array:
    """Angles (e×2, rad) from the normals at both ends of e edges to those of the next facets.

    The angles are about the directions `along` (e×3).
    """
    sines = np.einsum("esi,ei->es", np.cross(normals, next_normals), along)
    cosines = np.einsum("esi,esi->es", normals, next_normals)
    return np.asarray(np.arctan2(sines, cosines))
