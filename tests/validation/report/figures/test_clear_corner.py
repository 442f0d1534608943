"""The axes' triad stands where no body is drawn."""

import numpy as np

from validation.drawing.rendering import Body, Scene, clear_corner
from validation.drawing.surfaces import Surface, fitted_view

ABOVE = np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
# A cross of points as wide as the picture, and patches of points in its corners.
CROSS = np.array([[x, 0.0, 0.0] for x in np.linspace(-1, 1, 41)])
CROSS = np.vstack([CROSS, CROSS[:, [1, 0, 2]]])


def scene(*corners):
    patch = np.array([[x, y, 0.0] for x in np.linspace(0.6, 1, 9) for y in np.linspace(0.6, 1, 9)])
    points = np.vstack([CROSS, *(patch * [x, y, 1.0] for x, y in corners)])
    view = fitted_view(points, *ABOVE, (600, 600), margin=0.07)
    return Scene(view, [Body(Surface(points, np.zeros((0, 3), dtype=int)), "grey")], (0.0, 1.0))


def test_the_first_corner_that_is_free():
    """Pictures count from above: the first place is below, at the left."""
    below_left, below_right, above_left = (-1, -1), (1, -1), (-1, 1)
    first = clear_corner(scene())
    second = clear_corner(scene(below_left))
    third = clear_corner(scene(below_left, below_right))
    last = clear_corner(scene(below_left, below_right, above_left))
    assert first[0] < 0.5 < first[1]
    assert second[0] > 0.5
    assert second[1] > 0.5
    assert third[0] < 0.5
    assert third[1] < 0.5
    assert last[0] > 0.5
    assert last[1] < 0.5
