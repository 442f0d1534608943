"""Displacement fields of a prism on the mesh of its section, for each symmetry separately.

The fields satisfy E₀u″ + Gu′ − E₂u + ω²Mu = 0 (semi-analytical finite elements), with the 3N
displacements u of a section and the derivative ′ along the prism. They are u(x) = u(0) e^{γx}.
Axial displacements p and in-plane displacements q are coupled by G only: G = [0 B; −Bᵀ 0], E₀ = [A
0; 0 D] and E₂ − ω²M = [C 0; 0 F]. With p′ = γp, the squares γ² are therefore the eigenvalues of a
problem of size 3N, [C 0; Bᵀ F] (p′, q) = γ² [A B; 0 D] (p′, q). In a wall of inclined fibres, p and
q are the fields that are odd and even under half a turn about y (`fem.sections.reversal`). The same
equations follow.

For sections symmetric about y and z this is split into four problems of a quarter of the size:
tension, torsion, bending z and bending y. With one axis of symmetry there are two: tension with
bending along the axis, torsion with bending perpendicular to it. Without symmetry there is one.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import factorial

import numpy as np
from scipy.sparse import csr_array, hstack

from fem.couplings.grips import rigid_motions
from fem.sections.moduli import Moduli
from fem.sections.reversal import images_of, reversal_of
from fem.sections.saint_venant import section_quadrature
from fem.sections.waveguide import assembled, cell_matrices, elasticity, mass_matrix
from lumped.arrays import Array, IntArray
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh, require_one_material

# Largest difference of an entry of a matrix from its mirror image, relative to the largest entry.
# Nodes have their mirror images to 1e-9 of the size, thin cells to 1e-6 of theirs.
_SAME_VALUE = 1e-5


@dataclass(frozen=True)
class _Class:
    """Fields of one symmetry in a section that is symmetric about y and z.

    `name` is the kind of deformation. `parity` contains the signs of u_x under y → −y and z → −z.
    `twists` are the indices, in the order x y z φx φy φz, of the rigid motions with this symmetry.
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
# Indices of the twists that cause no strain if they are constant along the prism: solutions for γ²
# = 0. For deflections there is a second solution (bending with a linear rotation).
_UNSTRAINED, _DEFLECTIONS = (0, 1, 2, 3), (1, 2)


