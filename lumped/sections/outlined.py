"""Sections with straight edges: a polygon with holes, and the open profiles channel, angle and tee.

The axis of the leg passes through the centroid, whatever the origin of the outline. Area and second
moments of area are exact. Torsion constant, shear centre and shear compliance are computed by
boundary elements (`lumped.sections.saint_venant`), so that walls need not be thin. The corners of
channel, angle and tee are sharp.
"""

from abc import abstractmethod
from dataclasses import dataclass
from typing import ClassVar, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.memo import memo
from lumped.sections.boundary_elements import Region
from lumped.sections.edged import EdgedSection, product_of
from lumped.sections.polygons import TOUCHING, Loop, inner_angles, is_inside
from lumped.sections.saint_venant import RimSolution, area_moments, rim_solution
from lumped.sections.shapes import WalledProfile

Points: TypeAlias = tuple[tuple[float, float], ...]


class OutlinedSection(EdgedSection):
    """A section whose boundary consists of closed lines with straight edges."""

    @property
    @abstractmethod
    def loops(self) -> tuple[Loop, ...]:
        """Outline (counter-clockwise) and holes (clockwise), each n×2 corners (y and z, in m)."""

    @property
    def flexure(self) -> tuple[RimSolution, float]:
        return _solution(self)

    @property
    def largest_angle(self) -> float:
        """Largest interior angle (rad) at a corner. Re-entrant corners have angles above π."""
        return max(float(inner_angles(loop).max()) for loop in self.loops)

    @property
    def centred_loops(self) -> tuple[Loop, ...]:
        """Boundary lines in coordinates (m) relative to the centroid."""
        _, centroid, _ = _moments(self)
        return tuple(loop - centroid for loop in self.loops)

    @property
    def area(self) -> float:
        return _moments(self)[0]

    @property
    def second_moment_y(self) -> float:
        return float(_moments(self)[2][1, 1])

    @property
    def second_moment_z(self) -> float:
        return float(_moments(self)[2][0, 0])

    @property
    def product_moment(self) -> float:
        return product_of(_moments(self)[2])

    @property
    def torsion_constant(self) -> float:
        solution, size = self.flexure
        return solution.torsion_constant * size**4

    @property
    def extent(self) -> tuple[float, float]:
        width, height = np.ptp(self.loops[0], axis=0)
        return float(width), float(height)


@memo(64)
def _moments(section: OutlinedSection) -> tuple[float, Array, Array]:
    return area_moments(section.loops)


@memo(64)
def _solution(section: OutlinedSection) -> tuple[RimSolution, float]:
    """Solution of torsion and flexure for the section scaled to size 1, and its size (m)."""
    size = max(section.extent)
    return rim_solution([Region([loop / size for loop in section.centred_loops])]), size


@dataclass(frozen=True)
class Channel(WalledProfile, OutlinedSection):
    """Channel: a web along z at the smallest y, and flanges from its ends towards +y."""

    shape: ClassVar[str] = "channel"

    @property
    def loops(self) -> tuple[Loop, ...]:
        b, h, f, w = self.width, self.height, self.flange, self.web
        corners = [(0, 0), (b, 0), (b, f), (w, f), (w, h - f), (b, h - f), (b, h), (0, h)]
        return (np.array(corners, dtype=float),)

    def _own_faults(self, unit: str) -> list[str]:
        return self._flange_fault(2, unit) + self._web_fault(unit)


@dataclass(frozen=True)
class Angle(WalledProfile, OutlinedSection):
    """Angle: a flange along y at the smallest z, and a web along z at the smallest y."""

    shape: ClassVar[str] = "angle"

    @property
    def loops(self) -> tuple[Loop, ...]:
        b, h, f, w = self.width, self.height, self.flange, self.web
        return (np.array([(0, 0), (b, 0), (b, f), (w, f), (w, h), (0, h)], dtype=float),)

    def _own_faults(self, unit: str) -> list[str]:
        return self._flange_fault(1, unit) + self._web_fault(unit)


@dataclass(frozen=True)
class Tee(WalledProfile, OutlinedSection):
    """Tee: a flange along y at the largest z, and a web along z below the middle of the flange."""

    shape: ClassVar[str] = "tee"

    @property
    def loops(self) -> tuple[Loop, ...]:
        b, h, f, w = self.width / 2.0, self.height, self.flange, self.web / 2.0
        right = [(w, 0), (w, h - f), (b, h - f), (b, h)]
        return (np.array(right + [(-y, z) for y, z in reversed(right)], dtype=float),)

    def _own_faults(self, unit: str) -> list[str]:
        return self._flange_fault(1, unit) + self._web_fault(unit)


