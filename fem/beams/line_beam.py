"""Beam elements along a centre line: tapered, stepped, curved and bent legs.

The stiffness of an element follows from equilibrium (force method, `lumped.line_sections`). Twists
are referred to one point o. With the flexibility F of the sections and H(s) = ∫ F ds from the start
of the element, the displacement under loads at the ends alone is

    t(s) = X(s) [t₁ + H(s) C⁻¹ (t₂ − t₁)],   C = H(end),

with the twists t₁, t₂ of the ends and the shift X(s) from o to the section. This displacement is
exact at the nodes for every taper and arc, and free of locking.

The consistent mass uses the same displacements, and inner ones that vanish at both ends. Each inner
displacement belongs to one kind of strain (up to six). It has the strain b p, in which b is the
unit strain of this kind and p is linear in s, and a displacement of the form above, which makes it
vanish at the end of the element. Loads at the ends do no work on the inner displacements. Their
stiffness is therefore a block of its own, ∫ p² k ds − hᵀC⁻¹h, with h = ∫ p b ds and the section's
stiffness k. Without inner displacements the strains in tension, torsion and shear would be constant
within an element, whereas inertia makes them linear, and frequencies would converge with second
order in the element length. With them the order is four if sections and direction are smooth within
each element. In prisms the element is that of `fem.beams.beam`.
"""

import numpy as np
from scipy.sparse import coo_matrix, csr_matrix

from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.errors import InputError
from lumped.line_sections import LineSections, cumulative, gauss_points, interpolation
from lumped.mechanism.body_model import LegMatrices
from lumped.screws import shift

# Tolerance for positions at the ends of the leg, relative to its length.
ROUNDING = 1e-8


def line_beam(sections: LineSections, elements: int) -> LegMatrices:
    """Free leg along a line with about `elements` beam elements, between `LineSections.edges`.

    Unknowns: twist of the root, twist of the tip, twists of the inner nodes from root to tip, then
    the unknowns inside the elements. The leg's `centreline` is a function of positions (m) along
    the line.
    """
    if elements < 1:
        raise InputError(f"beam leg: elements = {elements!r}: must be 1 or more")
    edges = sections.edges(elements)
    lengths = np.diff(edges)
    nodes, _ = sections.line.frames(edges)
    field = sections.along(edges)
    points, weights = gauss_points()
    origins = 0.5 * (nodes[1:] + nodes[:-1])[:, None]
    to_origin = shift(origins - field.points)
    flexibility = to_origin @ field.flexibility @ np.swapaxes(to_origin, -1, -2)
    integral = 0.5 * lengths[:, None] * weights
    compliance = np.einsum("eg,egij->eij", integral, flexibility)
    inner = _inner_strains(field.rigid)
    strains = points[:, None, None] * (to_origin @ field.strains)[..., inner]
    closing = np.einsum("eg,egij->eij", integral, strains)
    stiffness = np.zeros((len(lengths), 12 + len(inner), 12 + len(inner)))
    ends = np.concatenate([-shift(origins[:, 0] - nodes[:-1]), shift(origins[:, 0] - nodes[1:])], 2)
    relative = np.linalg.solve(compliance, ends)
    closed = np.linalg.solve(compliance, closing)
    stiffness[:, :12, :12] = np.swapaxes(ends, 1, 2) @ relative
    moduli = field.stiffness[..., inner, :][..., inner]
    inner_stiffness = np.einsum("eg,egij->eij", integral * points**2, moduli)
    stiffness[:, 12:, 12:] = inner_stiffness - np.swapaxes(closing, 1, 2) @ closed

    turned, bent = cumulative(flexibility, lengths), cumulative(strains, lengths)
    start = np.zeros_like(ends)
    start[..., :6] = shift(origins[:, 0] - nodes[:-1])
    about_origin = np.concatenate(
        [start[:, None] + turned @ relative[:, None], bent - turned @ closed[:, None]], axis=3
    )
    shapes = shift(field.points - origins) @ about_origin
    mass = np.einsum("eg,egki,egkl,eglj->eij", integral, shapes, field.mass, shapes, optimize=True)
    places, size = _places(len(lengths), len(inner))

    def assembled(matrices: Array) -> SparseMatrix:
        matrices = 0.5 * (matrices + np.swapaxes(matrices, 1, 2))
        rows, columns = np.broadcast_arrays(places[:, :, None], places[:, None, :])
        entries = (matrices.ravel(), (rows.ravel(), columns.ravel()))
        return csr_matrix(coo_matrix(entries, shape=(size, size)))

    def centreline(stations: Array) -> SparseMatrix:
        return _twists(sections, edges, about_origin, origins[:, 0], places, size, stations)

    return LegMatrices(
        model="beam",
        length=sections.line.chord,
        line=sections.line,
        stiffness=assembled(stiffness),
        mass=assembled(mass),
        centreline=centreline,
    )


