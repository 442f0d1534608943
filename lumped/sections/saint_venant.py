"""Saint-Venant's torsion and flexure of a polygonal section, by boundary elements.

The coordinates s = (y, z) are relative to the centroid, Σ is ∫ s sᵀ dA, and c is Σ⁻¹F for a
transverse force F. The shear stresses due to a unit twist Gθ′ = 1 and due to F are

    torsion   τ = ∇ω + (−z, y)             ∂ω/∂n = z n_y − y n_z
    flexure   τ = ∇χ + P_0 + r P_1         ∂χ/∂n = −(P_0 + r P_1)·n,  r = νG/E
              P_0 = −½ (c₁y², c₂z²)        P_1 = ½ (y² + z²) c − yz (c₂, c₁)

with harmonic functions ω and χ. Then div τ = −c·s in the section, and τ·n = 0 on its boundary (A.
E. H. Love, A Treatise on the Mathematical Theory of Elasticity, ch. XV). All constants are
integrals over the boundary. By Green's formula, with g = (c₁y³ + c₂z³)/6, for which ∇²g = c·s,

    J = I_p − ∮ ω ∂ω/∂n ds,     ∫ ω c·s dA = ∮ (ω ∂g/∂n − g ∂ω/∂n) ds.

A harmonic function u satisfies φ(p) u(p) = ∮ (Γ ∂u/∂n − u ∂Γ/∂n) ds. Here Γ = −ln ρ/2π is Green's
function of the distance ρ from the point p, and φ(p) is the fraction of a full circle about p that
lies in the section. This equation is solved on quadratic elements whose integrals are evaluated in
closed form. Element lengths decrease geometrically towards corners, where u has a term ρ^(π/α) with
the interior angle α. The same constants are computed by finite elements in `fem.sections`.

A section may consist of regions with the same r, whose moduli E and G are w times those of a
reference material. Then Σ, c and all integrals over the section are weighted by w. Across an edge
between regions u is continuous, and w ∂u/∂n has a prescribed jump. The boundary integral equations
of the regions, each multiplied by its w, are added, so that u remains as the only unknown.
Integrals over the boundary thus become integrals over all edges, weighted by the jump of w: its
value to the left of an edge minus that to its right.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import TypeAlias

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from lumped.arrays import Array, IntArray
from lumped.sections.polygons import Loop, Partition, inner_angles, partition_edges

# Function that returns values (… × n) at n points with coordinates y and z.
_Integrand: TypeAlias = Callable[[Array, Array], Array]

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
class _Rim:
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
        return np.asarray(np.einsum("qk,ekm->eqm", _shapes(_unit_gauss()[0]), values[self.cells]))

    def integral(self, values: Array) -> Array:
        """Integral ∮ … ds over all elements of `values` times the jumps of the weight.

        `values` (E×q×…) are those at the q Gauss points of each element.
        """
        _, weights = _unit_gauss()
        weighted = np.einsum("eq...,q->e...", values, weights)
        return np.asarray(np.einsum("e...,e->...", weighted, self.lengths * self.jumps))

    @property
    def points(self) -> Array:
        """Coordinates of the Gauss points (E×q×2)."""
        return self.on(self.nodes)


@cache
def _unit_gauss() -> tuple[Array, Array]:
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


@dataclass(frozen=True, eq=False)
class RimSolution:
    """Solution of torsion and flexure for a section scaled to a size of about 1.

    `area` and `torsion_constant` J are weighted by the weight w of the regions. `shear_centre` (2)
    is relative to the weighted centroid. `shear_energies` (3×2×2) are the coefficients of 1, r and
    r² (r = νG/E) in the integrals ∫ τ_f·τ_g/w dA. τ_f and τ_g are the shear stresses due to unit
    forces along y or z through the shear centre, which do not twist the section.
    """

    area: float
    torsion_constant: float
    shear_centre: Array
    shear_energies: Array


def area_moments(loops: Sequence[Loop]) -> tuple[float, Array, Array]:
    """Area, centroid (2) and matrix Σ = ∫ s sᵀ dA (2×2, about the centroid) of a polygon.

    `loops` are its outline (counter-clockwise) and its holes (clockwise).
    """
    area = float(_polygon_integral(loops, lambda y, _: np.ones((1, *y.shape)))[0])
    centroid = _polygon_integral(loops, lambda y, z: np.array([y, z])) / area
    centred = [loop - centroid for loop in loops]
    yy, yz, zz = _polygon_integral(centred, lambda y, z: np.array([y * y, y * z, z * z]))
    return area, centroid, np.array([[yy, yz], [yz, zz]])


def weighted_moments(regions: Sequence[Region]) -> tuple[float, Array, Array]:
    """Area, centroid (2) and Σ = ∫ s sᵀ dA (2×2, about the centroid) of several regions.

    The integrals over each region are multiplied by its `weight`.
    """
    weights = np.array([region.weight for region in regions])
    areas, centroids, moments = zip(
        *(area_moments(region.loops) for region in regions), strict=True
    )
    shares = weights * np.array(areas)
    total = float(shares.sum())
    centroid = shares @ np.array(centroids) / total
    offsets = np.array(centroids) - centroid
    steiner = np.einsum("r,ri,rj->ij", shares, offsets, offsets)
    return total, centroid, np.einsum("r,rij->ij", weights, np.array(moments)) + steiner


def rim_solution(regions: Sequence[Region]) -> RimSolution:
    """Solution of torsion and flexure for a section that consists of `regions`.

    The section must be scaled to a size of about 1. The outline of a region is counter-clockwise,
    its holes are clockwise.
    """
    area, centroid, moments = weighted_moments(regions)
    centred = [
        Region([loop - centroid for loop in region.loops], region.weight) for region in regions
    ]
    rim = _rim(_edges(centred))
    slopes: Array = np.asarray(np.linalg.inv(moments), dtype=float)
    y, z = rim.points.transpose(2, 0, 1)
    n_y, n_z = rim.outward.T[:, :, None]
    twist_flux = z * n_y - y * n_z
    # Axes of the arrays of fields: force, power of r, component, then points.
    fluxes = np.einsum("fpdeq,ed->eqfp", _polynomials(slopes, y, z), rim.outward)
    data = np.concatenate([twist_flux[:, :, None], -fluxes.reshape(*fluxes.shape[:2], 4)], axis=2)
    potentials = rim.on(_potentials(rim, data))
    omega, chi = potentials[:, :, 0], potentials[:, :, 1:].reshape(fluxes.shape)

    polar = moments[0, 0] + moments[1, 1]
    torsion_constant = polar - float(rim.integral(omega * twist_flux))
    g = np.array([y, z]) ** 3 / 6.0
    g_flux = np.array([y**2 * n_y, z**2 * n_z]) / 2.0
    warped = slopes @ [
        float(rim.integral(omega * flux - value * twist_flux))
        for flux, value in zip(g_flux, g, strict=True)
    ]

    torques = _weighted_integral(
        centred,
        lambda y, z: np.einsum("fpdq,dq->fpq", _polynomials(slopes, y, z), np.array([-z, y])),
    )
    torques -= rim.integral(chi * twist_flux[:, :, None, None])
    # Only the part of the stress that does not depend on r has a divergence.
    torques[:, 0] += warped

    # ∫ χ_fp c_g·s dA is made symmetric in f and g. ∮ χ P·n ds and ∫ P·P dA are added to it.
    c_g = np.einsum("gd,deq->eqg", slopes, g)
    c_flux = np.einsum("gd,deq->eqg", slopes, g_flux)
    of_divergence = rim.integral(
        chi[..., None] * c_flux[:, :, None, None, :] + fluxes[..., None] * c_g[:, :, None, None, :]
    )
    energies = np.zeros((3, 2, 2))
    energies[:2] += of_divergence.transpose(1, 0, 2) + of_divergence.transpose(1, 2, 0)
    on_rim = rim.integral(np.einsum("eqgp,eqfs->eqpsfg", chi, fluxes))
    inside = _weighted_integral(
        centred,
        lambda y, z: np.einsum(
            "fpdq,gsdq->psfgq", _polynomials(slopes, y, z), _polynomials(slopes, y, z)
        ),
    )
    shares = np.einsum("fp,gs->psfg", torques, torques) / torsion_constant
    for p in range(2):
        for s in range(2):
            energies[p + s] += on_rim[p, s] + inside[p, s] - shares[p, s]
    energies = 0.5 * (energies + energies.transpose(0, 2, 1))
    return RimSolution(
        area=area,
        torsion_constant=torsion_constant,
        shear_centre=np.array([-warped[1], warped[0]]),
        shear_energies=energies,
    )


def _polynomials(slopes: Array, y: Array, z: Array) -> Array:
    """Polynomials P_0 and P_1 of the module docstring at points `y`, `z` (…), for unit forces.

    The axes of the result (2×2×2×…) are the force (along y or z), the index 0 or 1 of P, the
    component (y or z), and the points. `slopes` (2×2) is Σ⁻¹.
    """
    fields = np.zeros((2, 2, 2, *y.shape))
    for force, (c1, c2) in enumerate(slopes):
        fields[force, 0] = -0.5 * c1 * y**2, -0.5 * c2 * z**2
        half = 0.5 * (y**2 + z**2)
        fields[force, 1] = c1 * half - c2 * y * z, c2 * half - c1 * y * z
    return fields


def _polygon_integral(loops: Sequence[Loop], integrand: _Integrand) -> Array:
    """Integral of a polynomial (degree ≤ 10) over a polygon.

    It is the sum over the triangles between each edge and the origin.
    """
    shares, weights = _unit_gauss()
    total: Array | float = 0.0
    for loop in loops:
        ends = np.roll(loop, -1, axis=0)
        twice = loop[:, 0] * ends[:, 1] - loop[:, 1] * ends[:, 0]
        edges = loop[:, None] + shares[:, None] * (ends - loop)[:, None]
        places = shares[:, None, None, None] * edges
        areas = np.multiply.outer(shares * weights, np.multiply.outer(twice, weights))
        y, z = places[..., 0].ravel(), places[..., 1].ravel()
        total = total + integrand(y, z) @ areas.ravel()
    return np.asarray(total)


def _weighted_integral(regions: Sequence[Region], integrand: _Integrand) -> Array:
    """Integral of a polynomial (degree ≤ 10) over several regions, each times its weight."""
    integrals = [region.weight * _polygon_integral(region.loops, integrand) for region in regions]
    return np.asarray(sum(integrals))


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


def _rim(edges: _Edges) -> _Rim:
    """Mesh of boundary elements on all edges, whose lengths decrease towards all vertices."""
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
    return _Rim(
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


def _potentials(rim: _Rim, fluxes: Array) -> Array:
    """Nodal values (N×m) of m harmonic functions u of mean zero, from their normal derivatives.

    `fluxes` (E×q×m) are ∂u/∂n at the q Gauss points of each element, quadratic along the element.
    At an edge between two regions, the jump of w ∂u/∂n is the jump of the weight w times the flux.
    """
    fit = np.linalg.pinv(_shapes(_unit_gauss()[0]))
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


def _layers(rim: _Rim, points: Array) -> tuple[Array, Array]:
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
    shares, weights = _unit_gauss()
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
