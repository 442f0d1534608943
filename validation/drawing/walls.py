"""Prisms of any polygon with holes as surfaces: walls along every edge, ends cut into triangles."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from lumped.arrays import Array, IntArray
from validation.drawing.surfaces import Surface, joined

# Share of the polygon's area beneath which three corners lie on a line.
_FLAT = 1e-12


def walled(loops: Sequence[Array], stations: Array, *, rims: bool = False) -> Surface:
    """A prism along x of an outline and its holes (k×2 each, y and z), cut at `stations` (m).

    The outline runs counter-clockwise, holes clockwise: normals point outwards. Its edges are the
    rims of both ends, or of all stations, and those along it.
    """
    sides = [_wall(loop, stations, rims=rims) for loop in loops]
    corners = np.vstack(loops)
    triangles = end_triangles(loops)
    none = np.zeros((0, 2), dtype=np.int64)
    ends = [
        Surface(np.column_stack([np.full(len(corners), x), corners]), faces, none)
        for x, faces in (
            (stations[0], triangles[:, [2, 1, 0, 0]]),
            (stations[-1], triangles[:, [0, 1, 2, 2]]),
        )
    ]
    return joined([*sides, *ends])


def _wall(loop: Array, stations: Array, *, rims: bool) -> Surface:
    """The faces along one closed line."""
    count, last = len(loop), len(stations) - 1
    ring = np.arange(count)
    following = np.roll(ring, -1)
    first = np.column_stack([ring, following, following + count, ring + count])
    faces = (first + count * np.arange(last)[:, None, None]).reshape(-1, 4)
    kept = range(last + 1) if rims else (0, last)
    edges = [np.column_stack([ring, following]) + count * number for number in kept]
    edges += [np.column_stack([ring, ring + count]) + count * number for number in range(last)]
    points = np.column_stack([np.repeat(stations, count), np.tile(loop, (last + 1, 1))])
    return Surface(points, faces, np.vstack(edges))


def end_triangles(loops: Sequence[Array]) -> IntArray:
    """Triangles (t×3, counter-clockwise) that fill a polygon with holes, of its corners alone.

    Holes are joined to the outline by double edges, then ears are cut off (G. H. Meisters, Amer.
    Math. Monthly 82 (1975) 648).
    """
    corners = np.vstack(loops)
    begun = np.cumsum([0, *(len(loop) for loop in loops)])
    rings = [list(range(a, b)) for a, b in pairwise(begun.tolist())]
    ring, holes = rings[0], rings[1:]
    # The hole that reaches farthest along y first: nothing lies between it and the outline.
    for hole in sorted(holes, key=lambda one: -float(corners[one, 0].max())):
        ring = _joined_ring(corners, ring, hole)
    return np.array(_ears(corners, ring), dtype=np.int64).reshape(-1, 3)


def _joined_ring(corners: Array, ring: list[int], hole: list[int]) -> list[int]:
    """The ring that goes over to a hole at its farthest corner along y, around it, and back."""
    first = int(np.argmax(corners[hole, 0]))
    turned = hole[first:] + hole[:first]
    start = corners[turned[0]]
    distances = np.linalg.norm(corners[ring] - start, axis=1)
    for place in np.argsort(distances, kind="stable").tolist():
        if _sees(corners, ring, start, corners[ring[place]]):
            return [*ring[: place + 1], *turned, turned[0], *ring[place:]]
    return ring


def _sees(corners: Array, ring: list[int], start: Array, end: Array) -> bool:
    """Whether no edge of the ring lies across the way from `start` to `end`."""
    a, b = corners[ring], corners[ring[1:] + ring[:1]]
    across = _twice_area(start, end, a) * _twice_area(start, end, b) < 0.0
    along = _twice_area(a, b, start) * _twice_area(a, b, end) < 0.0
    return not bool((across & along).any())


def _ears(corners: Array, ring: list[int]) -> list[tuple[int, int, int]]:
    left, found = list(ring), []
    size = float(np.prod(np.ptp(corners, axis=0)))
    while len(left) > 2:
        for k in range(len(left)):
            ear = left[k - 1], left[k], left[(k + 1) % len(left)]
            a, b, c = (corners[number] for number in ear)
            area = float(_twice_area(a, b, c))
            if abs(area) <= _FLAT * size:
                break
            others = [number for number in left if number not in ear]
            if area > 0.0 and not _holds(a, b, c, corners[others]):
                found.append(ear)
                break
        else:
            # Rounding has left no ear.
            break
        left.pop(k)
    return found


def _holds(a: Array, b: Array, c: Array, points: Array) -> bool:
    """Whether one of the points lies in a triangle or on its rim, its corners not counted."""
    sides = (_twice_area(p, q, points) for p, q in ((a, b), (b, c), (c, a)))
    inside = np.logical_and.reduce([side >= 0.0 for side in sides])
    corner = [(points == p).all(axis=1) for p in (a, b, c)]
    return bool((inside & ~np.logical_or.reduce(corner)).any())


def _twice_area(a: Array, b: Array, c: Array) -> Array:
    """Twice the area of triangles, positive counter-clockwise."""
    u, v = b - a, c - a
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
