"""Surfaces of quadrilaterals for pictures: prisms, balls and plates.

Input: outlines and stations (m). Output: a `Surface` of points, faces and drawn edges.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lumped.arrays import Array, IntArray

# Number of circles of latitude of a ball, and of corners of a circle.
_RINGS, _FACETS = 9, 20


@dataclass(frozen=True, eq=False)
class Surface:
    """Points (n×3, m), quadrilaterals (q×4 point indices) and drawn edges (e×2 point indices).

    A triangle is a quadrilateral with its last corner repeated.
    """

    points: Array
    faces: IntArray
    edges: IntArray

    def placed(self, origin: Array, rotation: Array) -> "Surface":
        """Surface rotated by `rotation` (3×3), then moved by `origin` (3, m)."""
        return replace(self, points=origin + self.points @ rotation.T)

    def moved(self, displacements: Array) -> "Surface":
        """Surface with displaced points. `displacements` (n×3, m)."""
        return replace(self, points=self.points + displacements)


def prism(
    corners: Array, stations: Array, bore: Array | None = None, *, rims: bool = False
) -> Surface:
    """Prism along x with an outline of k `corners` (k×2: y, z; k even), normals outwards.

    It is divided at `stations` (m). A `bore` (k×2) is open at both ends. Drawn edges are the
    outlines of both ends, or of all stations with `rims`, and at most four lines along the prism.
    """
    count, last = len(corners), len(stations) - 1
    sides = _sides(count, len(stations))
    ring = np.arange(count)
    outlined = [0, *range(1, last), last] if rims else [0, last]
    edges = [np.column_stack([ring, np.roll(ring, -1)]) + count * number for number in outlined]
    lengthwise = ring if count <= 4 else ring[:: count // 4]
    edges += [np.column_stack([lengthwise, lengthwise + count]) + count * k for k in range(last)]
    points = _along(corners, stations)
    if bore is None:
        strips = np.array([[k, k + 1, count - 2 - k, count - 1 - k] for k in range(count // 2 - 1)])
        caps = [strips[:, ::-1], strips + count * last]
    else:
        # End faces between the outline and the bore, whose points come last.
        following, inner = np.roll(ring, -1), len(points)
        points = np.vstack([points, _along(bore, stations[[0, -1]])])
        near = np.column_stack([following, ring, inner + ring, inner + following])
        far = np.column_stack([ring, following, following + inner, ring + inner])
        caps = [near, far + np.array([1, 1, 0, 0]) * count * last + np.array([0, 0, 1, 1]) * count]
    return Surface(points, np.vstack([sides, *caps]), np.vstack(edges))


def ball(radius: float) -> Surface:
    """Ball of a `radius` (m) about the origin, normals outwards."""
    polar_angles = np.linspace(np.pi, 0.0, _RINGS)
    rings = [
        radius * np.column_stack([np.sin(angle) * circle(1.0), np.full(_FACETS, np.cos(angle))])
        for angle in polar_angles
    ]
    return Surface(np.vstack(rings), _sides(_FACETS, _RINGS), np.zeros((0, 2), dtype=np.int64))


def plate(rim: Array) -> Surface:
    """Flat polygon with corners `rim` (n×3, m). The mean of the corners must lie inside it."""
    count = len(rim)
    ring = np.arange(count)
    edges = np.column_stack([ring, np.roll(ring, -1)])
    faces = np.column_stack([np.full(count, count), edges, edges[:, 1]])
    return Surface(np.vstack([rim, rim.mean(axis=0)]), faces, edges)


def faceted(points: Array, faces: Sequence[IntArray]) -> Surface:
    """Surface of several faces, whose rims are drawn as edges.

    Each face consists of f triangles (c = 3) or quadrilaterals (c = 4): f×c point indices.
    """
    return Surface(
        points,
        np.vstack([face[:, [0, 1, 2, -1]] for face in faces]),
        np.vstack([_rim(face) for face in faces]),
    )


def _rim(corners: IntArray) -> IntArray:
    """Edges (e×2 point indices) of a face that belong to only one of its facets (f×c)."""
    sides = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, counts = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    return np.asarray(edges[counts == 1])


def joined(surfaces: Sequence[Surface]) -> Surface:
    """One surface that consists of several."""
    offsets = np.cumsum([0, *(len(surface.points) for surface in surfaces)])[:-1]
    return Surface(
        np.vstack([surface.points for surface in surfaces]),
        np.vstack([surface.faces + k for surface, k in zip(surfaces, offsets, strict=True)]),
        np.vstack([surface.edges + k for surface, k in zip(surfaces, offsets, strict=True)]),
    )


def circle(radius: float) -> Array:
    """Corners (n×2, m) of a regular polygon that approximates a circle."""
    angles = 2.0 * np.pi * np.arange(_FACETS) / _FACETS
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def rectangle(width: float, height: float) -> Array:
    """Corners (4×2, m) of a rectangle about the origin."""
    return 0.5 * np.array([[-width, -height], [width, -height], [width, height], [-width, height]])


def _along(corners: Array, stations: Array) -> Array:
    x = np.repeat(stations, len(corners))
    return np.column_stack([x, np.tile(corners, (len(stations), 1))])


def _sides(corners: int, stations: int) -> IntArray:
    ring = np.arange(corners)
    following = np.roll(ring, -1)
    first = np.column_stack([ring, following, following + corners, ring + corners])
    return (first + corners * np.arange(stations - 1)[:, None, None]).reshape(-1, 4)
