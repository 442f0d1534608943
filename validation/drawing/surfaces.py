"""Surfaces of points and quadrangles: prisms, balls and plates; arrays in, arrays out."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from lumped.arrays import Array, IntArray

_RINGS, _FACETS = 9, 20


@dataclass(frozen=True, eq=False)
class Surface:
    """Points (n×3, m), quadrangles (q×4 point numbers) and the edges (e×2) that are drawn as lines.

    A triangle is a quadrangle that has its last corner twice.
    """

    points: Array
    faces: IntArray
    edges: IntArray

    def placed(self, origin: Array, rotation: Array) -> "Surface":
        """In the axes in which its own are `rotation` (3×3) at `origin` (3, m)."""
        return replace(self, points=origin + self.points @ rotation.T)

    def moved(self, displacements: Array) -> "Surface":
        """With its points displaced (n×3, m)."""
        return replace(self, points=self.points + displacements)


def prism(
    corners: Array, stations: Array, bore: Array | None = None, *, rims: bool = False
) -> Surface:
    """A prism along x with an outline of k `corners` (k×2, y and z, k even), normals outwards.

    Cut at `stations` (m); a `bore` (k×2) is seen at both ends. Its edges are the rims of both ends,
    or of all stations, and four or fewer along it.
    """
    count, last = len(corners), len(stations) - 1
    sides = _sides(count, len(stations))
    ring = np.arange(count)
    kept = [0, *range(1, last), last] if rims else [0, last]
    edges = [np.column_stack([ring, np.roll(ring, -1)]) + count * number for number in kept]
    lengthwise = ring if count <= 4 else ring[:: count // 4]
    edges += [np.column_stack([lengthwise, lengthwise + count]) + count * k for k in range(last)]
    points = _along(corners, stations)
    if bore is None:
        strips = np.array([[k, k + 1, count - 2 - k, count - 1 - k] for k in range(count // 2 - 1)])
        caps = [strips[:, ::-1], strips + count * last]
    else:
        # Between the outline's rims and those of the bore, which come after all other points.
        following, inner = np.roll(ring, -1), len(points)
        points = np.vstack([points, _along(bore, stations[[0, -1]])])
        near = np.column_stack([following, ring, inner + ring, inner + following])
        far = np.column_stack([ring, following, following + inner, ring + inner])
        caps = [near, far + np.array([1, 1, 0, 0]) * count * last + np.array([0, 0, 1, 1]) * count]
    return Surface(points, np.vstack([sides, *caps]), np.vstack(edges))


def ball(radius: float) -> Surface:
    """A ball (m) about the origin, normals outwards."""
    turn = np.linspace(np.pi, 0.0, _RINGS)
    rings = [
        radius * np.column_stack([np.sin(t) * circle(1.0), np.full(_FACETS, np.cos(t))])
        for t in turn
    ]
    return Surface(np.vstack(rings), _sides(_FACETS, _RINGS), np.zeros((0, 2), dtype=np.int64))


def plate(rim: Array) -> Surface:
    """A flat polygon (n×3, m) with its middle within."""
    count = len(rim)
    ring = np.arange(count)
    edges = np.column_stack([ring, np.roll(ring, -1)])
    faces = np.column_stack([np.full(count, count), edges, edges[:, 1]])
    return Surface(np.vstack([rim, rim.mean(axis=0)]), faces, edges)


def faceted(points: Array, faces: Sequence[IntArray]) -> Surface:
    """Faces of triangles or quadrangles (f×c point numbers each), with the edges between them."""
    return Surface(
        points,
        np.vstack([face[:, [0, 1, 2, -1]] for face in faces]),
        np.vstack([_rim(face) for face in faces]),
    )


def _rim(corners: IntArray) -> IntArray:
    """Edges (e×2) of the facets (f×c) of a face that one of them alone has."""
    sides = np.stack([corners, np.roll(corners, -1, axis=1)], axis=2).reshape(-1, 2)
    edges, counts = np.unique(np.sort(sides, axis=1), axis=0, return_counts=True)
    return np.asarray(edges[counts == 1])


def joined(surfaces: Sequence[Surface]) -> Surface:
    """Several as one."""
    begun = np.cumsum([0, *(len(one.points) for one in surfaces)])
    return Surface(
        np.vstack([one.points for one in surfaces]),
        np.vstack([one.faces + k for one, k in zip(surfaces, begun[:-1], strict=True)]),
        np.vstack([one.edges + k for one, k in zip(surfaces, begun[:-1], strict=True)]),
    )


def circle(radius: float) -> Array:
    """Corners (n×2, m) of a polygon in place of a circle."""
    angles = 2.0 * np.pi * np.arange(_FACETS) / _FACETS
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def rectangle(width: float, height: float) -> Array:
    """Corners (4×2, m)."""
    return 0.5 * np.array([[-width, -height], [width, -height], [width, height], [-width, height]])


def _along(corners: Array, stations: Array) -> Array:
    along = np.repeat(stations, len(corners))
    return np.column_stack([along, np.tile(corners, (len(stations), 1))])


def _sides(corners: int, stations: int) -> IntArray:
    ring = np.arange(corners)
    following = np.roll(ring, -1)
    first = np.column_stack([ring, following, following + corners, ring + corners])
    return (first + corners * np.arange(stations - 1)[:, None, None]).reshape(-1, 4)
