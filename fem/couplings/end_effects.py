"""What rigid end faces take from a prism's compliance: Saint-Venant's end effects, exact along x.

On the section's mesh a prism obeys E₀u″ + Gu′ − E₂u = 0 (semi-analytical finite elements, u the 3N
displacements of a section). Its solutions are twelve polynomials, rigid motions and Saint-Venant's
states of tension, torsion, bending and flexure, and fields e^{∓γx} that decay from either end
(R. A. Toupin, Arch. Rat. Mech. Anal. 18 (1965) 83; those of a strip are Papkovich's and Fadle's,
γc = 2.106 + 1.125i with c half its height). A face that stays plane and rigid needs these as well:
they hold warping by torque and shear, and with ν > 0 contraction by tension and bending.

G couples axial (p) with in-plane (q) displacements alone, G = [0 B; −Bᵀ 0], E₀ = [A 0; 0 D] and
E₂ = [C 0; 0 F], so that with p′ = γp the squares of the decay rates solve a problem of size 3N,
[C 0; Bᵀ F] (p′, q) = γ² [A B; 0 D] (p′, q). Sections symmetric about y and z fall into four
problems of a quarter of the size: tension, torsion, and bending along y and along z.
"""

from dataclasses import dataclass
from math import factorial

import numpy as np
from scipy.linalg import eig
from scipy.sparse import csr_array
from scipy.spatial import cKDTree

from fem.couplings.end_coupling import rigid_motions
from fem.sections.saint_venant import section_quadrature
from fem.sections.waveguide import assembled, elasticity, strains
from lumped.arrays import Array, IntArray, SparseMatrix
from lumped.errors import ComputationError, InputError
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
    _Class("bending y", (-1, 1), (1, 5), 2),
    _Class("bending z", (1, -1), (2, 4), 2),
)


@dataclass(frozen=True, eq=False)
class _Fields:
    """Matrices (n×n) of one symmetry, ∫ ε·σ = u′E₀u′ + 2u′E₁u + uE₂u; the `axial` u_x first.

    `rigid` (n×m): its rigid motions about the centroid of a section; `twists` and `chain` as above.
    """

    E0: Array
    E1: Array
    E2: Array
    axial: int
    rigid: Array
    twists: tuple[int, ...]
    chain: int

    @property
    def coupling(self) -> Array:
        """G = E₁ − E₁ᵀ."""
        return np.asarray(self.E1 - self.E1.T)


@dataclass(frozen=True, eq=False)
class _State:
    """Polynomial fields (n×m) at one section, and the nodal forces on it, E₀u′ + E₁u."""

    fields: Array
    forces: Array


def restrained_compliance(mesh: SectionMesh, material: Material, length: float) -> Array:
    """6×6 change (SI, leg axes, at the tip) of a prism's tip compliance by rigid end faces.

    That of plane, rigid faces at root and tip less that with Saint-Venant's tractions on both, work
    conjugate: nowhere positive. Exact in x for any length, so that both ends may interact. Raises
    InputError for a section that is not symmetric about both of its axes, ComputationError where
    moduli are so different that rounding loses the slowest decay.
    """
    change = np.zeros((6, 6))
    for fields in _all_fields(mesh, material):
        change[np.ix_(fields.twists, fields.twists)] = _change(fields, length)
    return change


def decay_rates(mesh: SectionMesh, material: Material) -> dict[str, Array]:
    """Decay rates γ (1/m, complex, slowest first) of each symmetry.

    By "tension", "torsion", "bending y" and "bending z"; raises as `restrained_compliance`.
    """
    found = (_decays(fields)[0] for fields in _all_fields(mesh, material))
    return {
        kind.name: rates[np.argsort(rates.real)]
        for kind, rates in zip(_CLASSES, found, strict=True)
    }


