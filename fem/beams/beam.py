"""Beam elements of a prismatic leg in space: tension, torsion, and bending in two planes.

All deformations use the same nodes. The unknowns of a node are its twist [x y z φx φy φz] in leg
axes. If a section rotates by θ in the plane of bending, φy = −θ for a deflection along z and φz =
+θ for a deflection along y. The mass is consistent and includes rotary inertia. For loads at the
nodes, static displacements of the nodes are exact.

Tension and torsion are quadratic along an element. Linear elements would be exact in statics, too,
but their frequencies converge with second order only. With 20 of them the third frequency would be
0.6 % in error. Bending converges with fourth order.

With warping, torsion follows `fem.sections.nonuniform_torsion` instead of Saint-Venant's theory:
besides its rotation each section has a warping intensity χ, quadratic along each element. End faces
may prevent warping (χ = 0), which increases the torsional stiffness.

Bending with shear deformation has the elements of `fem.beams.bending_elements`.

If the section does not have two axes of symmetry, both planes are coupled by EIyz θy′θz′, by the
shear strains and by ρIyz θyθz. The deflections v_s and w_s that are associated with bending and
shear are those of the shear centre (y_s, z_s), which a torque does not move. The displacements of
the centre of mass (y_m, z_m) are u + z_m φy − y_m φz, v_s − (z_m − z_s) φx and w_s + (y_m − y_s) φx
along the whole element. The nodes have the twists of the centroid.

Helical fibres couple shear with bending, so that the shear strain varies along an element. Legs
with such fibres have the elements of `fem.beams.line_beam`, by the force method, and the same
unknowns at the nodes.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from scipy.sparse import (
    block_array,
    block_diag,
    coo_matrix,
    csr_array,
    csr_matrix,
    eye_array,
    hstack,
)
from skfem import Basis, Element, ElementLineP2, MeshLine
from skfem.quadrature import get_quadrature
from skfem.refdom import RefLine

from fem.beams.bending_elements import ElementLineBeam, ElementLineShearBeam, discrete_field
from fem.beams.line_beam import ROUNDING, line_beam
from fem.sections.nonuniform_torsion import WarpingRod, line_products
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.beam_properties import BeamProperties, prism_sections
from lumped.errors import InputError
from lumped.mechanism.body_model import LegMatrices
from lumped.memo import memo
from lumped.model_choices import Ends

# Degree of the quadrature: exact for the product of two cubics, the highest degree in the mass.
_INTEGRATION_ORDER = 6
# A section does not warp if its shear stiffness against warping is below this fraction of G I_p, as
# for round sections.
_NO_WARPING = 1e-4


@dataclass(frozen=True)
class _Member:
    """Tension, torsion or bending in one plane within one beam element.

    `element` is the scikit-fem element, `mesh` a mesh of this one element. In bending the element
    has two fields, deflection and rotation. In tension its only field is the axial displacement, in
    torsion the twist angle. `stiffness` and `mass` (k×k) refer to the k unknowns of `element`,
    those of its nodes first. `components` are the indices of the fields in the twist of a section.
    `signs` (±1) are the signs of these twist components relative to the fields.
    """

    element: Element
    mesh: MeshLine
    stiffness: Array
    mass: Array
    components: tuple[int, ...]
    signs: tuple[float, ...]

    @property
    def inner(self) -> int:
        """Number of unknowns inside the element, without those of its nodes."""
        return int(self.element.interior_dofs)

    @property
    def unknown_signs(self) -> Array:
        """Signs (k values, ±1) by which the leg's unknowns differ from those of the element."""
        return np.array([*self.signs, *self.signs, *self.inner * (1.0,)])


class _Entries(NamedTuple):
    """Entries of a sparse matrix with their rows and columns.

    Entries in the same row and column are added.
    """

    values: Array
    rows: IntArray
    columns: IntArray


