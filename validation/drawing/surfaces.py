"""Legs as surfaces, straight and deformed, and where their points come to lie in a picture."""

from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array, IntArray


@dataclass(frozen=True)
class Surface:
    """Points (n×3, m, robot axes), quadrangles (q×4 point numbers), one value per point or none.

    `motion` (n×3, m) is how far the points are drawn from where they are at rest, if they move.
    """

    points: Array
    faces: IntArray
    values: Array | None = None
    motion: Array | None = None


def prism_points(corners: Array, stations: Array) -> Array:
    """Points (m·k × 3, leg axes) of k `corners` (k×2) at m `stations` (m from the root)."""
    along = np.repeat(stations, len(corners))
    return np.column_stack([along, np.tile(corners, (len(stations), 1))])


def prism_faces(corners: int, stations: int) -> IntArray:
    """Quadrangles (q×4) of the side of a prism of `prism_points`, normals outwards; ends open."""
    ring = np.arange(corners)
    following = np.roll(ring, -1)
    first = np.column_stack([ring, following, following + corners, ring + corners])
    return (first + corners * np.arange(stations - 1)[:, None, None]).reshape(-1, 4)


def end_faces(corners: int, stations: int) -> IntArray:
    """Quadrangles (2(k/2 − 1) × 4) that close both ends; k even."""
    strips = [
        [start, start + 1, corners - 2 - start, corners - 1 - start]
        for start in range(corners // 2 - 1)
    ]
    tip = np.array(strips) + corners * (stations - 1)
    root = np.array(strips)[:, ::-1]
    return np.vstack([root, tip])


def edges(corners: int, stations: int) -> IntArray:
    """Pairs (e×2) of point numbers along the long edges and both rims; a circle has rims alone."""
    ring = np.arange(corners)
    rim = np.column_stack([ring, np.roll(ring, -1)])
    kept = ring if corners <= 4 else ring[:: corners // 4]
    steps = corners * np.arange(stations - 1)[:, None] + kept
    long = np.column_stack([steps.ravel(), steps.ravel() + corners])
    return np.vstack([rim, rim + corners * (stations - 1), long])


def frames(corners: int, stations: int) -> IntArray:
    """Pairs (e×2) of point numbers along the rim of every station and the long edges."""
    ring = np.arange(corners)
    rim = np.column_stack([ring, np.roll(ring, -1)])
    rims = (rim + corners * np.arange(stations)[:, None, None]).reshape(-1, 2)
    return np.vstack([rims, edges(corners, stations)])


def readable_factor(largest: float, wanted: float) -> float:
    """Factor 1, 2 or 5 · 10ᵏ that brings `largest` closest below `wanted` (same unit).

    1 where nothing moves.
    """
    if not largest > 0.0:
        return 1.0
    exact = wanted / largest
    decade = 10.0 ** np.floor(np.log10(exact))
    steps = np.array([1.0, 2.0, 5.0])
    # Rounding must not turn an exact 5 into 2.
    return float(steps[steps * decade <= exact * (1.0 + 1e-12)][-1] * decade)


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
