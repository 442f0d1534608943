"""Folded second-order tetrahedra given straight edges, as few as need be.

Two facets of an element on one smooth face, or on faces that pass into each other smoothly, lie in
one plane at the ends of the edge between them: the Jacobian vanishes there and nowhere else. Such
an element integrates as well as any, and straight edges in its place would cut off the rounding.
So it is the quadrature points that tell what is folded.
"""

import numpy as np
from numpy.typing import NDArray

from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError
from lumped.text import counted
from meshes.elements import SIMPLEX_EDGES
from meshes.shape_functions import gradients, quadrature

# Least by largest Jacobian below this: folded, or so nearly that its stiffness means little.
_FOLDED = 0.03
# Volume below this share of the longest edge's cube: four corners in one plane but for rounding.
_FLAT = 1e-8
# Degree of the points that integrate the mass of a curved element exactly.
_DEGREE = 7
_ROUNDS = 10


def straightened(nodes: Array, cells: IntArray) -> tuple[Array, int]:
    """Nodes (N×3) with the middles of folded tet10 `cells` put half way; how many cells that were.

    Neighbours share the edges and may fold for it: they follow. Raises ComputationError where one
    is inverted or flat with straight edges.
    """
    straight = np.zeros(len(cells), dtype=bool)
    for _ in range(_ROUNDS):
        bad = are_folded(nodes[cells])
        new = bad & ~straight
        if not new.any():
            break
        nodes = nodes.copy()
        straight |= new
        for middle, (first, second) in enumerate(SIMPLEX_EDGES[4], start=4):
            ends = nodes[cells[new, first]], nodes[cells[new, second]]
            nodes[cells[new, middle]] = (ends[0] + ends[1]) / 2.0
    inverted, flat = _evenness(nodes[cells]) <= 0.0, _fullness(nodes, cells) < _FLAT
    for wrong, one, several in (
        (inverted, "tetrahedron stays inverted", "tetrahedra stay inverted"),
        (flat, "tetrahedron is flat", "tetrahedra are flat"),
    ):
        found = np.flatnonzero(wrong)
        if found.size:
            x, y, z = nodes[cells[found[0]]].mean(axis=0)
            raise ComputationError(
                f"mesh of the part: {counted(found.size, one, several)}, the first at "
                f"({x:.4g}, {y:.4g}, {z:.4g}) m; a finer mesh is needed there"
            )
    return nodes, int(straight.sum())


def are_folded(places: Array) -> NDArray[np.bool_]:
    """Which tet10 with their nodes at `places` (M×10×3) are folded or nearly so (M)."""
    return np.asarray(_evenness(places) < _FOLDED)


def _evenness(places: Array) -> Array:
    """Least Jacobian of each cell (M) at the quadrature points by the largest one, at most 1."""
    points, _ = quadrature("tet10", _DEGREE)
    slopes = gradients("tet10", points)
    jacobians = np.einsum("mki,kjq->mqij", places, slopes, optimize=True)
    determinants = np.linalg.det(jacobians)
    return np.asarray(determinants.min(axis=1) / np.abs(determinants).max(axis=1))


def _fullness(nodes: Array, cells: IntArray) -> Array:
    """Volume of each cell (M) between its corners, by the cube of its longest edge."""
    first, second = SIMPLEX_EDGES[4].T
    longest = np.linalg.norm(nodes[cells[:, first]] - nodes[cells[:, second]], axis=2).max(axis=1)
    sides = nodes[cells[:, 1:4]] - nodes[cells[:, :1]]
    return np.asarray(np.abs(np.linalg.det(sides)) / 6.0 / longest**3)
