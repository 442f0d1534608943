"""Section mesh of circles and rectangles about one centre, for steps from round to straight edges.

All outlines surround the centre, so that a ray meets each of them once. Rays go through all corners
of rectangles and all points at which two outlines cross. Between two neighbouring rays, the
outlines do not cross, and two successive ones bound a quadrilateral, or a triangle if they meet on
one of the rays. A triangle is divided into three quadrilaterals, whose sides halve its sides. One
quadrant is meshed, and the mesh is exactly symmetric about both axes.

A circle that touches a side of a rectangle would bound elements with an angle of zero. Within 5° of
the axis, such a circle is therefore replaced by the side, and up to the next ray it returns to
itself in a way that keeps its area within 1.3e-4. Its second moments of area change by 3e-4 with
four touching sides, and by up to 6e-4 with two.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise
from math import atan2, ceil, cos, hypot, pi, sin, sqrt
from typing import NamedTuple, TypeAlias

import numpy as np
import scipy

from lumped.arrays import Array, IntArray, distinct
from meshes.section.section_mesh import SectionMesh, counter_clockwise, quadrilaterals

# Largest angle (rad) between two rays. Each half of it has one element in the coarsest mesh.
_LARGEST_SECTOR = 0.25 * pi
# Angle (rad) below which two rays count as one, and distance, as a fraction of the largest outline,
# below which two points do.
_SAME_RAY, _SAME_POINT = 1e-6, 1e-8
# Distances of the core's corner and of the ends of its sides from the centre, as fractions of the
# smallest distance of an outline. Three elements meet in the corner, at about 120° each.
_CORE_CORNER, _CORE_SIDE = 0.6, 0.5
# Largest difference (rad) between 45° and the ray through the core's corner.
_CORNER_RANGE = pi / 9.0

# Angle (rad) from an axis within which a circle is replaced by the side that it touches.
_TOUCHING = pi / 36.0

# Function that returns the points (n×2, in m) of a curve at n shares of a sector.
_Side: TypeAlias = Callable[[Array], Array]
# Function that returns points (n×2, in m) at coordinates u and v (n each) of a block.
_Map: TypeAlias = Callable[[Array, Array], Array]


class Outline(NamedTuple):
    """Circle or rectangle about the centre, by its half extents (m) along y and z."""

    y: float
    z: float
    is_round: bool

    @property
    def smallest(self) -> float:
        """Smallest distance (m) from the centre."""
        return min(self.y, self.z)

    @property
    def largest(self) -> float:
        """Largest distance (m) from the centre."""
        return self.y if self.is_round else hypot(self.y, self.z)

    def ray_angles(self, other: "Outline") -> list[float]:
        """Angles (rad, 0 to π/2) of this rectangle's corner and of crossings with another outline.

        Empty for a circle.
        """
        if self.is_round:
            return []
        angles = [atan2(self.z, self.y)]
        if not other.is_round:
            return [*angles, atan2(self.z, other.y)]
        if self.touches(other, 0.0):
            angles.append(_TOUCHING)
        elif 0.0 <= (z_squared := other.y**2 - self.y**2) <= self.z**2:
            angles.append(atan2(sqrt(z_squared), self.y))
        if self.touches(other, 0.5 * pi):
            angles.append(0.5 * pi - _TOUCHING)
        elif 0.0 <= (y_squared := other.y**2 - self.z**2) <= self.y**2:
            angles.append(atan2(self.z, sqrt(y_squared)))
        return angles

    def touches(self, circle: "Outline", angle: float) -> bool:
        """True for a rectangle that a `circle` touches near the ray of an angle (rad).

        The rectangle and the circle touch near an axis, 0 or π/2, if their distances on it differ
        by less than those of the circle and of its tangent, 5° from the axis.
        """
        if self.is_round or not circle.is_round:
            return False
        near_y, near_z = angle <= _TOUCHING + _SAME_RAY, 0.5 * pi - angle <= _TOUCHING + _SAME_RAY
        slack = (1.0 - cos(_TOUCHING)) * circle.y
        return (near_y and abs(self.y - circle.y) <= slack) or (
            near_z and abs(self.z - circle.y) <= slack
        )

    def point(self, angle: float) -> Array:
        """Point (2, in m) on the ray of an angle (rad)."""
        direction = np.array([cos(angle), sin(angle)])
        distance = self.y if self.is_round else 1.0 / max(direction / (self.y, self.z))
        return np.asarray(distance * direction)

    def side(self, start: float, end: float) -> _Side:
        """Curve of the outline from one ray to the next (angles in rad)."""
        if not self.is_round:
            return _straight(self.point(start), self.point(end))

        def arc(shares: Array) -> Array:
            angles = start + (end - start) * shares
            return np.asarray(self.y * np.column_stack([np.cos(angles), np.sin(angles)]))

        return arc


def _drawn_to_sides(circle: Outline, boxes: Sequence[Outline], start: float, end: float) -> _Side:
    """Curve of a circle from one ray to the next (rad), moved to the sides that it touches.

    The distance δ to a side 5° from the axis, at an angle θ from it, is reduced to zero over the
    angle φ to the next ray as δ (1 − u)(1 − b u), b = 3 + 2θ/φ. Its integral is −δθ/3, the area
    between side and circle within θ.
    """
    both = [box for box in boxes if box.touches(circle, start) and box.touches(circle, end)]
    if both:
        return both[0].side(start, end)
    arc = circle.side(start, end)
    slope = 3.0 + 2.0 * _TOUCHING / (end - start)
    offsets = [
        next(
            (box.point(angle) - circle.point(angle) for box in boxes if box.touches(circle, angle)),
            np.zeros(2),
        )
        for angle in (start, end)
    ]

    def moved(shares: Array) -> Array:
        backward = 1.0 - shares
        weights = backward * (1.0 - slope * shares), shares * (1.0 - slope * backward)
        return np.asarray(
            arc(shares) + np.outer(weights[0], offsets[0]) + np.outer(weights[1], offsets[1])
        )

    return moved


def _straight(start: Array, end: Array) -> _Side:
    return lambda shares: np.asarray(start + shares[:, None] * (end - start))


def star_mesh(
    outlines: Sequence[Outline], size: float, refinement: int, *, has_core: bool
) -> SectionMesh:
    """Mesh of the area within the outermost of the `outlines`, each of which is a line of the mesh.

    Layers between outlines that do not meet are divided until they are at most `size` (m) thick.
    All elements are then divided into `refinement` along both sides. If `has_core` is False, the
    area within the innermost outline is left out.
    """
    curves = sorted(set(outlines), key=lambda outline: (outline.smallest, outline.largest))
    rays = _rays(curves, has_core=has_core)
    groups, gaps = _groups(curves)
    smallest = curves[0].smallest
    gaps[0] = (1.0 - _CORE_CORNER) * smallest
    split = 2 * refinement
    blocks: list[tuple[Array, IntArray]] = []
    corner = int(np.argmin(np.abs(rays - 0.25 * pi)))
    rim = _core_rim(smallest, rays, corner)
    for number, (start, end) in enumerate(pairwise(rays.tolist())):
        sides = [
            (
                group,
                _drawn_to_sides(curve, curves, start, end)
                if curve.is_round
                else curve.side(start, end),
            )
            for group, curve in zip(groups, curves, strict=True)
        ]
        sides.sort(key=lambda side: float(np.linalg.norm(side[1](np.array([0.5])))))
        if has_core:
            sides.insert(0, (-1, _straight(*rim[number : number + 2])))
        for (below, inner), (above, outer) in pairwise(sides):
            count = split if below == above else refinement * ceil(gaps[above] / size)
            blocks += _layer(inner, outer, split, count, _SAME_POINT * curves[-1].largest)
    if has_core:
        blocks.append(_core(rim, corner, split))
    return _quadrants(blocks, _SAME_POINT * curves[-1].largest)


def _rays(curves: Sequence[Outline], *, has_core: bool) -> Array:
    """Angles (ascending, rad) of the rays in the first quadrant, from 0 to π/2."""
    angles = [0.0, 0.5 * pi]
    angles += [angle for curve in curves for other in curves for angle in curve.ray_angles(other)]
    rays = distinct(np.sort(angles), _SAME_RAY)
    if has_core and np.abs(rays - 0.25 * pi).min() > _CORNER_RANGE:
        rays = np.sort([*rays, 0.25 * pi])
    pieces = [
        np.linspace(start, end, ceil((end - start) / _LARGEST_SECTOR - _SAME_RAY) + 1)[:-1]
        for start, end in pairwise(rays.tolist())
    ]
    return np.concatenate([*pieces, rays[-1:]])


def _groups(curves: Sequence[Outline]) -> tuple[list[int], list[float]]:
    """Group of each of the sorted `curves`, and the gap (m) between each group and the one within.

    Curves of one group meet or nearly touch each other, those of different groups do not. The first
    gap is zero.
    """
    groups, gaps, reach = [0], [0.0], curves[0].largest
    for curve in curves[1:]:
        if (gap := curve.smallest - reach) > (1.0 - cos(_TOUCHING)) * reach:
            gaps.append(gap)
        groups.append(len(gaps) - 1)
        reach = max(reach, curve.largest)
    return groups, gaps


def _core_rim(smallest: float, rays: Array, corner: int) -> Array:
    """Points (n×2, in m) of the core's rim on n rays.

    The rim consists of two straight sides, which meet on the ray number `corner`.
    """
    first, last = np.array([_CORE_SIDE, 0.0]), np.array([0.0, _CORE_SIDE])
    middle = _CORE_CORNER * np.array([cos(rays[corner]), sin(rays[corner])])
    points = []
    for number, angle in enumerate(rays.tolist()):
        start, end = (first, middle) if number <= corner else (middle, last)
        normal = np.array([start[1] - end[1], end[0] - start[0]])
        direction = np.array([cos(angle), sin(angle)])
        points.append(smallest * (normal @ start) / (normal @ direction) * direction)
    return np.array(points)


def _layer(
    inner: _Side, outer: _Side, across: int, along: int, same: float
) -> list[tuple[Array, IntArray]]:
    """Blocks between two curves in a sector. Empty if the curves coincide.

    `across` is the number of elements along the curves, `along` that along the rays. `same` (m) is
    the distance below which the curves meet on a ray.
    """
    ends = np.array([0.0, 1.0])
    meets = np.linalg.norm(outer(ends) - inner(ends), axis=1) <= same

    def between(u: Array, v: Array) -> Array:
        return np.asarray((1.0 - v)[:, None] * inner(u) + v[:, None] * outer(u))

    if meets.all():
        return []
    if not meets.any():
        return [_block(between, across, along)]
    # Corners of the triangle in its coordinates u, from the meeting point, and v.
    tip, first, second = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]])
    middle = np.array([2.0 / 3.0, 0.5])

    def in_triangle(place: Array) -> Array:
        # Along a line through the meeting point, v is constant: interpolate u and the product u v.
        u = place[:, 0]
        v = np.divide(place[:, 1], u, out=np.zeros_like(u), where=u > 0.0)
        return between(1.0 - u if meets[1] else u, v)

    corners = [np.array([u, u * v]) for u, v in (tip, first, second, middle)]
    tip, first, second, middle = corners
    quadrilaterals = [
        (tip, 0.5 * (tip + first), middle, 0.5 * (tip + second)),
        (first, 0.5 * (first + second), middle, 0.5 * (tip + first)),
        (second, 0.5 * (tip + second), middle, 0.5 * (first + second)),
    ]

    def bilinear(places: Sequence[Array]) -> _Map:
        a, b, c, d = places
        return lambda u, v: in_triangle(
            np.outer((1 - u) * (1 - v), a)
            + np.outer(u * (1 - v), b)
            + np.outer(u * v, c)
            + np.outer((1 - u) * v, d)
        )

    return [_block(bilinear(places), across // 2, along // 2) for places in quadrilaterals]


def _core(rim: Array, corner: int, split: int) -> tuple[Array, IntArray]:
    """Block of the core in the first quadrant, by transfinite interpolation between its sides."""
    counts = corner * split, (len(rim) - 1 - corner) * split

    def rim_at(numbers: Array) -> Array:
        return np.column_stack(
            [np.interp(numbers, np.arange(len(rim)), component) for component in rim.T]
        )

    def place(u: Array, v: Array) -> Array:
        # u runs along z with the first side of the rim, v along y with its second side.
        first, second = rim_at(corner * u), rim_at(len(rim) - 1 - (len(rim) - 1 - corner) * v)
        on_z, on_y = np.outer(u, rim[-1]), np.outer(v, rim[0])
        linear = (
            np.outer(u * (1 - v), rim[-1])
            + np.outer((1 - u) * v, rim[0])
            + np.outer(u * v, rim[corner])
        )
        return np.asarray(
            v[:, None] * first
            + (1 - v)[:, None] * on_z
            + u[:, None] * second
            + (1 - u)[:, None] * on_y
            - linear
        )

    return _block(place, *counts)


def _block(place: _Map, across: int, along: int) -> tuple[Array, IntArray]:
    """Nodes (n×2, in m) and nine-node cells of a block of `across` × `along` elements."""
    u, v = np.meshgrid(np.linspace(0.0, 1.0, 2 * across + 1), np.linspace(0.0, 1.0, 2 * along + 1))
    return place(u.ravel(), v.ravel()), quadrilaterals(*u.shape[::-1], period=u.shape[1])


def _quadrants(blocks: Sequence[tuple[Array, IntArray]], same: float) -> SectionMesh:
    """Mesh of blocks in the first quadrant and of their mirror images.

    Nodes that are less than `same` (m) apart are joined.
    """
    starts = np.cumsum([0, *(len(nodes) for nodes, _ in blocks)])
    nodes = np.vstack([nodes for nodes, _ in blocks])
    nodes[np.abs(nodes) < same] = 0.0
    cells = np.vstack([cells + start for (_, cells), start in zip(blocks, starts, strict=False)])
    mirrors = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)]
    # Equal nodes of blocks are joined before they are mirrored, so that the mesh is symmetric.
    nodes, numbers = _joined(nodes, same)
    images = np.vstack([nodes * mirror for mirror in mirrors])
    offsets = len(nodes) * np.arange(len(mirrors))
    all_cells = np.vstack([numbers[cells] + offset for offset in offsets])
    nodes, numbers = _joined(images, same)
    return SectionMesh(nodes, counter_clockwise(nodes, numbers[all_cells], "quad9"), "quad9")


def _joined(nodes: Array, same: float) -> tuple[Array, IntArray]:
    """Distinct nodes, and the number of each of the `nodes` among them."""
    pairs = scipy.spatial.cKDTree(nodes).query_pairs(same, output_type="ndarray")
    links = scipy.sparse.coo_array(
        (np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(nodes), len(nodes))
    )
    _, numbers = scipy.sparse.csgraph.connected_components(links, directed=False)
    _, first = np.unique(numbers, return_index=True)
    return nodes[first], numbers