# The beams of legs given by their 6×6 are needed again for each distribution of the mass.
@memo(64)
def beam_leg(properties: BeamProperties, length: float, elements: int) -> LegMatrices:
    """Free leg of `length` (m) consisting of `elements` beam elements of equal length.

    Euler–Bernoulli theory is used if κGA is infinite, otherwise Timoshenko theory. Unknowns: twist
    of the root, twist of the tip, twists of the inner nodes from root to tip, then the unknowns
    inside the elements. Raises InputError if the length is not positive or there are no elements.
    """
    if not length > 0.0:
        raise InputError(f"beam leg: length = {length!r} m: must be above 0 m")
    if elements < 1:
        raise InputError(f"beam leg: elements = {elements!r}: must be 1 or more")
    # All elements have the same matrices, so that one element is integrated.
    mesh = MeshLine(np.array([0.0, length / elements]))
    p = properties
    if p.is_helical:
        return replace(line_beam(prism_sections(p, length), elements), line=None)
    GAy, GAz, GAyz = _shear_stiffnesses(p)
    # Rotary inertia about the shear centre. The centre of mass is `arm_y` and `arm_z` away from it.
    arm_y, arm_z = p.mass_y - p.centre_y, p.mass_z - p.centre_z
    rho_J = p.rho_J + p.mu * (arm_y**2 + arm_z**2 - p.mass_y**2 - p.mass_z**2)
    members = {
        "tension": _bar(mesh, p.EA, p.mu, component=0),
        "torsion": _bar(mesh, p.GJ, rho_J, component=3),
        "bending y": _bending(
            mesh, EI=p.EIy, GA=GAz, mu=p.mu, rho_I=p.rho_Iy, components=(2, 4), signs=(1.0, -1.0)
        ),
        "bending z": _bending(
            mesh, EI=p.EIz, GA=GAy, mu=p.mu, rho_I=p.rho_Iz, components=(1, 5), signs=(1.0, 1.0)
        ),
    }
    places, size = _places(members, elements)

    def entries(matrix: Array, row: str, column: str) -> _Entries:
        signs = np.outer(members[row].unknown_signs, members[column].unknown_signs)
        values = np.repeat((signs * matrix)[None], elements, axis=0)
        rows, columns = np.broadcast_arrays(places[row][:, :, None], places[column][:, None, :])
        return _Entries(values.ravel(), rows.ravel(), columns.ravel())

    def coupled(matrix: Array, row: str, column: str) -> SparseMatrix:
        block = _assembled([entries(matrix, row, column)], (size, size))
        return csr_matrix(block + block.T)

    parts = {
        name: _assembled([entries(member.stiffness, name, name)], (size, size))
        for name, member in members.items()
    }
    masses = [entries(member.mass, name, name) for name, member in members.items()]
    mass = _assembled(masses, (size, size))
    y, z = members["bending z"], members["bending y"]
    if p.couples_bending:
        both = coupled(_coupling_stiffness(y, z, p.EIyz, GAyz), "bending z", "bending y")
        parts["bending"] = csr_matrix(parts.pop("bending y") + parts.pop("bending z") + both)
        mass += coupled(_coupling_mass(y, z, (1, 1), p.rho_Iyz), "bending z", "bending y")
    if p.couples_torsion or p.is_eccentric:
        turned = members["torsion"]
        along_y = _coupling_mass(y, turned, (0, 0), -p.mu * arm_z)
        along_z = _coupling_mass(z, turned, (0, 0), p.mu * arm_y)
        mass += coupled(along_y, "bending z", "torsion") + coupled(along_z, "bending y", "torsion")
    if p.is_eccentric:
        # First moments of mass (kg) per length. Zero if the beam has no rotary inertia of bending.
        first_z, first_y = p.section_mass[0, 4], -p.section_mass[0, 5]
        # φy turns against θ of the deflection along z.
        stretched = members["tension"]
        about_z = _coupling_mass(y, stretched, (1, 0), -first_y)
        about_y = _coupling_mass(z, stretched, (1, 0), -first_z)
        mass += coupled(about_z, "bending z", "tension") + coupled(about_y, "bending y", "tension")

    def centreline(stations: Array) -> SparseMatrix:
        twists = [
            _twists(member, places[name], length, stations) for name, member in members.items()
        ]
        return _assembled(twists, (6 * np.size(stations), size))

    leg = LegMatrices(
        model="beam",
        length=length,
        stiffness=sum(parts.values()),
        mass=mass,
        centreline=centreline,
        parts=parts,
    )
    return _on_centroids(leg, elements + 1, p.to_shear_centre) if p.couples_torsion else leg