@dataclass(frozen=True, eq=False)
class SectionFields:
    """Matrices (n×n) of the prism for fields of one symmetry.

    With the derivative u′ along the prism, ∫ ε·σ dA = u′E₀u′ + 2u′E₁u + uE₂u. `name` is the kind of
    deformation, or the kinds if several are coupled. The first `axial` unknowns are u_x, or the odd
    fields if fibres are inclined. `mass` is the mass matrix per length. `rigid` (n×m) are the rigid
    motions of a section, about its centroid, that have this symmetry. `twists` (m) are their
    indices in the order x y z φx φy φz.
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
        """Length of the longest chain of generalised eigenvectors for γ² = 0.

        It is 2 if there are deflections (a translation, then bending), otherwise 1.
        """
        return 2 if any(twist in _DEFLECTIONS for twist in self.twists) else 1

    @property
    def unstrained(self) -> Array:
        """Rigid motions (n×k) that cause no strain if they are the same in all sections."""
        return self.rigid[:, [twist in _UNSTRAINED for twist in self.twists]]

    @property
    def deflects(self) -> list[bool]:
        """Flags of the unstrained rigid motions: True for a deflection along y or z."""
        return [twist in _DEFLECTIONS for twist in self.twists if twist in _UNSTRAINED]

    @property
    def coupling(self) -> Array:
        """Matrix G = E₁ − E₁ᵀ (n×n) that multiplies u′ in the equations of the prism."""
        return np.asarray(self.E1 - self.E1.T)

    def squares_problem(self, omega: float = 0.0) -> tuple[Array, Array]:
        """Matrices L and R (n×n) of the eigenvalue problem L (p′, q) = γ² R (p′, q).

        It is explained at the head of the module. `omega` is the angular frequency (rad/s).
        """
        p = self.axial
        left, right = self.E2 - omega**2 * self.mass, self.E0.copy()
        left[p:, :p] = self.coupling[:p, p:].T
        right[:p, p:] = self.coupling[:p, p:]
        return left, right


@dataclass(frozen=True, eq=False)
class SectionState:
    """Saint-Venant's states (m) at one section of a prism.

    Saint-Venant's states are the solutions that are polynomials in x. `fields` (n×m) are their
    displacements, `warping` (n×m) their displacements without the rigid motion of the section.
    `forces` (n×m) are the nodal forces on the section, E₀u′ + E₁u.
    """

    fields: Array
    warping: Array
    forces: Array


def section_fields(mesh: SectionMesh, material: Material | Moduli) -> list[SectionFields]:
    """Fields of a section for each symmetry of its mesh and of its moduli.

    With two axes of symmetry the fields are "tension", "torsion", "bending y" and "bending z". With
    less symmetry, the kinds of deformation that are coupled form one entry. Rigid motions are about
    the centroid or, in a section of several materials, about the origin of its mesh. Planes normal
    to the prism must be planes of symmetry of its materials. Otherwise `material.inclined` must be
    True.
    """
    quad = section_quadrature(mesh)
    if isinstance(material, Moduli):
        E0, E1, E2 = (assembled(quad, local) for local in cell_matrices(quad, material.on(quad)))
        mass = mass_matrix(quad, material.densities)
        centred = mesh.nodes
    else:
        require_one_material(mesh)
        D = elasticity(material)
        E0, E1, E2 = (assembled(quad, local) for local in cell_matrices(quad, D))
        mass = mass_matrix(quad, material.rho)
        centred = mesh.nodes - quad.centroid
    points = np.column_stack([np.zeros(len(centred)), centred])
    motions = rigid_motions(points, np.zeros(3))
    reversal = reversal_of(centred, material)
    symmetries = _symmetries(centred, material, (E0, E2, mass))
    fields_by_symmetry = []
    for kinds in _coupled_kinds([axes for axes, _ in symmetries]):
        mirrors = [(images, _signs(axes, kinds[0].parity)) for axes, images in symmetries]
        odd, even = (reversal.basis(sign, mirrors) for sign in (-1.0, 1.0))
        basis, axial = csr_array(hstack([odd, even])), odd.shape[1]
        e0, e1, e2, m = (basis.T @ (basis.T @ matrix.T).T for matrix in (E0, E1, E2, mass))
        twists = tuple(twist for kind in kinds for twist in kind.twists)
        name = " with ".join(kind.name for kind in kinds)
        rigid = basis.T @ motions[:, twists]
        fields_by_symmetry.append(SectionFields(name, e0, e1, e2, m, axial, rigid, twists))
    return fields_by_symmetry


def _symmetries(
    nodes: Array, material: Material | Moduli, matrices: Sequence[Array]
) -> list[tuple[tuple[int, ...], IntArray]]:
    """Symmetries of a section, each as a pair of reversed axes and images of the nodes.

    The axes are 0 for y, 1 for z, or both if fibres are inclined. The images (N) are indices of
    nodes. The nodes may be symmetric although the materials are not. For several materials,
    `matrices` (3N×3N) must therefore be symmetric, too.
    """
    inclined = isinstance(material, Moduli) and material.inclined
    symmetries: list[tuple[tuple[int, ...], IntArray]] = []
    for axes in ((0, 1),) if inclined else ((0,), (1,)):
        images = images_of(nodes, (-1.0 if 0 in axes else 1.0, -1.0 if 1 in axes else 1.0))
        if images is not None and (
            isinstance(material, Material) or _is_mirrored(matrices, axes, images)
        ):
            symmetries.append((axes, images))
    return symmetries


def _coupled_kinds(reversed_axes: Sequence[tuple[int, ...]]) -> list[list[_Class]]:
    """Groups of kinds of deformation that are coupled in a section.

    Kinds are coupled if they have the same signs under all reversals in `reversed_axes`, the
    symmetries of the section.
    """
    groups: dict[tuple[float, ...], list[_Class]] = {}
    for kind in _CLASSES:
        signs = tuple(_signs(axes, kind.parity)[0] for axes in reversed_axes)
        groups.setdefault(signs, []).append(kind)
    return list(groups.values())


def _signs(axes: Sequence[int], parity: tuple[int, int]) -> list[float]:
    """Signs of u_x, u_y and u_z at the image of a node under the reversal of `axes`.

    The axes are 0 for y and 1 for z. `parity` contains the signs of u_x under y → −y and z → −z.
    Under y → −y, u_y has the opposite sign of u_x. Under z → −z, u_z has.
    """
    along = float(np.prod([parity[axis] for axis in axes]))
    return [along, *(-along if axis in axes else along for axis in (0, 1))]


def _is_mirrored(matrices: Sequence[Array], axes: Sequence[int], images: IntArray) -> bool:
    """True if matrices (3N×3N) do not change if `axes` (0 for y, 1 for z) are reversed.

    `images` (N) contains the index of the node at the image of each node.
    """
    signs = np.tile(_signs(axes, (1, 1)), len(images))
    places = (3 * images[:, None] + np.arange(3)).ravel()
    return all(
        np.abs(signs[:, None] * matrix[np.ix_(places, places)] * signs - matrix).max()
        <= _SAME_VALUE * np.abs(matrix).max()
        for matrix in matrices
    )


def _polynomial(fields: SectionFields, unstrained: int, degree: int) -> list[Array]:
    """Coefficients a_k (n each) of x^k/k! in a Saint-Venant state, the lowest first.

    They are computed from the highest to the lowest: E₂a_k = E₀a_{k+2} + Ga_{k+1}. The highest is
    the rigid motion with index `unstrained` among those without strain, and `degree` is its k. The
    mean motion of each lower a_k, weighted with the moduli, is zero: sections rotate about the
    centroid, so that flexure has no axial force.
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
    """Saint-Venant's states at x (m): tension, torsion, and bending and flexure in each plane."""
    columns, warping, slopes = [], [], []
    for number, deflects in enumerate(fields.deflects):
        for degree in (2, 3) if deflects else (1,):
            terms = np.array(_polynomial(fields, number, degree))
            powers = np.array([x**k / factorial(k) for k in range(degree + 1)])
            columns.append(powers @ terms)
            # The highest terms are rigid motions, which do not require forces.
            count = len(terms) - (2 if deflects else 1)
            warping.append(powers[:count] @ terms[:count])
            slopes.append(powers[:count] @ terms[1 : count + 1])
    warped = np.column_stack(warping)
    forces = fields.E0 @ np.column_stack(slopes) + fields.E1 @ warped
    return SectionState(np.column_stack(columns), warped, forces)
