"""Boundary elements for harmonic functions on a section that consists of polygonal regions.

A harmonic function u satisfies φ(p) u(p) = ∮ (Γ ∂u/∂n − u ∂Γ/∂n) ds. Here Γ = −ln ρ/2π is Green's
function of the distance ρ from the point p, and φ(p) is the fraction of a full circle about p that
lies in the section. This equation is solved on quadratic elements whose integrals are evaluated in
closed form. Element lengths decrease geometrically towards corners, where u has a term ρ^(π/α) with
the interior angle α.

Regions may have different weights w. Across an edge between regions u is continuous, and w ∂u/∂n
has a prescribed jump. The boundary integral equations of the regions, each multiplied by its w, are
added, so that u remains as the only unknown. Integrals over the boundary thus become integrals over
all edges, weighted by the jump of w: its value to the left of an edge minus that to its right.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from lumped.arrays import Array, IntArray
from lumped.sections.polygons import Loop, Partition, inner_angles, partition_edges

# Largest ratio of the length of an element to its distance from the nearest corner. J of an angle
# whose walls are a fiftieth of its sides then has an error of 3e-6.
_GRADING = 0.25
# Error of the constants due to elements of relative length ε at a corner: ε^(2π/α), from the
# singular term.
_LEFT = 1e-7
# Change of direction (rad) below which a corner is part of a curve approximated by a polygon.
_WEAK = np.pi / 6.0
# Length of the elements at such corners, as a fraction of the shorter edge, and longest element as
# a fraction of any edge. Both are large because curves have many edges.
_SMALLEST_WEAK, _SHARE = 0.3, 0.5
# Number of Gauss points, which integrate all products of polynomials exactly. Kernels are
# integrated numerically from a distance of _NEAR element lengths on, otherwise in closed form.
_POINTS, _NEAR = 6, 3.0
# A point closer to the line of an element than this fraction of its length lies on the line.
_ON_LINE = 1e-12
# Difference, as a fraction of the largest weight, below which parts have the same material.
_EQUAL_WEIGHTS = 1e-9
# Number of rows of the matrix that are integrated at a time.
_CHUNK = 256


@dataclass(frozen=True, eq=False)
class Region:
    """Part of a section, bounded by `loops`: its outline and its holes.

    Its moduli are `weight` times those of a reference material.
    """

    loops: Sequence[Loop]
    weight: float = 1.0


@dataclass(frozen=True, eq=False)
class _Edges:
    """The e edges at which the weight of the regions jumps. Outside the section it is 0.

    `vertices` (V×2) are the vertices of the edges, and `ends` (e×2) are the indices of the start
    and the end of each edge. `jumps` (e) contains the weight to the left of each edge minus that to
    its right. `smallest` (V) is the length of the boundary elements at each vertex.
    """

    vertices: Array
    ends: IntArray
    jumps: Array
    smallest: Array


@dataclass(frozen=True, eq=False)
class Rim:
    """Mesh of all edges: E quadratic boundary elements with N nodes.

    `nodes` (N×2) are their positions. `cells` (E×3) are the indices of the nodes at the start, in
    the middle and at the end of each element. `along` and `outward` (E×2) are unit vectors along
    each element, and normal to it towards its right. `lengths` (E) are the lengths of the elements,
    and `jumps` (E) the jumps of the weight across them.
    """

    nodes: Array
    cells: IntArray
    along: Array
    outward: Array
    lengths: Array
    jumps: Array

    def on(self, values: Array) -> Array:
        """Values at the Gauss points of all elements (E×q×m) from nodal values (N×m)."""
        return np.asarray(np.einsum("qk,ekm->eqm", _shapes(unit_gauss()[0]), values[self.cells]))

    def integral(self, values: Array) -> Array:
        """Integral ∮ … ds over all elements of `values` times the jumps of the weight.

        `values` (E×q×…) are those at the q Gauss points of each element.
        """
        _, weights = unit_gauss()
        weighted = np.einsum("eq...,q->e...", values, weights)
        return np.asarray(np.einsum("e...,e->...", weighted, self.lengths * self.jumps))

    @property
    def points(self) -> Array:
        """Coordinates of the Gauss points (E×q×2)."""
        return self.on(self.nodes)


@cache
def unit_gauss() -> tuple[Array, Array]:
    """Gauss points and weights on the interval from 0 to 1."""
    points, weights = legendre.leggauss(_POINTS)
    return np.asarray(0.5 * (1.0 + points), float), np.asarray(0.5 * weights, float)


def _shapes(coordinates: Array) -> Array:
    """Quadratic shape functions (q×3: start, middle, end) at q coordinates from 0 to 1."""
    return np.column_stack(
        [
            (1 - coordinates) * (1 - 2 * coordinates),
            4 * coordinates * (1 - coordinates),
            coordinates * (2 * coordinates - 1),
        ]
    )


def _edges(regions: Sequence[Region]) -> _Edges:
    """Edges of all regions at which the weight jumps.

    Edges are split at vertices of other regions.
    """
    if len(regions) == 1:
        loops = regions[0].loops
        ends, begun = [], 0
        for loop in loops:
            numbers = np.arange(len(loop))
            ends.append(begun + np.column_stack([numbers, np.roll(numbers, -1)]))
            begun += len(loop)
        smallest = np.concatenate([_smallest_elements(loop) for loop in loops])
        pairs = np.vstack(ends)
        jumps = np.full(len(pairs), regions[0].weight)
        return _Edges(np.vstack(loops), pairs, jumps, smallest)
    partition = partition_edges([region.loops for region in regions])
    weights = np.append([region.weight for region in regions], 0.0)
    jumps = weights[partition.left] - weights[partition.right]
    # Edges between parts of one material need no elements.
    has_jump = np.abs(jumps) > _EQUAL_WEIGHTS * weights.max()
    smallest = _smallest_at_vertices(partition, has_jump)
    return _Edges(partition.vertices, partition.ends[has_jump], jumps[has_jump], smallest)


def _smallest_at_vertices(partition: Partition, is_kept: NDArray[np.bool_]) -> Array:
    """Length (V) of the boundary elements at each vertex of several regions.

    `is_kept` (e) is True for the edges that have elements. If edges of two regions meet at a
    vertex, displacements have a singular term ρ^λ in the distance ρ from it. λ is above ½ except
    for extreme ratios of the moduli. There is no such term if the edges continue straight through
    the vertex and all other edges there are perpendicular to them.
    """
    smallest = np.full(len(partition.vertices), np.inf)
    for number, vertex in enumerate(partition.vertices):
        at_vertex = is_kept & (partition.ends == number).any(axis=1)
        if not at_vertex.any():
            continue
        ends = partition.ends[at_vertex]
        ways = partition.vertices[ends.sum(axis=1) - number] - vertex
        angles = np.arctan2(ways[:, 1], ways[:, 0])
        order = np.argsort(angles)
        openings = np.diff(np.append(angles[order], angles[order[0]] + 2.0 * np.pi))
        # The region counter-clockwise from an edge lies on its left if the edge starts here.
        begins = ends[:, 0] == number
        neighbours = np.where(begins, partition.left[at_vertex], partition.right[at_vertex])
        opening = _sharpest_opening(openings, neighbours[order] >= 0)
        share = min(_LEFT ** (opening / (2.0 * np.pi)), _SMALLEST_WEAK)
        smallest[number] = share * np.linalg.norm(ways, axis=1).min()
    return smallest


def _sharpest_opening(openings: Array, filled: NDArray[np.bool_]) -> float:
    """Interior angle (rad) of a corner of one region that stands for a vertex of several.

    Its stress singularity is at least as strong as that of the vertex. 0 if there is none.
    `openings` (rad) are the angles of the sectors about the vertex. `filled` is True for sectors
    that belong to a region.
    """
    if np.count_nonzero(filled) == 1:
        inner = float(openings[filled][0])
        return 0.0 if abs(inner - np.pi) < _WEAK else inner
    straight = np.abs(openings - np.pi) < _WEAK
    square = np.abs(openings - 0.5 * np.pi) < _WEAK
    weak = straight.any() and (straight | square).all()
    return 0.0 if weak else 2.0 * np.pi


def rim_of(regions: Sequence[Region]) -> Rim:
    """Mesh of boundary elements on all edges of a section that consists of `regions`.

    The lengths of the elements decrease towards all vertices.
    """
    edges = _edges(regions)
    vertices = edges.vertices
    nodes, cells, along, lengths, jumps = [vertices], [], [], [], []
    begun = len(vertices)
    for (first, last), jump in zip(edges.ends.tolist(), edges.jumps.tolist(), strict=True):
        start, edge = vertices[first], vertices[last] - vertices[first]
        shares = np.append(_graded(start, edge, vertices, edges.smallest), 1.0)
        count = len(shares) - 1
        # Middle nodes, then the nodes between elements.
        middles = begun + np.arange(count)
        between = np.concatenate([[first], begun + count + np.arange(count - 1), [last]])
        inner = np.concatenate([0.5 * (shares[:-1] + shares[1:]), shares[1:-1]])
        nodes.append(start + inner[:, None] * edge)
        cells.append(np.column_stack([between[:-1], middles, between[1:]]))
        length = float(np.linalg.norm(edge))
        along.append(np.tile(edge / length, (count, 1)))
        lengths.append(np.diff(shares) * length)
        jumps.append(np.full(count, jump))
        begun += len(inner)
    tangents, all_cells = np.vstack(along), np.vstack(cells)
    # Vertices between edges of one material have no element.
    used, numbers = np.unique(all_cells, return_inverse=True)
    return Rim(
        nodes=np.vstack(nodes)[used],
        cells=numbers.reshape(all_cells.shape),
        along=tangents,
        outward=np.column_stack([tangents[:, 1], -tangents[:, 0]]),
        lengths=np.concatenate(lengths),
        jumps=np.concatenate(jumps),
    )


def _smallest_elements(loop: Loop) -> Array:
    """Length (n) of the elements at each corner, small enough for its singular term ρ^(π/α).

    α is the interior angle of the corner, ρ the distance from it.
    """
    lengths = np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1)
    shorter = np.minimum(lengths, np.roll(lengths, 1))
    inner = inner_angles(loop)
    weak = np.abs(inner - np.pi) < _WEAK
    share = np.where(weak, _SMALLEST_WEAK, _LEFT ** (inner / (2.0 * np.pi)))
    return np.asarray(np.minimum(share, _SMALLEST_WEAK) * shorter)


def _graded(start: Array, direction: Array, corners: Array, smallest: Array) -> list[float]:
    """Start points of the boundary elements on an edge, as ascending fractions of its length.

    `direction` is the vector from the `start` of the edge to its end. Elements become shorter
    towards the `corners` (V×2), down to the `smallest` length (V) at each corner.
    """
    length = float(np.linalg.norm(direction))
    along = (corners - start) @ direction / length**2
    across = np.linalg.norm(corners - start - along[:, None] * direction, axis=1)
    starts, todo = [], [(0.0, 1.0)]
    while todo:
        first, last = todo.pop()
        away = np.hypot(across, length * np.maximum(0.0, np.maximum(first - along, along - last)))
        allowed = np.minimum(np.min(np.maximum(_GRADING * away, smallest)), _SHARE * length)
        if (last - first) * length > allowed * (1.0 + _ON_LINE):
            middle = 0.5 * (first + last)
            todo += [(middle, last), (first, middle)]
        else:
            starts.append(first)
    return starts


def potentials(rim: Rim, fluxes: Array) -> Array:
    """Nodal values (N×m) of m harmonic functions u of mean zero, from their normal derivatives.

    `fluxes` (E×q×m) are ∂u/∂n at the q Gauss points of each element, quadratic along the element.
    At an edge between two regions, the jump of w ∂u/∂n is the jump of the weight w times the flux.
    """
    fit = np.linalg.pinv(_shapes(unit_gauss()[0]))
    fluxes = fluxes * rim.jumps[:, None, None]
    nodal = np.einsum("kq,eqm->ekm", fit, fluxes).reshape(-1, fluxes.shape[-1])
    count, elements = len(rim.nodes), len(rim.cells)
    places = rim.cells.ravel()
    # The integrals of ∂G/∂n over an element multiply the unknown values at its three nodes.
    matrix, load = np.zeros((count, count)), np.zeros((count, nodal.shape[1]))
    for first in range(0, count, _CHUNK):
        rows = slice(first, min(first + _CHUNK, count))
        single, double = _layers(rim, rim.nodes[rows])
        load[rows] = single.reshape(-1, 3 * elements) @ nodal
        columns = (double * rim.jumps[:, None]).reshape(-1, 3 * elements)
        block = matrix[rows]
        np.add.at(block.T, places, columns.T)
    # A constant has no normal derivative, so the diagonal is minus the sum of the other entries.
    matrix[np.diag_indices(count)] -= matrix.sum(axis=1)
    weights = np.zeros(count)
    np.add.at(weights, rim.cells, np.outer(rim.lengths, [1.0, 4.0, 1.0]) / 6.0)
    mean = weights / weights.sum()
    return np.asarray(np.linalg.solve(matrix + mean, load))


def _layers(rim: Rim, points: Array) -> tuple[Array, Array]:
    """Integrals ∫ N_k Γ ds and ∫ N_k ∂Γ/∂n ds (p×E×3) over all elements, for `points` (p×2).

    N_k are the three shape functions of an element, Γ is Green's function of a point.
    """
    starts = rim.nodes[rim.cells[:, 0]]
    away = points[:, None] - starts
    foot = np.einsum("ped,ed->pe", away, rim.along)
    height = -np.einsum("ped,ed->pe", away, rim.outward)
    lengths = rim.lengths
    height = np.where(np.abs(height) <= _ON_LINE * lengths, 0.0, height)
    middle = 0.5 * lengths
    near = np.hypot(foot - middle, height) < _NEAR * lengths
    shares, weights = unit_gauss()
    v = shares * lengths[:, None] - foot[:, :, None]
    squared = v**2 + height[:, :, None] ** 2
    squared[near] = 1.0
    weighted = _shapes(shares) * weights[:, None]
    single = 0.5 * np.log(squared) @ weighted * lengths[:, None]
    double = (height[:, :, None] / squared) @ weighted * lengths[:, None]
    rows, columns = np.nonzero(near)
    exact = _exact_layers(foot[rows, columns], height[rows, columns], lengths[columns])
    single[rows, columns], double[rows, columns] = exact
    return single / (-2.0 * np.pi), double / (-2.0 * np.pi)


def _exact_layers(foot: Array, height: Array, length: Array) -> tuple[Array, Array]:
    """Integrals ∫ N_k ln ρ ds and ∫ N_k h/ρ² ds (m×3) over m straight elements in closed form.

    N_k are the three shape functions of an element of the given `length`, s is the distance from
    its start. ρ is the distance from a point, one for each element. The point lies at s = `foot`
    and at the `height` h beside the element. With v = s − foot, the integrals ∫ vᵏ ln ρ dv and
    ∫ vᵏ h/ρ² dv for k = 0, 1, 2 are evaluated at both ends.
    """
    logs, angles = [], []
    for v in (length - foot, -foot):
        squared = v**2 + height**2
        log = 0.5 * np.log(np.where(squared > 0.0, squared, 1.0))
        angle = np.arctan2(v, np.abs(height)) * np.sign(height)
        logs.append(
            [
                v * log - v + height * angle,
                0.5 * squared * log - 0.25 * squared,
                v**3 / 3.0 * log - v**3 / 9.0 + height**2 * v / 3.0 - height**3 / 3.0 * angle,
            ]
        )
        angles.append([angle, height * log, height * v - height**2 * angle])
    of_log, of_angle = (np.array(last) - np.array(first) for last, first in (logs, angles))
    # Coefficients of the shape functions N_k as polynomials in v, at (v + foot)/length.
    a, b = foot / length, 1.0 / length
    powers = (
        (1.0 - 3.0 * a + 2.0 * a**2, (4.0 * a - 3.0) * b, 2.0 * b**2),
        (4.0 * a - 4.0 * a**2, (4.0 - 8.0 * a) * b, -4.0 * b**2),
        (2.0 * a**2 - a, (4.0 * a - 1.0) * b, 2.0 * b**2),
    )
    shapes = np.array(powers)
    return (
        np.einsum("kim,im->mk", shapes, of_log),
        np.einsum("kim,im->mk", shapes, of_angle),
    )
