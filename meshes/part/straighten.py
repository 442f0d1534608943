"""Straightening of folded second-order tetrahedra. As few elements as possible are straightened.

If two facets of an element lie on one smooth face, or on tangent faces, they are in one plane at
the ends of their common edge, and the Jacobian vanishes there. Such an element integrates
accurately nevertheless, and straight edges would cut off a fillet. Only elements that are folded at
quadrature points are therefore straightened.
"""

import numpy as np
from numpy.typing import NDArray

from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError
from lumped.text import counted
from meshes.elements import SIMPLEX_EDGES
from meshes.shape_functions import gradients, quadrature

# Ratio of smallest to largest Jacobian below which a cell is folded or has an inaccurate stiffness.
_FOLDED = 0.03
# Ratio of the volume to the cube of the longest edge below which a cell is flat within round-off.
_FLAT = 1e-8
# Degree of the quadrature that integrates the mass of a curved element exactly.
_DEGREE = 7
_ROUNDS = 10


def straightened(nodes: Array, cells: IntArray) -> tuple[Array, int]:
    """Nodes (N×3, in m) after straightening folded tet10 `cells`, and the number of these cells.

    Midside nodes are moved half way between the corners. Neighbours that share these edges may
    become folded and are straightened, too. Raises ComputationError if a cell is inverted or flat
    although its edges are straight.
    """
    straight = np.zeros(len(cells), dtype=bool)
    for _ in range(_ROUNDS):
        folded = are_folded(nodes[cells])
        new = folded & ~straight
        if not new.any():
            break
        nodes = nodes.copy()
        straight |= new
        for middle, (first, second) in enumerate(SIMPLEX_EDGES[4], start=4):
            ends = nodes[cells[new, first]], nodes[cells[new, second]]
            nodes[cells[new, middle]] = (ends[0] + ends[1]) / 2.0
    inverted, flat = _jacobian_ratio(nodes[cells]) <= 0.0, _volume_ratio(nodes, cells) < _FLAT
    for wrong, singular, plural in (
        (inverted, "tetrahedron stays inverted", "tetrahedra stay inverted"),
        (flat, "tetrahedron is flat", "tetrahedra are flat"),
    ):
        faulty = np.flatnonzero(wrong)
        if faulty.size:
            x, y, z = nodes[cells[faulty[0]]].mean(axis=0)
            raise ComputationError(
                f"mesh of the part: {counted(faulty.size, singular, plural)}, the first at "
                f"({x:.4g}, {y:.4g}, {z:.4g}) m; a finer mesh is needed there"
            )
    return nodes, int(straight.sum())


def are_folded(positions: Array) -> NDArray[np.bool_]:
    """Flags (M) of M tet10: True if folded or nearly folded.

    `positions` (M×10×3, in m) are those of their nodes.
    """
    return np.asarray(_jacobian_ratio(positions) < _FOLDED)


def _jacobian_ratio(positions: Array) -> Array:
    """Ratio (M) of the smallest to the largest absolute Jacobian in each of M cells, at most 1.

    `positions` (M×10×3, in m) are the nodes of the cells. The Jacobians are those at quadrature
    points.
    """
    points, _ = quadrature("tet10", _DEGREE)
    slopes = gradients("tet10", points)
    jacobians = np.einsum("mki,kjq->mqij", positions, slopes, optimize=True)
    determinants = np.linalg.det(jacobians)
    return np.asarray(determinants.min(axis=1) / np.abs(determinants).max(axis=1))


def _volume_ratio(nodes: Array, cells: IntArray) -> Array:
    """Ratio (M) of each cell's volume to the cube of its longest edge, with straight edges."""
    first, second = SIMPLEX_EDGES[4].T
    longest = np.linalg.norm(nodes[cells[:, first]] - nodes[cells[:, second]], axis=2).max(axis=1)
    sides = nodes[cells[:, 1:4]] - nodes[cells[:, :1]]
    return np.asarray(np.abs(np.linalg.det(sides)) / 6.0 / longest**3)