def _inner_strains(rigid: tuple[bool, ...]) -> IntArray:
    """Indices of the strains that vary linearly inside an element.

    The six strains are tension, two shears, torsion and two curvatures. Those that are not `rigid`
    (one flag per strain) vary linearly. If both shear strains are rigid, only tension and torsion
    are returned: bending without shear has fourth order without inner strains, as in Hermite's
    element.
    """
    if rigid[1] and rigid[2]:
        return np.array([0, 3])
    return np.flatnonzero(~np.array(rigid))


def _places(elements: int, inner: int) -> tuple[IntArray, int]:
    """Indices (elements × (12 + inner)) of each element's unknowns, and number of all unknowns.

    `inner` is the number of unknowns inside each element.
    """
    ranks: IntArray = np.r_[0, 2 : elements + 1, 1]  # of nodes in order from root to tip
    nodal = 6 * ranks[:, None] + np.arange(6)
    size = 6 * (elements + 1)
    inner_unknowns = size + np.arange(elements * inner).reshape(elements, inner)
    return np.hstack([nodal[:-1], nodal[1:], inner_unknowns]), size + inner_unknowns.size


def _twists(
    sections: LineSections,
    edges: Array,
    about_origin: Array,
    origins: Array,
    places: IntArray,
    size: int,
    stations: Array,
) -> SparseMatrix:
    """6k × `size` matrix that maps the unknowns to the twists of the sections at k `stations`.

    `stations` are distances (m) along the line. `edges` (m) are the ends of the elements, `places`
    the indices of each element's unknowns. `about_origin` (elements × points × 6 × unknowns)
    contains, for unit unknowns of each element, the twists of the sections at its Gauss points.
    These twists are referred to the element's point in `origins` (elements × 3, in m). Twists at
    the stations are interpolated from them.
    """
    positions = np.atleast_1d(np.asarray(stations, dtype=float))
    length, elements = edges[-1], len(edges) - 1
    if not np.all((positions >= -ROUNDING * length) & (positions <= (1.0 + ROUNDING) * length)):
        raise InputError(f"beam leg: a station lies outside the leg, 0 m to {length:g} m")
    cells = np.clip(np.searchsorted(edges, positions, side="left") - 1, 0, elements - 1)
    coordinates = 2.0 * (positions - edges[cells]) / np.diff(edges)[cells] - 1.0
    weights = interpolation(np.clip(coordinates, -1.0, 1.0))
    fields = np.einsum("ng,ngij->nij", weights, about_origin[cells])
    line_points, _ = sections.line.frames(np.clip(positions, 0.0, length))
    twists = shift(line_points - origins[cells]) @ fields
    rows = 6 * np.arange(len(positions))[:, None, None] + np.arange(6)[:, None]
    rows, columns = np.broadcast_arrays(rows, places[cells][:, None, :])
    entries = (twists.ravel(), (rows.ravel(), columns.ravel()))
    return csr_matrix(coo_matrix(entries, shape=(6 * len(positions), size)))
