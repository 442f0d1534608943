"""Surfaces of quadrilaterals for pictures: prisms, balls and plates.

Input: outlines with holes, and stations (m). Output: a `Surface` of points, faces and drawn edges.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.sections.outlined import twice_area

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


# Area of a triangle over that of the polygon's extent, below which its corners lie on a line.
_FLAT = 1e-12


def walled(loops: Sequence[Array], stations: Array, *, rims: bool = False) -> Surface:
    """Prism along x of an outline and its holes (k×2 each: y, z), divided at `stations` (m).

    The outline runs counter-clockwise, holes clockwise, so that normals point outwards. Drawn edges
    are the outlines of both ends, or of all stations with `rims`, and the lines along the prism.
    """
    sides = [_wall(loop, stations, rims=rims) for loop in loops]
    corners = np.vstack(loops)
    triangles = end_triangles(loops)
    no_edges = np.zeros((0, 2), dtype=np.int64)
    ends = [
        Surface(np.column_stack([np.full(len(corners), x), corners]), faces, no_edges)
        for x, faces in (
            (stations[0], triangles[:, [2, 1, 0, 0]]),
            (stations[-1], triangles[:, [0, 1, 2, 2]]),
        )
    ]
    return joined([*sides, *ends])


def _wall(loop: Array, stations: Array, *, rims: bool) -> Surface:
    """Faces of the prism along one closed line."""
    count, last = len(loop), len(stations) - 1
    ring = np.arange(count)
    following = np.roll(ring, -1)
    first = np.column_stack([ring, following, following + count, ring + count])
    faces = (first + count * np.arange(last)[:, None, None]).reshape(-1, 4)
    outlined = range(last + 1) if rims else (0, last)
    edges = [np.column_stack([ring, following]) + count * number for number in outlined]
    edges += [np.column_stack([ring, ring + count]) + count * number for number in range(last)]
    points = np.column_stack([np.repeat(stations, count), np.tile(loop, (last + 1, 1))])
    return Surface(points, faces, np.vstack(edges))


def end_triangles(loops: Sequence[Array]) -> IntArray:
    """Triangles (t×3 corner indices, counter-clockwise) that fill a polygon with holes.

    Holes are joined to the outline by double edges, then ears are cut off (G. H. Meisters, Amer.
    Math. Monthly 82 (1975) 648).
    """
    corners = np.vstack(loops)
    offsets = np.cumsum([0, *(len(loop) for loop in loops)])
    rings = [list(range(start, end)) for start, end in pairwise(offsets.tolist())]
    ring, holes = rings[0], rings[1:]
    # The hole that extends farthest along y is joined first, because no other hole lies between it
    # and the outline.
    for hole in sorted(holes, key=lambda indices: -float(corners[indices, 0].max())):
        ring = _joined_ring(corners, ring, hole)
    return np.array(_ears(corners, ring), dtype=np.int64).reshape(-1, 3)


def _joined_ring(corners: Array, ring: list[int], hole: list[int]) -> list[int]:
    """Ring of indices, joined to a hole by a double edge at the hole's corner of largest y."""
    first = int(np.argmax(corners[hole, 0]))
    from_first = hole[first:] + hole[:first]
    start = corners[from_first[0]]
    distances = np.linalg.norm(corners[ring] - start, axis=1)
    for index in np.argsort(distances, kind="stable").tolist():
        if _is_visible(corners, ring, start, corners[ring[index]]):
            return [*ring[: index + 1], *from_first, from_first[0], *ring[index:]]
    return ring


def _is_visible(corners: Array, ring: list[int], start: Array, end: Array) -> bool:
    """True if no edge of the ring intersects the line from `start` to `end`."""
    a, b = corners[ring], corners[ring[1:] + ring[:1]]
    across = twice_area(start, end, a) * twice_area(start, end, b) < 0.0
    along = twice_area(a, b, start) * twice_area(a, b, end) < 0.0
    return not bool((across & along).any())


def _ears(corners: Array, ring: list[int]) -> list[tuple[int, int, int]]:
    """Triangles (corner indices) of a ring, cut off one after the other."""
    remaining, ears = list(ring), []
    size = float(np.prod(np.ptp(corners, axis=0)))
    while len(remaining) > 2:
        for k in range(len(remaining)):
            ear = remaining[k - 1], remaining[k], remaining[(k + 1) % len(remaining)]
            a, b, c = (corners[number] for number in ear)
            area = float(twice_area(a, b, c))
            if abs(area) <= _FLAT * size:
                break
            outside_ear = [number for number in remaining if number not in ear]
            if area > 0.0 and not _contains(a, b, c, corners[outside_ear]):
                ears.append(ear)
                break
        else:
            # Because of round-off, no further ear is found.
            break
        remaining.pop(k)
    return ears


def _contains(a: Array, b: Array, c: Array, points: Array) -> bool:
    """True if any of the `points` other than a, b and c lies in this triangle or on its rim."""
    sides = (twice_area(p, q, points) for p, q in ((a, b), (b, c), (c, a)))
    inside = np.logical_and.reduce([side >= 0.0 for side in sides])
    corner = [(points == p).all(axis=1) for p in (a, b, c)]
    return bool((inside & ~np.logical_or.reduce(corner)).any())
