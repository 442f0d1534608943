"""Fields of a prism on its section's mesh, one symmetry at a time: E₀u″ + Gu′ − E₂u + ω²Mu = 0.

Semi-analytical finite elements, u the 3N displacements of a section and ′ the derivative along the
prism. G couples axial (p) with in-plane (q) displacements alone, G = [0 B; −Bᵀ 0], E₀ = [A 0; 0 D]
and E₂ − ω²M = [C 0; 0 F], so that with p′ = γp the squares of exponents e^{γx} solve a problem of
size 3N, [C 0; Bᵀ F] (p′, q) = γ² [A B; 0 D] (p′, q). Sections symmetric about y and z fall into
four problems of a quarter of the size: tension, torsion, bending z and bending y.
"""

from dataclasses import dataclass
from math import factorial

import numpy as np
import scipy
from scipy.sparse import csr_array

from fem.couplings.grips import rigid_motions
from fem.sections.saint_venant import section_quadrature
from fem.sections.waveguide import assembled, elasticity, mass_matrix, strains
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.errors import InputError
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh

# Of a section without its own size a mirror image is found within this.
_SAME_PLACE = 1e-6


@dataclass(frozen=True)
class _Class:
    """Fields of one symmetry.

    `parity` of u_x under y → −y and z → −z, the `twists` (x y z φx φy φz) among its rigid motions,
    and `chain`: how many squares γ² = 0 its polynomials take.
    """

    name: str
    parity: tuple[int, int]
    twists: tuple[int, ...]
    chain: int


_CLASSES = (
    _Class("tension", (1, 1), (0,), 1),
    _Class("torsion", (-1, -1), (3,), 1),
    _Class("bending z", (-1, 1), (1, 5), 2),
    _Class("bending y", (1, -1), (2, 4), 2),
)


@dataclass(frozen=True, eq=False)
class SectionFields:
    """Matrices (n×n) of one symmetry, ∫ ε·σ = u′E₀u′ + 2u′E₁u + uE₂u; the `axial` u_x first.

    `mass`: that per length; `rigid` (n×m): its rigid motions about the centroid of a section;
    `name`, `twists` and `chain` as above.
    """

    name: str
    E0: Array
    E1: Array
    E2: Array
    mass: Array
    axial: int
    rigid: Array
    twists: tuple[int, ...]
    chain: int

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
    """Fields of a section in each symmetry: "tension", "torsion", "bending y", "bending z".

    Raises InputError for a section that is not symmetric about both of its axes.
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
    mirrors = _mirror(centred, (-1.0, 1.0)), _mirror(centred, (1.0, -1.0))
    found = []
    for kind in _CLASSES:
        basis, axial = _symmetric(mirrors, kind.parity)
        e0, e1, e2, m = (basis.T @ (basis.T @ one.T).T for one in (E0, E1, E2, mass))
        rigid = basis.T @ motions[:, kind.twists]
        found.append(SectionFields(kind.name, e0, e1, e2, m, axial, rigid, kind.twists, kind.chain))
    return found


def _symmetric(
    mirrors: tuple[IntArray, IntArray], parity: tuple[int, int]
) -> tuple[SparseMatrix, int]:
    """Orthonormal basis (3N×n) of the fields of one symmetry, and how many are of u_x (first)."""
    parts = []
    for component in range(3):
        # u_y changes sign with y → −y where u_x does not, u_z likewise with z.
        signs = [s * (-1 if component == i + 1 else 1) for i, s in enumerate(parity)]
        parts.append(_orbits(mirrors, signs, component))
    return csr_array(np.hstack(parts)), parts[0].shape[1]


def _mirror(nodes: Array, signs: tuple[float, float]) -> IntArray:
    """The node (N) at each node's mirror image."""
    size = float(np.ptp(nodes, axis=0).max())
    distance, partner = scipy.spatial.cKDTree(nodes).query(nodes * np.array(signs))
    if distance.max() > _SAME_PLACE * size:
        raise InputError("end effects: the section is not symmetric about its axes")
    return np.asarray(partner)


def _orbits(mirrors: tuple[IntArray, IntArray], signs: list[int], component: int) -> Array:
    """Normalised sums (3N×n) over the mirror images of each node, signs of the symmetry."""
    in_y, in_z = mirrors
    count = len(in_y)
    images = np.stack([np.arange(count), in_y, in_z, in_z[in_y]])
    own = np.flatnonzero(images.min(axis=0) == np.arange(count))
    columns = np.zeros((3 * count, len(own)))
    for image, weight in zip(images, (1, signs[0], signs[1], signs[0] * signs[1]), strict=True):
        np.add.at(columns, (3 * image[own] + component, np.arange(len(own))), weight)
    norms = np.linalg.norm(columns, axis=0)
    # Nodes on an axis of antisymmetry do not move.
    return np.asarray(columns[:, norms > 0.5] / norms[norms > 0.5])


def _polynomial(fields: SectionFields, degree: int) -> list[Array]:
    """Coefficients a_k (n) of x^k/k! of a state of Saint-Venant, lowest first.

    From the highest, a rigid motion, downwards: E₂a_k = E₀a_{k+2} + Ga_{k+1}.
    """
    null = fields.rigid[:, :1]
    bordered = np.block([[fields.E2, null], [null.T, np.zeros((1, 1))]])
    coefficients = [null[:, 0], np.zeros(len(null))]
    for _ in range(degree):
        load = fields.E0 @ coefficients[1] + fields.coupling @ coefficients[0]
        coefficients.insert(0, np.linalg.solve(bordered, np.append(load, 0.0))[: len(null)])
    return coefficients[:-1]


def saint_venant_states(fields: SectionFields, x: float) -> SectionState:
    """Saint-Venant's states at x: tension or torsion, or pure bending and flexure."""
    columns, warping, slopes = [], [], []
    for degree in (1,) if fields.chain == 1 else (2, 3):
        terms = np.array(_polynomial(fields, degree))
        powers = np.array([x**k / factorial(k) for k in range(degree + 1)])
        columns.append(powers @ terms)
        # The highest terms are rigid motions, which need no forces.
        own = len(terms) - fields.chain
        warping.append(powers[:own] @ terms[:own])
        slopes.append(powers[:own] @ terms[1 : own + 1])
    warped = np.column_stack(warping)
    forces = fields.E0 @ np.column_stack(slopes) + fields.E1 @ warped
    return SectionState(np.column_stack(columns), warped, forces)
