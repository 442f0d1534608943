"""A box as a surface, for pictures of which every pixel is known."""

import numpy as np

from lumped.arrays import Array
from validation.drawing.surfaces import Surface, faceted


def box(low: Array, high: Array) -> Surface:
    """Box (m) between two corners, edges along the axes."""
    ring = [(0, 0), (1, 0), (1, 1), (0, 1)]
    corners = np.array([(x, y, z) for z in (0, 1) for x, y in ring])
    faces = [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]]
    return faceted(np.where(corners == 1, high, low).astype(float), [np.array([f]) for f in faces])
