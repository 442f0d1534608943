"""How far faces, edges and corners of a CAD solid are apart where they should meet.

The kernel closes such gaps without a word: it holds a shape for closed whose faces, edges and
corners name each other, wherever they lie.
"""

from types import ModuleType

import numpy as np

from lumped.arrays import Array

# Points along an edge, ends included.
_POINTS = 9


def largest_gap(gmsh: ModuleType, solid: int) -> tuple[float, Array]:
    """The largest gap (m) of a solid of the current model, and where it is (3, m).

    Edges in space against the same edges on the surfaces of their faces, corners against the ends
    of their edges.
    """
    model = gmsh.model
    worst, place = 0.0, np.zeros(3)
    for _, face in model.getBoundary([(3, solid)], oriented=False):
        for _, edge in model.getBoundary([(2, face)], combined=False, oriented=False):
            (low,), (high,) = model.getParametrizationBounds(1, edge)
            along = np.linspace(low, high, _POINTS)
            curve = np.reshape(model.getValue(1, edge, along), (-1, 3))
            on_face = model.reparametrizeOnSurface(1, edge, along, face)
            off = curve - np.reshape(model.getValue(2, face, on_face), (-1, 3))
            gap = float(np.linalg.norm(off, axis=1).max())
            ends = model.getBoundary([(1, edge)], combined=False, oriented=False)
            if ends:
                corners = np.array([model.getValue(0, corner, []) for _, corner in ends])
                apart = np.linalg.norm(corners[:, None] - curve[[0, -1]], axis=2)
                gap = max(gap, float(apart.min(axis=0).max()), float(apart.min(axis=1).max()))
            if not gap <= worst:
                worst, place = gap, curve.mean(axis=0)
    return worst, place
