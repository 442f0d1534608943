"""Fields of a prism on its section's mesh, one symmetry at a time: E₀u″ + Gu′ − E₂u + ω²Mu = 0.

Semi-analytical finite elements, u the 3N displacements of a section and ′ the derivative along the
prism. G couples axial (p) with in-plane (q) displacements alone, G = [0 B; −Bᵀ 0], E₀ = [A 0; 0 D]
and E₂ − ω²M = [C 0; 0 F], so that with p′ = γp the squares of exponents e^{γx} solve a problem of
size 3N, [C 0; Bᵀ F] (p′, q) = γ² [A B; 0 D] (p′, q). Sections symmetric about y and z fall into
four problems of a quarter of the size: tension, torsion, bending z and bending y. With one axis of
symmetry these are two problems, tension and bending along the axis, torsion and bending across it;
without any they are one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np
import scipy
from scipy.sparse import csr_array

from fem.couplings.grips import rigid_motions
from fem.sections.saint_venant import section_quadrature
from fem.sections.waveguide import assembled, elasticity, mass_matrix, strains
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh

# Largest distance of a node from a mirror image, relative to the section's size.
_SAME_PLACE = 1e-6


@dataclass(frozen=True)
class _Class:
    """Fields of one symmetry in a section that is symmetric about y and z.

    `parity` of u_x under y → −y and z → −z, and the `twists` (x y z φx φy φz) among its rigid
    motions.
    """

    name: str
    parity: tuple[int, int]
    twists: tuple[int, ...]


_CLASSES = (
    _Class("tension", (1, 1), (0,)),
    _Class("torsion", (-1, -1), (3,)),
    _Class("bending z", (-1, 1), (1, 5)),
    _Class("bending y", (1, -1), (2, 4)),
)
# Twists that strain no section by themselves: solutions of γ² = 0, of which the deflections start
# a chain of two.
_UNSTRAINED, _DEFLECTIONS = (0, 1, 2, 3), (1, 2)


@dataclass(frozen=True, eq=False)
class SectionFields:
    """Matrices (n×n) of one symmetry, ∫ ε·σ = u′E₀u′ + 2u′E₁u + uE₂u; the `axial` u_x first.

    `mass`: that per length; `rigid` (n×m): its rigid motions about the centroid of a section, its
    `twists`; `name`: of its kinds of deformation.
    """

    name: str
    E0: Array
    E1: Array
    E2: Array
    mass: Array
    axial: int
    rigid: Array
    twists: tuple[int, ...]

    @property
    def chain(self) -> int:
        """Number of squares γ² = 0 that one of its polynomials takes at most."""
        return 2 if any(twist in _DEFLECTIONS for twist in self.twists) else 1

    @property
    def unstrained(self) -> Array:
        """Rigid motions (n×k) that strain no section by themselves."""
        return self.rigid[:, [twist in _UNSTRAINED for twist in self.twists]]

    @property
    def deflects(self) -> list[bool]:
        """True for each of these that is a deflection, which starts a chain of two γ² = 0."""
        return [twist in _DEFLECTIONS for twist in self.twists if twist in _UNSTRAINED]

    @property
    def coupling(self) -> Array:
        """G = E₁ − E₁ᵀ."""
        return np.asarray(self.E1 - self.E1.T)

    def squares_problem(self, omega: float = 0.0) -> tuple[Array, Array]:
        """Matrices L, R (n×n) of L (p′, q) = γ² R (p′, q) at an angular frequency (rad/s)."""
        p = self.axial
        left, right = self.E2 - omega**2 * self.mass, self.E0.copy()
        left[p:, :p] = self.coupling[:p, p:].T
        right[:p, p:] = self.coupling[:p, p:]
        return left, right


@dataclass(frozen=True, eq=False)
class SectionState:
    """Polynomial fields (n×m) at one section.

    `warping`: these without the section's rigid motion; `forces`: nodal ones on it, E₀u′ + E₁u.
    """

    fields: Array
    warping: Array
    forces: Array


def section_fields(mesh: SectionMesh, material: Material) -> list[SectionFields]:
    """Fields of a section in each symmetry that its mesh has.

    "tension", "torsion", "bending y", "bending z" of a mesh with two axes of symmetry, and what
    is coupled of these together of another one.
    """
    quad = section_quadrature(mesh)
    in_section = strains(quad, 0.0)
    along = strains(quad, 1.0) - in_section
    # The standing wave's axial strain is −k a: here it is u_x′.
    along[:, :, 0] *= -1.0
    D = elasticity(material)
    E0, E1, E2 = (
        assembled(
            quad,
            np.einsum("mqsi,st,mqtj,mq->mij", left, D, right, quad.weights, optimize=True),
        )
        for left, right in ((along, along), (along, in_section), (in_section, in_section))
    )
    mass = mass_matrix(quad, material.rho)
    centred = mesh.nodes - quad.centroid
    points = np.column_stack([np.zeros(len(centred)), centred])
    motions = rigid_motions(points, np.zeros(3))
    mirrors = [
        None if (images := _mirror(centred, signs)) is None else (axis, images)
        for axis, signs in enumerate(((-1.0, 1.0), (1.0, -1.0)))
    ]
    present = [mirror for mirror in mirrors if mirror is not None]
    fields_by_symmetry = []
    for kinds in _coupled_kinds([axis for axis, _ in present]):
        basis, axial = _symmetric(len(centred), present, kinds[0].parity)
        e0, e1, e2, m = (basis.T @ (basis.T @ matrix.T).T for matrix in (E0, E1, E2, mass))
        twists = tuple(twist for kind in kinds for twist in kind.twists)
        name = " with ".join(kind.name for kind in kinds)
        rigid = basis.T @ motions[:, twists]
        fields_by_symmetry.append(SectionFields(name, e0, e1, e2, m, axial, rigid, twists))
    return fields_by_symmetry


def _coupled_kinds(axes: Sequence[int]) -> list[list[_Class]]:
    """Kinds of deformation that have one parity under the mirrors of these axes."""
    groups: dict[tuple[int, ...], list[_Class]] = {}
    for kind in _CLASSES:
        groups.setdefault(tuple(kind.parity[axis] for axis in axes), []).append(kind)
    return list(groups.values())


def _symmetric(
    count: int, mirrors: Sequence[tuple[int, IntArray]], parity: tuple[int, int]
) -> tuple[SparseMatrix, int]:
    """Orthonormal basis (3N×n) of the fields of one symmetry, and how many are of u_x (first)."""
    parts = []
    for component in range(3):
        # u_y changes sign with y → −y where u_x does not, u_z likewise with z.
        signed = [
            (images, parity[axis] * (-1 if component == axis + 1 else 1))
            for axis, images in mirrors
        ]
        parts.append(_orbits(count, signed, component))
    return csr_array(np.hstack(parts)), parts[0].shape[1]


def _mirror(nodes: Array, signs: tuple[float, float]) -> IntArray | None:
    """The node (N) at each node's mirror image; None if the mesh is not symmetric."""
    size = float(np.ptp(nodes, axis=0).max())
    distance, partner = scipy.spatial.cKDTree(nodes).query(nodes * np.array(signs))
    if distance.max() > _SAME_PLACE * size:
        return None
    return np.asarray(partner)


