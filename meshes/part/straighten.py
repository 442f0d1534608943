"""Folded second-order tetrahedra given straight edges, as few as need be."""

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.errors import ComputationError
from meshes.quality import quality
from meshes.solid_mesh import VolumeMesh

# Corners at the ends of the edges whose middles are nodes 4 to 9.
_EDGES = np.array([(0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)])
# A scaled Jacobian below this: the element is folded, or so nearly that its stiffness means little.
_FOLDED = 0.01
_ROUNDS = 10


def straightened(nodes: Array, cells: IntArray) -> tuple[Array, int]:
    """Nodes (N×3) with the middles of folded tet10 `cells` put half way; how many cells that were.

    Neighbours share the edges and may fold for it: they follow. An element that is no better for
    it is a sliver of the straight mesh, and stays. Raises ComputationError where one is inverted
    with straight edges.
    """
    straight = np.zeros(len(cells), dtype=bool)
    for _ in range(_ROUNDS):
        bad = quality(VolumeMesh(nodes, cells, "tet10")).scaled_jacobian < _FOLDED
        new = bad & ~straight
        if not new.any():
            break
        nodes = nodes.copy()
        straight |= new
        for middle, (first, second) in enumerate(_EDGES, start=4):
            ends = nodes[cells[new, first]], nodes[cells[new, second]]
            nodes[cells[new, middle]] = (ends[0] + ends[1]) / 2.0
    inverted = np.flatnonzero(quality(VolumeMesh(nodes, cells, "tet10")).scaled_jacobian <= 0.0)
    if inverted.size:
        x, y, z = nodes[cells[inverted[0]]].mean(axis=0)
        raise ComputationError(
            f"mesh of the part: {inverted.size} tetrahedra stay inverted, the first at "
            f"({x:.4g}, {y:.4g}, {z:.4g}) m; a finer mesh is needed there"
        )
    return nodes, int(straight.sum())