def _assembled(parts: Sequence[_Entries], shape: tuple[int, int]) -> SparseMatrix:
    """Sparse matrix (csr) that is the sum of the entries of all `parts`. Zeros are not stored."""
    values, rows, columns = (np.concatenate(of_parts) for of_parts in zip(*parts, strict=True))
    matrix = csr_matrix(coo_matrix((values, (rows, columns)), shape=shape))
    matrix.eliminate_zeros()
    return matrix


@memo(1)
def _quadrature() -> tuple[Array, Array]:
    """Quadrature points (1×p) and weights (p) of the reference element, shared by all callers.

    The arrays must not be changed.
    """
    points, weights = get_quadrature(RefLine, _INTEGRATION_ORDER)
    return points, weights


def _shear_stiffnesses(p: BeamProperties) -> tuple[float, float, float]:
    """Shear stiffnesses (N) along y and along z, and the stiffness (N) that couples them."""
    if not p.shear_yz:
        return p.GAy, p.GAz, 0.0
    stiffness = np.linalg.inv(p.shear_flexibility)
    return float(stiffness[0, 0]), float(stiffness[1, 1]), float(stiffness[0, 1])


def _coupling_stiffness(first: _Member, second: _Member, EI: float, GA: float) -> Array:
    """Stiffness ∫ EI θ₁′θ₂′ + GA γ₁γ₂ dx (k₁×k₂) between the unknowns of bending in two planes.

    `EI` (N m²) and `GA` (N) are the stiffnesses that couple the two planes.
    """
    weights, (first_fields, second_fields) = _integrated(first, second)
    (w1, theta1), (w2, theta2) = first_fields, second_fields
    gamma1, gamma2 = w1[1] - theta1[0], w2[1] - theta2[0]
    return np.asarray(EI * (theta1[1] * weights) @ theta2[1].T + GA * (gamma1 * weights) @ gamma2.T)


def _coupling_mass(
    first: _Member, second: _Member, fields: tuple[int, int], inertia: float
) -> Array:
    """Mass matrix ∫ `inertia` u₁u₂ dx (k₁×k₂) between two deformations with k₁ and k₂ unknowns.

    `fields` contains the index of u₁ among the fields of the first deformation, and that of u₂
    among the fields of the second.
    """
    weights, (first_fields, second_fields) = _integrated(first, second)
    first_field, other = first_fields[fields[0]][0], second_fields[fields[1]][0]
    return np.asarray(inertia * (first_field * weights) @ other.T)


def _integrated(*members: _Member) -> tuple[Array, list[list[tuple[Array, Array]]]]:
    """Quadrature weights (p, in m) of an element, and the fields of each member at the p points.

    The second result has an entry for each member. This entry contains, for each field of the
    member, a pair of its values and its gradients (both k×p) for the member's k unknowns.
    """
    points, weights = _quadrature()
    fields = [_fields(member.element, member.mesh, points) for member in members]
    return weights * members[0].mesh.p[0, -1], fields


def _on_centroids(leg: LegMatrices, nodes: int, to_shear_centre: Array) -> LegMatrices:
    """Transform a leg with deflections of the shear centre to a leg with twists of the centroids.

    The first unknowns of the leg are the twists of its nodes, whose number is `nodes`. The matrix
    `to_shear_centre` (6×6) gives the twist at the shear centre for a twist at the centroid.
    """
    rest = leg.size - 6 * nodes
    transformation = csr_array(
        block_diag([*[to_shear_centre] * nodes, eye_array(rest)], format="csr")
    )
    back = np.linalg.inv(to_shear_centre)

    def on_centroids(matrix: SparseMatrix) -> SparseMatrix:
        return csr_matrix(transformation.T @ csr_array(matrix) @ transformation)

    def centreline(stations: Array) -> SparseMatrix:
        of_shear_centre = csr_array(leg.centreline(stations))
        count = of_shear_centre.shape[0] // 6
        return csr_matrix(
            block_diag([back] * count, format="csr") @ of_shear_centre @ transformation
        )

    parts = {kind: on_centroids(part) for kind, part in leg.parts.items()}
    return replace(
        leg,
        stiffness=csr_matrix(sum(parts.values())),
        mass=on_centroids(leg.mass),
        centreline=centreline,
        parts=parts,
    )