def _orbits(count: int, mirrors: Sequence[tuple[IntArray, int]], component: int) -> Array:
    """Normalised sums (3N×n) over the mirror images of each node, signs of the symmetry."""
    images, weights = np.arange(count)[None], np.ones(1)
    for mirror, sign in mirrors:
        images = np.vstack([images, mirror[images]])
        weights = np.concatenate([weights, sign * weights])
    representatives = np.flatnonzero(images.min(axis=0) == np.arange(count))
    columns = np.zeros((3 * count, len(representatives)))
    for image, weight in zip(images, weights, strict=True):
        np.add.at(
            columns,
            (3 * image[representatives] + component, np.arange(len(representatives))),
            weight,
        )
    norms = np.linalg.norm(columns, axis=0)
    # Nodes on an axis of antisymmetry do not move.
    return np.asarray(columns[:, norms > 0.5] / norms[norms > 0.5])


def _polynomial(fields: SectionFields, unstrained: int, degree: int) -> list[Array]:
    """Coefficients a_k (n) of x^k/k! of a state of Saint-Venant, lowest first.

    From the highest, the rigid motion of this number, downwards: E₂a_k = E₀a_{k+2} + Ga_{k+1}. Mean
    motions of a_k are none, as weighted with the moduli: sections turn about the centroid, so that
    flexure has no axial force.
    """
    null = fields.unstrained
    count = null.shape[1]
    means = null.T @ fields.E0
    bordered = np.block([[fields.E2, null], [means, np.zeros((count, count))]])
    coefficients = [null[:, unstrained], np.zeros(len(null))]
    for _ in range(degree):
        load = fields.E0 @ coefficients[1] + fields.coupling @ coefficients[0]
        solution = np.linalg.solve(bordered, np.append(load, np.zeros(count)))
        coefficients.insert(0, solution[: len(null)])
    return coefficients[:-1]


def saint_venant_states(fields: SectionFields, x: float) -> SectionState:
    """Saint-Venant's states at x: of each deflection pure bending and flexure, tension, torsion."""
    columns, warping, slopes = [], [], []
    for number, deflects in enumerate(fields.deflects):
        for degree in (2, 3) if deflects else (1,):
            terms = np.array(_polynomial(fields, number, degree))
            powers = np.array([x**k / factorial(k) for k in range(degree + 1)])
            columns.append(powers @ terms)
            # The highest terms are rigid motions, which need no forces.
            count = len(terms) - (2 if deflects else 1)
            warping.append(powers[:count] @ terms[:count])
            slopes.append(powers[:count] @ terms[1 : count + 1])
    warped = np.column_stack(warping)
    forces = fields.E0 @ np.column_stack(slopes) + fields.E1 @ warped
    return SectionState(np.column_stack(columns), warped, forces)