def _all_fields(mesh: SectionMesh, material: Material) -> list[_Fields]:
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
    centred = mesh.nodes - quad.centroid
    points = np.column_stack([np.zeros(len(centred)), centred])
    motions = rigid_motions(points, np.zeros(3))
    mirrors = _mirror(centred, (-1.0, 1.0)), _mirror(centred, (1.0, -1.0))
    found = []
    for kind in _CLASSES:
        basis, axial = _symmetric(mirrors, kind.parity)
        e0, e1, e2 = (basis.T @ (basis.T @ matrix.T).T for matrix in (E0, E1, E2))
        rigid = basis.T @ motions[:, kind.twists]
        found.append(_Fields(e0, e1, e2, axial, rigid, kind.twists, kind.chain))
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
    distance, partner = cKDTree(nodes).query(nodes * np.array(signs))
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


def _decays(fields: _Fields) -> tuple[Array, Array]:
    """Decay rates γ (k, Re γ > 0) and the fields (n×k) of e^{γ(x − L)}, which decay from the tip.

    Those of e^{−γx}, from the root, have u_x of the other sign.
    """
    p = fields.axial
    left, right = fields.E2.copy(), fields.E0.copy()
    left[p:, :p] = fields.coupling[:p, p:].T
    right[:p, p:] = fields.coupling[:p, p:]
    squares, shapes = eig(np.linalg.solve(right, left))
    kept = np.argsort(np.abs(squares))[fields.chain :]
    rates = np.sqrt(squares[kept].astype(complex))
    if not np.all(rates.real > 0.0):
        # Rates are about √(G/E) of the section's size, their squares beside four zeros of a chain.
        raise ComputationError(
            "end effects: the slowest decay along the leg is lost in rounding; moduli (E and G, "
            "say) or sides of the section differ by too much"
        )
    shapes = shapes[:, kept].astype(complex)
    shapes[:p] /= rates
    return rates, np.asarray(shapes / np.linalg.norm(shapes, axis=0))


def _polynomial(fields: _Fields, degree: int) -> list[Array]:
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


def _states(fields: _Fields, x: float) -> _State:
    """Saint-Venant's states at x: tension or torsion, or pure bending and flexure."""
    columns, slopes = [], []
    for degree in (1,) if fields.chain == 1 else (2, 3):
        terms = np.array(_polynomial(fields, degree))
        powers = np.array([x**k / factorial(k) for k in range(degree + 1)])
        columns.append(powers @ terms)
        slopes.append(powers[:-1] @ terms[1:])
    found = np.column_stack(columns)
    return _State(found, fields.E0 @ np.column_stack(slopes) + fields.E1 @ found)


def _change(fields: _Fields, length: float) -> Array:
    """Compliance (m×m) of the class with held faces less that with Saint-Venant's tractions."""
    root, tip = _states(fields, 0.0), _states(fields, length)
    carried = fields.rigid.copy()
    if fields.chain == 2:
        # A rotation about the root moves the tip sideways: φ_z along +y, φ_y along −z.
        carried[:, 1] += (length if fields.twists == (1, 5) else -length) * fields.rigid[:, 0]
    unit = np.linalg.inv(fields.rigid.T @ tip.forces)
    root = _State(root.fields @ unit, root.forces @ unit)
    tip = _State(tip.fields @ unit, tip.forces @ unit)

    rates, from_tip = _decays(fields)
    from_root = from_tip.copy()
    from_root[: fields.axial] *= -1.0
    faded = np.exp(-rates * length)
    # u = 0 at the root, the twist of the tip unknown; a rigid motion may be added to the states.
    nothing = np.zeros_like(fields.rigid)
    system = np.block(
        [
            [from_root, from_tip * faded, fields.rigid, nothing],
            [from_root * faded, from_tip, carried, -fields.rigid],
        ]
    )
    loads = -np.vstack([root.fields, tip.fields])
    held = np.linalg.solve(system, loads.astype(complex))[-fields.rigid.shape[1] :].real
    free = tip.forces.T @ tip.fields - root.forces.T @ root.fields
    return np.asarray(0.5 * (held + held.T) - free)