def _bar(mesh: MeshLine, stiffness: float, inertia: float, component: int) -> _Member:
    """Member for tension or torsion with the displacement or rotation u.

    Twice its strain energy is ∫ `stiffness` u′² dx, and twice its kinetic energy ∫ `inertia` u̇²
    dx. In tension `stiffness` and `inertia` are EA and μ, in torsion GJ and ρJ. `component` is the
    index of u in the twist of a section.
    """

    def energy(u: Any, v: Any, _: Any) -> Any:
        return stiffness * u.grad[0] * v.grad[0]

    def inertia_of(u: Any, v: Any, _: Any) -> Any:
        return inertia * u * v

    return _member(ElementLineP2(), mesh, energy, inertia_of, (component,), (1.0,))


def _bending(
    mesh: MeshLine,
    *,
    EI: float,
    GA: float,
    mu: float,
    rho_I: float,
    components: tuple[int, int],
    signs: tuple[float, float],
) -> _Member:
    """Member for bending in one plane with deflection w and rotation θ.

    Twice its strain energy is ∫ EI θ′² + κGA (w′ − θ)² dx, with κGA = `GA`. Twice its kinetic
    energy is ∫ μ ẇ² + ρI θ̇² dx. `components` are the indices of w and θ in the twist of a section,
    `signs` the signs of these twist components relative to w and θ.
    """
    shears = np.isfinite(GA)
    # Without shear deformation w′ − θ is zero, so that the value of the shear stiffness is
    # irrelevant.
    shear_stiffness = GA if shears else 0.0

    def energy(w: Any, theta: Any, dw: Any, dtheta: Any, _: Any) -> Any:
        shear = shear_stiffness * (w.grad[0] - theta) * (dw.grad[0] - dtheta)
        return EI * theta.grad[0] * dtheta.grad[0] + shear

    def inertia_of(w: Any, theta: Any, dw: Any, dtheta: Any, _: Any) -> Any:
        return mu * w * dw + rho_I * theta * dtheta

    element = ElementLineShearBeam(EI / GA) if shears else ElementLineBeam(0.0)
    return _member(element, mesh, energy, inertia_of, components, signs)


def _member(
    element: Element,
    mesh: MeshLine,
    energy: Callable[..., Any],
    inertia: Callable[..., Any],
    components: tuple[int, ...],
    signs: tuple[float, ...],
) -> _Member:
    points, weights = _quadrature()
    fields = _fields(element, mesh, points)
    of_columns = [discrete_field(value[None], gradient[None]) for value, gradient in fields]
    of_rows = [discrete_field(value[:, None], gradient[:, None]) for value, gradient in fields]
    stiffness, mass = (
        form(*of_columns, *of_rows, None) @ weights * mesh.p[0, -1] for form in (energy, inertia)
    )
    return _Member(element, mesh, stiffness, mass, components, signs)


def _fields(element: Element, mesh: MeshLine, points: Array) -> list[tuple[Array, Array]]:
    """Values and gradients (k×p each) of each field's k basis functions at p reference points."""
    count = 2 * element.nodal_dofs + element.interior_dofs
    by_function = [element.gbasis(mesh.mapping(), points, i) for i in range(count)]
    return [
        (
            np.concatenate([np.asarray(field) for field in fields]),
            np.concatenate([field.grad[0] for field in fields]),
        )
        for fields in zip(*by_function, strict=True)
    ]


def _places(members: dict[str, _Member], elements: int) -> tuple[dict[str, IntArray], int]:
    """Indices of the leg's unknowns in each element, by member, and number of the leg's unknowns.

    The indices are an array (elements × k) for a member with k unknowns.
    """
    ranks: IntArray = np.r_[0, 2 : elements + 1, 1]  # of nodes in order from root to tip
    size = 6 * (elements + 1)
    places = {}
    for name, member in members.items():
        nodal = 6 * ranks[:, None] + np.array(member.components)
        inner = size + np.arange(elements * member.inner).reshape(elements, member.inner)
        places[name] = np.hstack([nodal[:-1], nodal[1:], inner])
        size += inner.size
    return places, size


