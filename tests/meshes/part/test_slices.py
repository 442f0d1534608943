"""Plane sections of a part: outlines, holes and islands by depth of nesting."""

import numpy as np

from meshes.part.boundary import Facets
from meshes.part.slices import slices_of

# Corners of a unit square, and the triangles of the walls over it from x = 0 to x = 1.
SQUARE = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]])


def walls(side, first, centre=(0.0, 0.0)):
    """Return nodes and triangles of a square tube along x with node numbers from `first` on."""
    outline = side * SQUARE + centre
    nodes = np.vstack([np.column_stack([np.full(4, x), outline]) for x in (0.0, 1.0)])
    cells = [
        triangle
        for k in range(4)
        for triangle in ((k, (k + 1) % 4, k + 4), ((k + 1) % 4, (k + 1) % 4 + 4, k + 4))
    ]
    return nodes, first + np.array(cells)


def section_of(*tubes):
    nodes, cells = zip(
        *(walls(side, 8 * k, centre) for k, (side, centre) in enumerate(tubes)), strict=True
    )
    facets = Facets(cells=np.vstack(cells), element="tri3")
    return slices_of(np.vstack(nodes), facets, np.array([0.5, 0.0, 0.0]), np.eye(3))


def test_island_in_hole_is_separate_section():
    """Outline 4 × 4 m with hole 3 × 3, and in it an island 2 × 2 with hole 1 × 1: 7 and 3 m²."""
    pieces = section_of(*((side, (0.0, 0.0)) for side in (4.0, 3.0, 2.0, 1.0)))
    areas_and_holes = sorted((piece.area, len(piece.holes)) for piece in pieces)
    np.testing.assert_allclose(areas_and_holes, [(3.0, 1), (7.0, 1)], rtol=1e-12)


def test_two_holes_are_in_one_section():
    """Outline 4 × 4 m with two holes of 1 × 1 m at y = ±1 m."""
    (piece,) = section_of((4.0, (0.0, 0.0)), (1.0, (1.0, 0.0)), (1.0, (-1.0, 0.0)))
    assert len(piece.holes) == 2
    np.testing.assert_allclose(piece.area, 14.0, rtol=1e-12)
    # ∫z² dA = 4⁴/12 − 2/12, ∫y² dA = 4⁴/12 − 2 (1/12 + 1).
    expected = [256.0 / 12.0 - 2.0 * 13.0 / 12.0, 256.0 / 12.0 - 2.0 / 12.0]
    np.testing.assert_allclose(piece.measures[2:], expected, rtol=1e-12)
