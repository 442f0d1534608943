"""Surfaces of prisms over any polygon with holes: walls along edges, triangles at the ends.

Input: closed lines (m) and stations along x. Output: a `Surface`.
"""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.sections.outlined import twice_area
from validation.drawing.surfaces import Surface, joined

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