def _twists(member: _Member, places: IntArray, length: float, stations: Array) -> _Entries:
    """Entries of the matrix (6k × unknowns) from the leg's unknowns to the twists of k sections.

    They are the contribution of one `member`. `places` are its indices from `_places`, `length` (m)
    is that of the leg, and `stations` are distances (m) of the sections from the root.
    """
    stations = np.atleast_1d(np.asarray(stations, dtype=float))
    slack = ROUNDING * length
    if not np.all((stations >= -slack) & (stations <= length + slack)):
        raise InputError(f"beam leg: a station lies outside the leg, 0 m to {length:g} m")
    elements = len(places)
    along = stations * (elements / length)
    cells = np.clip(np.ceil(along).astype(int) - 1, 0, elements - 1)
    fields = _fields(member.element, member.mesh, (along - cells)[None])
    rows, columns, values = [], [], []
    for (field, _), component, sign in zip(fields, member.components, member.signs, strict=True):
        rows.append(np.broadcast_to(6 * np.arange(len(stations)) + component, field.shape))
        columns.append(places[cells].T)
        values.append(sign * member.unknown_signs[:, None] * field)
    return _Entries(np.ravel(values), np.ravel(rows), np.ravel(columns))


def warping_beam_leg(
    properties: BeamProperties, rod: WarpingRod, length: float, elements: int, ends: Ends
) -> LegMatrices:
    """Free Timoshenko leg of `length` (m) with warping, consisting of `elements` beam elements.

    The unknowns are those of `beam_leg`, followed by the warping intensity χ (1/m) at the nodes and
    inside the elements. If `ends` is "rigid", χ is zero at both end faces. Legs with a round
    section or with walls of helical fibres have no χ and are those of `beam_leg`.
    """
    leg = beam_leg(properties, length, elements)
    if properties.is_helical or rod.shear <= _NO_WARPING * rod.twist:
        return leg
    return with_warping(leg, rod, elements, ends)


def with_warping(leg: LegMatrices, rod: WarpingRod, elements: int, ends: Ends) -> LegMatrices:
    """Leg of `beam_leg` in which the torsion of `rod`, with warping, replaces Saint-Venant torsion.

    `elements` must be the number of elements of the leg. If `ends` is "rigid", warping is prevented
    at both end faces.
    """
    basis = Basis(MeshLine(np.linspace(0.0, leg.length, elements + 1)), ElementLineP2())
    places = basis.doflocs[0]
    inside = (places > 0.0) & (places < leg.length)
    free_nodes = np.flatnonzero(inside) if ends == "rigid" else np.arange(len(places))
    # Matrix from the leg's unknowns to the rotation about x at the nodes of quadratic elements.
    rotation = csr_array(leg.centreline(places))[3::6]
    gradients, coupling, products = line_products(basis)
    cross = csr_array(-rod.shear * (coupling[free_nodes] @ rotation))
    warping = (
        rod.shear * products[free_nodes][:, free_nodes]
        + rod.bimoment * gradients[free_nodes][:, free_nodes]
    )
    torsion = csr_matrix(
        block_array([[rotation.T @ (rod.twist * gradients) @ rotation, cross.T], [cross, warping]])
    )

    def wide(matrix: SparseMatrix) -> SparseMatrix:
        return csr_matrix(block_diag([matrix, csr_array((len(free_nodes), len(free_nodes)))]))

    def centreline(stations: Array) -> SparseMatrix:
        twists = leg.centreline(stations)
        return csr_matrix(hstack([twists, csr_array((twists.shape[0], len(free_nodes)))]))

    other_parts = {kind: wide(part) for kind, part in leg.parts.items() if kind != "torsion"}
    parts = {**other_parts, "torsion": torsion}
    mass = block_diag([leg.mass, rod.warping * products[free_nodes][:, free_nodes]])
    return LegMatrices(
        model="beam with warping",
        length=leg.length,
        stiffness=csr_matrix(sum(parts.values())),
        mass=csr_matrix(mass),
        centreline=centreline,
        parts=parts,
    )
