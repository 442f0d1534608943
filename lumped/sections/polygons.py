"""Polygons as outlines of sections: angles, points inside, wall thickness, edges of regions."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array, IntArray

# Points (n×2, y and z) of a closed boundary line. The section lies to the left of the line.
Loop: TypeAlias = Array
# Distance, as a fraction of the section's size, below which two vertices count as one.
TOUCHING = 1e-6
# Angle (rad) above π from which a corner is re-entrant: above round-off.
_REENTRANT = 1e-6


@dataclass(frozen=True, eq=False)
class Partition:
    """The e edges of several regions. An edge that two regions share occurs once.

    `vertices` (V×2) are the vertices of the edges, and `ends` (e×2) are the indices of the start
    and the end of each edge. `left` and `right` (e) are the indices of the regions on both sides of
    each edge, −1 if there is no region.
    """

    vertices: Array
    ends: IntArray
    left: IntArray
    right: IntArray

    def vertices_along(self, loop: Loop) -> list[int]:
        """Indices of all vertices on the closed line `loop`, in the order of its corners."""
        numbers: list[int] = []
        gap = TOUCHING * float(np.ptp(self.vertices, axis=0).max())
        for start, end in zip(loop, np.roll(loop, -1, axis=0), strict=True):
            numbers += _vertices_between(self.vertices, start, end, gap)[:-1]
        return numbers


def partition_edges(regions: Sequence[Sequence[Loop]]) -> Partition:
    """Edges of regions that do not overlap, split at all vertices that lie on them.

    Each region is given by its loops. Vertices whose distance is below `TOUCHING` times the
    section's size count as one.
    """
    corners = np.vstack([loop for loops in regions for loop in loops])
    gap = TOUCHING * float(np.ptp(corners, axis=0).max())
    vertices: list[Array] = []
    for corner in corners:
        if all(np.abs(corner - vertex).max() > gap for vertex in vertices):
            vertices.append(corner)
    places = np.array(vertices)
    sides: dict[tuple[int, int], list[int]] = {}
    for number, loops in enumerate(regions):
        for loop in loops:
            for start, end in zip(loop, np.roll(loop, -1, axis=0), strict=True):
                for a, b in pairwise(_vertices_between(places, start, end, gap)):
                    pair = sides.setdefault((min(a, b), max(a, b)), [-1, -1])
                    pair[int(a > b)] = number
    ends = np.array(list(sides))
    neighbours = np.array(list(sides.values()))
    return Partition(places, ends, neighbours[:, 0], neighbours[:, 1])


def _vertices_between(places: Array, start: Array, end: Array, gap: float) -> list[int]:
    """Indices of the points `places` (n×2) on an edge, in order from its `start` to its `end`.

    A point is on the edge if it is within `gap` of it.
    """
    edge = end - start
    length = float(np.linalg.norm(edge))
    along = (places - start) @ edge / length
    across = np.abs((places - start) @ np.array([-edge[1], edge[0]])) / length
    passed = np.flatnonzero((across <= gap) & (along >= -gap) & (along <= length + gap))
    return [int(number) for number in passed[np.argsort(along[passed])]]


def inner_angles(loop: Loop) -> Array:
    """Interior angle (n, in rad) at each corner of a closed line. The section is to its left."""
    before, after = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    return np.asarray(np.pi - np.arctan2(cross, (before * after).sum(axis=1)))


def wall_thickness(loops: Sequence[Loop]) -> float:
    """Smallest distance (m) through the section from a re-entrant corner to another edge.

    Corners of holes are re-entrant, too. Infinite for a convex outline without holes.
    """
    edges = [(loop, np.roll(loop, -1, axis=0) - loop) for loop in loops]
    starts, ways = (np.vstack(parts) for parts in zip(*edges, strict=True))
    corners = np.vstack([loop[inner_angles(loop) > np.pi + _REENTRANT] for loop in loops])
    shares = np.einsum("cej,ej->ce", corners[:, None] - starts, ways) / (ways**2).sum(axis=1)
    feet = starts + np.clip(shares, 0.0, 1.0)[..., None] * ways
    across = feet - corners[:, None]
    distances = np.linalg.norm(across, axis=2)
    # The section lies to the left of an edge. A line through it arrives at the edge from there.
    leaves = across[..., 0] * ways[:, 1] - across[..., 1] * ways[:, 0]
    through = leaves > _REENTRANT * distances * np.linalg.norm(ways, axis=1)
    # A corner lies on its own edges.
    through &= distances > TOUCHING * np.ptp(starts, axis=0).max()
    return float(distances[through].min(initial=np.inf))


def is_inside(loops: Sequence[Loop], point: Array) -> bool:
    """True if a point lies within closed lines.

    A ray from the point along +y then crosses the lines an odd number of times.
    """
    crossings = 0
    for loop in loops:
        y, z = (loop - point).T
        next_y, next_z = np.roll(y, -1), np.roll(z, -1)
        crossed = (z > 0.0) != (next_z > 0.0)
        crossing_y = y - z * (next_y - y) / np.where(crossed, next_z - z, 1.0)
        crossings += int(np.count_nonzero(crossed & (crossing_y > 0.0)))
    return bool(crossings % 2)
