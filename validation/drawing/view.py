"""A parallel projection: where points of the robot come to lie in a picture."""

from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array


@dataclass(frozen=True)
class View:
    """Camera at infinity.

    Unit vectors `right`, `up`, `toward` (to the viewer); `centre` (3, m) is shown in the middle of
    a picture of `size` pixels (width, height), which shows `half_height` (m) above and below it.
    """

    right: Array
    up: Array
    toward: Array
    centre: Array
    half_height: float
    size: tuple[int, int]


def fitted_view(
    points: Array, toward: Array, up: Array, size: tuple[int, int], margin: float = 0.06
) -> View:
    """The view from `toward` (3) that shows all `points` (n×3, m); `up` (3) points upwards.

    `margin` is the free share of the picture on each side.
    """
    toward = np.asarray(toward, dtype=float) / np.linalg.norm(toward)
    right = np.cross(up, toward)
    right /= np.linalg.norm(right)
    upwards = np.cross(toward, right)
    plane = points @ np.column_stack([right, upwards])
    low, high = plane.min(axis=0), plane.max(axis=0)
    middle = (low + high) / 2.0
    width, height = size
    half = np.maximum((high - low) / 2.0, 1e-9) / (1.0 - 2.0 * margin)
    depth = float(np.mean(points @ toward))
    return View(
        right=right,
        up=upwards,
        toward=toward,
        centre=middle[0] * right + middle[1] * upwards + depth * toward,
        half_height=float(max(half[1], half[0] * height / width)),
        size=size,
    )


def pixels(view: View, points: Array) -> Array:
    """Pixel coordinates (n×2, from the left and from the top) of points (n×3, m)."""
    offset = np.asarray(points, dtype=float) - view.centre
    scale = view.size[1] / (2.0 * view.half_height)
    x = view.size[0] / 2.0 + scale * (offset @ view.right)
    y = view.size[1] / 2.0 - scale * (offset @ view.up)
    return np.column_stack([x, y])