@dataclass(frozen=True)
class Polygon(OutlinedSection):
    """A polygon with holes. `outline` and each of `holes` list corners (y, z) in m, in order.

    The corners may be listed clockwise or counter-clockwise. The coordinates may have any origin,
    because the centroid is placed on the axis of the leg.
    """

    outline: Points
    holes: tuple[Points, ...] = ()
    shape: ClassVar[str] = "polygon"

    @property
    def loops(self) -> tuple[Loop, ...]:
        outline, *holes = (np.array(points, dtype=float) for points in self._all)
        return _oriented(outline, 1.0), *(_oriented(hole, -1.0) for hole in holes)

    @property
    def _all(self) -> tuple[Points, ...]:
        return self.outline, *self.holes

    def faults(self, unit: str = "m") -> list[str]:  # noqa: ARG002
        names = ["outline", *(f"holes[{i}]" for i in range(1, len(self.holes) + 1))]
        loops = [np.array(points, dtype=float) for points in self._all]
        size = float(np.ptp(loops[0], axis=0).max())
        if not size > 0.0:
            return ["outline: all points are one; must enclose an area"]
        gap = TOUCHING * size
        named_loops = list(zip(names, loops, strict=True))
        faults = [fault for name, loop in named_loops for fault in _loop_faults(name, loop, gap)]
        return faults or _hole_faults(named_loops, gap)


def _oriented(loop: Loop, direction: float) -> Loop:
    """Corners in counter-clockwise order if `direction` is positive, otherwise clockwise."""
    return loop if _signed_area(loop) * direction > 0.0 else loop[::-1]


def _signed_area(loop: Loop) -> float:
    ends = np.roll(loop, -1, axis=0)
    return 0.5 * float((loop[:, 0] * ends[:, 1] - loop[:, 1] * ends[:, 0]).sum())


def _loop_faults(name: str, loop: Loop, gap: float) -> list[str]:
    """Fault of the closed line `name`. Empty if there is none.

    A fault is a repeated point, two edges that are less than `gap` (m) apart, or an edge that leads
    back along the one before it. Only the first fault is reported, because one wrong point usually
    causes several.
    """
    count = len(loop)
    lengths = np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1)
    for i in np.flatnonzero(lengths <= gap):
        if i == count - 1:
            return [f"{name}[{count}]: repeats the first point; leave it out, the line is closed"]
        return [f"{name}[{i + 2}]: repeats the point before it; leave it out"]
    distances = _edge_distances(loop, loop)
    neighbours = (np.arange(count)[:, None] - np.arange(count)) % count
    separate = (neighbours > 1) & (neighbours < count - 1)
    for i, j in np.argwhere(np.triu(separate & (distances <= gap))):
        return [
            f"{name}: the edges from points {i + 1} and {j + 1} cross or touch; "
            "must be points in order along a line that does not meet itself"
        ]
    before, after = loop - np.roll(loop, 1, axis=0), np.roll(loop, -1, axis=0) - loop
    cross = before[:, 0] * after[:, 1] - before[:, 1] * after[:, 0]
    back = (before * after).sum(axis=1) < 0.0
    sizes = np.linalg.norm(before, axis=1) * np.linalg.norm(after, axis=1)
    for i in np.flatnonzero(back & (np.abs(cross) <= TOUCHING * sizes)):
        return [f"{name}[{i + 1}]: the line turns back on itself; must enclose an area"]
    return []


def _hole_faults(named_loops: list[tuple[str, Loop]], gap: float) -> list[str]:
    (_, outline), *holes = named_loops
    faults = []
    for k, (name, hole) in enumerate(holes):
        if np.min(_edge_distances(hole, outline)) <= gap:
            faults.append(f"{name}: meets the outline; must lie inside it, with a wall between")
        elif not is_inside([outline], hole[0]):
            faults.append(f"{name}: lies outside the outline; must lie inside it")
        for other, earlier in holes[:k]:
            if np.min(_edge_distances(hole, earlier)) <= gap:
                faults.append(f"{name}: meets {other}; must be apart from it, with a wall between")
            elif is_inside([earlier], hole[0]) or is_inside([hole], earlier[0]):
                faults.append(f"{name}: one of it and {other} lies in the other; leave one out")
    return faults


def _edge_distances(first: Loop, second: Loop) -> Array:
    """Smallest distance (m) between each of n edges of `first` and each of k edges of `second`.

    Both are closed lines. The result is n×k. The distance of edges that cross is 0.
    """
    a, b = first[:, None], np.roll(first, -1, axis=0)[:, None]
    c, d = second[None], np.roll(second, -1, axis=0)[None]
    distances = np.minimum.reduce(
        [
            distances_to_segments(a, c, d),
            distances_to_segments(b, c, d),
            distances_to_segments(c, a, b),
            distances_to_segments(d, a, b),
        ]
    )
    across = twice_area(a, b, c) * twice_area(a, b, d) < 0.0
    crossing = across & (twice_area(c, d, a) * twice_area(c, d, b) < 0.0)
    return np.where(crossing, 0.0, distances)


def distances_to_edges(point: Array, loop: Loop) -> Array:
    """Distance (n values, in m) of a point from each edge of a closed line with n corners.

    Edge i starts at corner i.
    """
    return distances_to_segments(point, loop, np.roll(loop, -1, axis=0))


def distances_to_segments(point: Array, start: Array, end: Array) -> Array:
    """Distance (n values, in m) of a point from each of n edges from `start` to `end` (n×2)."""
    edge = end - start
    share = np.clip(((point - start) * edge).sum(axis=-1) / (edge**2).sum(axis=-1), 0.0, 1.0)
    return np.asarray(np.linalg.norm(point - start - share[..., None] * edge, axis=-1))


def twice_area(a: Array, b: Array, c: Array) -> Array:
    """Twice the area of triangles with corners a, b, c (…×2, in m). Positive anticlockwise."""
    u, v = b - a, c - a
    return np.asarray(u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])
