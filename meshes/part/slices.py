"""Plane cross-sections of the mesh of a part: outlines, and meshes inside the outlines."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lumped.arrays import Array, IntArray
from lumped.errors import InputError
from meshes.gmsh_session import connectivity, gmsh_model, numbered
from meshes.part.boundary import Facets
from meshes.processes import Crashed, within_limits
from meshes.section.section_mesh import SectionMesh, counter_clockwise

# Flat triangles that replace a facet, by local node numbers. A curved facet is replaced by four.
_PIECES = {
    "tri3": ((0, 1, 2),),
    "tri6": ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)),
    "quad4": ((0, 1, 2), (0, 2, 3)),
    "quad8": ((0, 1, 2), (0, 2, 3)),
    "quad9": ((0, 1, 2), (0, 2, 3)),
}
# Relative distance of a corner from the line of its neighbours below which it is removed.
_STRAIGHT = 2e-4
# Distance from a plane, relative to the part's length, below which a node lies in the plane.
_IN_PLANE = 1e-9
# Edge length of triangles relative to the wall thickness, which is twice the area divided by the
# length of the outlines.
_EDGE = 0.7
# Limit on the CPU time (s) for the meshes of all sections of a part.
_SECONDS = 120.0


class NotPrismaticError(InputError):
    """Error: a part cannot be represented by prismatic pieces with its plane cross-sections."""


@dataclass(frozen=True, eq=False)
class Slice:
    """A connected piece of a plane cross-section: its outer outline and those of its holes.

    Each outline is n×2 (in m), in the two axes of the plane.
    """

    outer: Array
    holes: tuple[Array, ...]

    @property
    def area(self) -> float:
        """Area (m²) inside the outline minus the area of the holes."""
        return _moments(self.outer)[0] - sum(_moments(hole)[0] for hole in self.holes)

    @property
    def centroid(self) -> Array:
        """Centroid (2, in m) of the area inside the outline and outside the holes."""
        first = _moments(self.outer)[1] - sum(_moments(hole)[1] for hole in self.holes)
        return np.asarray(first / self.area)

    @property
    def size(self) -> float:
        """Larger side (m) of the bounding box of the outline."""
        return float(np.ptp(self.outer, axis=0).max())

    @property
    def measures(self) -> Array:
        """Four numbers that identify the section: two areas (m²) and two principal moments (m⁴).

        The numbers are the area without the holes, the area including the holes, and the smaller
        and the larger principal second moment of area.
        """
        centre = self.centroid
        holes = sum(_moments(hole - centre)[2] for hole in self.holes)
        second = np.linalg.eigvalsh(_moments(self.outer - centre)[2] - holes)
        return np.array([self.area, _moments(self.outer)[0], *second])


def slices_of(nodes: Array, facets: Facets, origin: Array, axes: Array) -> list[Slice]:
    """Connected pieces of the cross-section of a part by a plane.

    The first piece is the one whose centroid is nearest to `origin`. The plane passes through
    `origin` (3, in m), and its normal is the first column of `axes` (3×3). The outlines are given
    in the other two axes, from `origin`. `facets` is the boundary of the part, `nodes` (N×3, in m)
    are the nodes of its mesh. Raises NotPrismaticError if the plane does not cut the part.
    """
    from matplotlib.path import Path as Outline  # noqa: PLC0415  slow to import, and makes folders

    loops = [loop for loop in _loops(nodes, facets, origin, axes) if _moments(loop)[0] > 0.0]
    if not loops:
        x, y, z = origin
        raise NotPrismaticError(
            f"the plane through ({x:.4g}, {y:.4g}, {z:.4g}) m does not cut the part"
        )
    inside = [
        [Outline(other).contains_point(loop[0]) for other in loops if other is not loop]
        for loop in loops
    ]
    pieces = []
    for loop, enclosing in zip(loops, inside, strict=True):
        if sum(enclosing) % 2:
            continue
        outline = Outline(loop)
        holes = tuple(
            other
            for other, enclosing_other in zip(loops, inside, strict=True)
            if sum(enclosing_other) == sum(enclosing) + 1 and outline.contains_point(other[0])
        )
        pieces.append(Slice(loop, holes))
    return sorted(pieces, key=lambda piece: float(np.linalg.norm(piece.centroid)))


def slice_meshes(pieces: Sequence[Slice]) -> list[SectionMesh]:
    """Mesh of second-order triangles inside the outlines of each of the `pieces`.

    Raises InputError if gmsh crashes.
    """
    try:
        return within_limits(_SECONDS, _slice_meshes, pieces)
    except Crashed as crash:
        raise InputError(f"gmsh fails to mesh the sections of the part ({crash})") from crash


def _slice_meshes(pieces: Sequence[Slice]) -> list[SectionMesh]:
    return [_slice_mesh(piece) for piece in pieces]


def _slice_mesh(piece: Slice) -> SectionMesh:
    perimeter = sum(
        float(np.linalg.norm(np.diff(loop, axis=0, append=loop[:1]), axis=1).sum())
        for loop in (piece.outer, *piece.holes)
    )
    with gmsh_model("section of the part") as gmsh:
        geo = gmsh.model.geo
        loops = []
        for outline in (piece.outer, *piece.holes):
            points = [geo.addPoint(0.0, y, z) for y, z in outline]
            ends = [*points[1:], points[0]]
            lines = [geo.addLine(a, b) for a, b in zip(points, ends, strict=True)]
            loops.append(geo.addCurveLoop(lines))
        geo.addPlaneSurface(loops)
        geo.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", _EDGE * 2.0 * piece.area / perimeter)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(2)
        tagged = connectivity(gmsh, "tri6")
        tags, nodes = numbered(gmsh, tagged)
    flat = np.ascontiguousarray(nodes[:, 1:])
    return SectionMesh(flat, counter_clockwise(flat, np.searchsorted(tags, tagged), "tri6"), "tri6")


def _loops(nodes: Array, facets: Facets, origin: Array, axes: Array) -> list[Array]:
    """Closed polygons (n×2, in m) in which a plane cuts the boundary of a part.

    The arguments are those of `slices_of`.
    """
    local = (nodes - origin) @ axes
    height = local[:, 0].copy()
    # Nodes in the plane count as above it, so that a face in the plane lies on one side of it.
    height[np.abs(height) < _IN_PLANE * np.ptp(height)] = np.finfo(float).tiny
    triangles = np.vstack([facets.cells[:, list(piece)] for piece in _PIECES[facets.element]])
    above = height[triangles] > 0.0
    cut = triangles[above.any(axis=1) & ~above.all(axis=1)]
    links: dict[tuple[int, int], list[tuple[int, int]]] = {}
    for triangle in cut.tolist():
        crossed = [
            (min(a, b), max(a, b))
            for a, b in zip(triangle, [*triangle[1:], triangle[0]], strict=True)
            if (height[a] > 0.0) != (height[b] > 0.0)
        ]
        first, second = crossed
        links.setdefault(first, []).append(second)
        links.setdefault(second, []).append(first)
    loops = []
    while links:
        edge = next(iter(links))
        ring = []
        while edge in links:
            ring.append(edge)
            edge = next((other for other in links.pop(edge) if other in links), edge)
        edges: IntArray = np.array(ring)
        low, high = height[edges[:, 0]], height[edges[:, 1]]
        share = (low / (low - high))[:, None]
        points = local[edges[:, 0], 1:] * (1.0 - share) + local[edges[:, 1], 1:] * share
        if len(points) > 2:
            loops.append(_simplified(points))
    return loops


def _simplified(loop: Array) -> Array:
    """Polygon `loop` (n×2) without its superfluous corners.

    A corner is superfluous if it coincides with a neighbour or lies on the line between its
    neighbours.
    """
    limit = _STRAIGHT * float(np.ptp(loop, axis=0).max())
    # The point farthest from the mean is certainly a corner.
    first = int(np.argmax(np.linalg.norm(loop - loop.mean(axis=0), axis=1)))
    loop = np.roll(loop, -first, axis=0)
    corners = [loop[0]]
    start = 0
    for k in range(1, len(loop)):
        end = loop[(k + 1) % len(loop)]
        between = loop[start + 1 : k + 1] - corners[-1]
        chord = end - corners[-1]
        size = float(np.linalg.norm(chord))
        distances = np.abs(between[:, 0] * chord[1] - between[:, 1] * chord[0]) / max(size, limit)
        if distances.max() > limit:
            corners.append(loop[k])
            start = k
    return np.array(corners)


def _moments(loop: Array) -> tuple[float, Array, Array]:
    """Moments ∫dA, ∫s dA (2) and ∫s sᵀ dA (2×2) of the area inside a polygon `loop` (n×2).

    s is the position from the origin of its coordinates.
    """
    following = np.roll(loop, -1, axis=0)
    cross = loop[:, 0] * following[:, 1] - following[:, 0] * loop[:, 1]
    cross = cross * np.sign(cross.sum())
    sums = loop + following
    second = loop.T @ (cross[:, None] * loop) + following.T @ (cross[:, None] * following)
    second = second + sums.T @ (cross[:, None] * sums)
    return float(cross.sum()) / 2.0, sums.T @ cross / 6.0, second / 24.0
