"""Modes of a prismatic cantilever of any section, from displacement modes of its section.

The displacements u(x) = Σ φ_j a_j(x) are a sum of modes φ_j of the section, whose amplitudes a_j
are polynomials along the leg (Ritz). The energies are those of `fem.couplings.section_fields`,
∫ u′E₀u′ + 2u′E₁u + uE₂u dx and ∫ u̇Mu̇ dx. The first modes of the section are its rigid motions.
Each further level contains the static responses of the section, S = E₂⁻¹ without rigid motions, to
the forces that the modes of the level before it cause: S G φ (contraction by Poisson's ratio,
warping by torsion), S E₀ φ (warping by shear, flow of shear in the plane) and S M φ (walls that
bend under their own inertia). This is the expansion of slender legs in powers of height over
length, so that few levels suffice. Sections need no symmetry, and fibres may be inclined. Torsion
of open sections with restrained warping is contained.

Ends that are free to warp have Saint-Venant's tractions at the root, whose conjugate mean motions
are zero, and no tractions at the tip. Rigid ends do not move at the root, and move as rigid bodies
at the tip. Frequencies are upper bounds of those of the prism on the section's mesh.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import eigh, lu_factor, lu_solve, null_space
from scipy.sparse import block_diag, csc_array, eye_array, kron
from scipy.sparse.linalg import eigsh

from fem.couplings.section_fields import SectionFields, saint_venant_states
from lumped.arrays import Array
from lumped.model_choices import Ends

# Number of levels. In an I-section five heights long, four levels leave 0.05 % of the torsional
# frequency, which warping changes by 3 %, and 3e-5 of those of bending.
LEVELS = 4
# Degree of the amplitudes along the leg, for modes with up to two waves in the leg.
_DEGREE = 16
# Part of a response relative to its size below which it is a combination of other modes.
_DEPENDENT = 1e-7
# Rounding of the products of polynomials, most of which are orthogonal.
_ORTHOGONAL = 1e-14
# Moments per distance of a section from the point on which forces act: My = −x Fz and Mz = x Fy.
_MOMENTS_PER_LENGTH = np.zeros((6, 6))
_MOMENTS_PER_LENGTH[4, 2], _MOMENTS_PER_LENGTH[5, 1] = -1.0, 1.0


@dataclass(frozen=True, eq=False)
class PrismModes:
    """Natural `frequencies` (k, Hz) of a prism and `twists` (6s×k) of s sections along it.

    A twist is the mean motion of a section, weighted by mass. Its scale is arbitrary.
    """

    frequencies: Array
    twists: Array


def prism_modes(
    fields: SectionFields,
    length: float,
    ends: Ends,
    stations: Array,
    count: int,
    levels: int = LEVELS,
) -> PrismModes:
    """The lowest `count` modes of a cantilever of `length` (m) with the symmetry of `fields`.

    `stations` (s) are distances (m) from the root at which the twists of sections are returned.
    """
    shapes = _section_modes(fields, levels)
    matrices = [
        shapes.T @ matrix @ shapes for matrix in (fields.E0, fields.E1, fields.E2, fields.mass)
    ]
    root, tip = np.zeros((shapes.shape[1], 0)), np.eye(shapes.shape[1])
    if ends == "free":
        forces = saint_venant_states(fields, 0.0).forces
        tractions = forces @ np.linalg.inv(fields.rigid.T @ forces)
        root = null_space(tractions.T @ shapes)
    else:
        tip = tip[:, : len(fields.twists)]
    frequencies, amplitudes = _cantilever(matrices, length, root, tip, count)
    along = _polynomials(2.0 * np.asarray(stations) / length - 1.0)
    weighted = fields.mass @ fields.rigid
    mean_motions = np.linalg.solve(fields.rigid.T @ weighted, weighted.T @ shapes)
    twists = np.zeros((len(stations), 6, count))
    twists[:, fields.twists] = np.einsum("sp,tj,pjk->stk", along, mean_motions, amplitudes)
    return PrismModes(frequencies, twists.reshape(-1, count))


def saint_venant_frequencies(fields: SectionFields, length: float, count: int) -> Array:
    """Frequencies (`count`, Hz) of Timoshenko's cantilever of `length` (m) on the same section.

    The beam has the flexibility of the section's Saint-Venant states and the inertia of its rigid
    motions. The ratio of a frequency of the prism to that of this beam applies to any beam theory
    with the same section constants.
    """
    stiffness = np.asarray(np.linalg.inv(_section_flexibility(fields)), dtype=np.float64)
    # Strains of shear are v′ − φz and w′ + φy.
    turned = -_MOMENTS_PER_LENGTH.T[np.ix_(fields.twists, fields.twists)]
    matrices = (
        stiffness,
        stiffness @ turned,
        turned.T @ stiffness @ turned,
        fields.rigid.T @ fields.mass @ fields.rigid,
    )
    motions = len(stiffness)
    root, tip = np.zeros((motions, 0)), np.eye(motions)
    return _cantilever(matrices, length, root, tip, count)[0]


def _section_flexibility(fields: SectionFields) -> Array:
    """Flexibility (m×m, SI) of a section for the m resultants of one symmetry, by its states.

    It follows from the tip compliance of a short piece with Saint-Venant's tractions on its faces.
    """
    inertia = np.trace(fields.rigid.T @ fields.mass @ fields.rigid)
    length = float(np.sqrt(inertia / np.trace(fields.mass)))
    root, tip = saint_venant_states(fields, 0.0), saint_venant_states(fields, length)
    unit = np.linalg.inv(fields.rigid.T @ tip.forces)
    work = tip.forces.T @ tip.fields - root.forces.T @ root.fields
    moments = _MOMENTS_PER_LENGTH[np.ix_(fields.twists, fields.twists)]
    to_middle = np.eye(len(unit)) - 0.5 * length * moments
    middle = to_middle.T @ (unit.T @ work @ unit) @ to_middle / length
    # Bending moments vary linearly along the piece.
    flexibility = middle - length**2 / 12.0 * moments.T @ middle @ moments
    return np.asarray(0.5 * (flexibility + flexibility.T))


def _cantilever(
    matrices: Sequence[Array], length: float, root: Array, tip: Array, count: int
) -> tuple[Array, Array]:
    """Frequencies (k, Hz) and amplitudes (p×m×k) of the lowest `count` modes of a cantilever.

    `matrices` (m×m) are E₀, E₁, E₂ and M for m modes of the section. `root` and `tip` (m×…) are
    bases of the motions that are possible at both ends. Array sizes: p polynomials along the leg.
    """
    e0, e1, e2, mass = matrices
    slopes, coupling, products = _line_products(length)
    mixed = kron(coupling, e1)
    stiffness = kron(slopes, e0) + mixed + mixed.T + kron(products, e2)
    free = block_diag([csc_array(root), csc_array(tip), eye_array(len(mass) * (_DEGREE - 1))])
    squares, shapes = eigsh(
        csc_array(free.T @ stiffness @ free),
        count,
        csc_array(free.T @ kron(products, mass) @ free),
        sigma=0.0,
        v0=np.ones(free.shape[1]),
    )
    order = np.argsort(squares)
    amplitudes = (free @ shapes[:, order]).reshape(_DEGREE + 1, -1, count)
    return np.sqrt(squares[order]) / (2.0 * np.pi), amplitudes


def lowest_section_frequency(fields: SectionFields) -> float:
    """Lowest frequency (Hz) at which all sections of a leg distort or shear in phase."""
    rigid = fields.unstrained.shape[1]
    subset = [rigid, rigid]
    (square,) = eigh(fields.E2, fields.mass, subset_by_index=subset, eigvals_only=True)
    return float(np.sqrt(square) / (2.0 * np.pi))


def _section_modes(fields: SectionFields, levels: int) -> Array:
    """Modes (n×m) of a section, orthonormal with its mass matrix. The rigid motions are first."""
    null, mass = fields.unstrained, fields.mass
    weighted = mass @ null
    unit = weighted / np.linalg.norm(weighted, axis=0) * np.trace(fields.E2) / len(null)
    count = null.shape[1]
    factor = lu_factor(np.block([[fields.E2, unit], [unit.T, np.zeros((count, count))]]))

    def responses(loads: Array) -> Array:
        balanced = loads - weighted @ np.linalg.solve(null.T @ weighted, null.T @ loads)
        padded = np.vstack([balanced, np.zeros((count, loads.shape[1]))])
        return np.asarray(lu_solve(factor, padded)[: len(null)])

    section_modes = new = _independent(fields.rigid, np.zeros((len(null), 0)), mass)
    for _ in range(levels):
        loads = np.hstack([fields.coupling @ new, fields.E0 @ new, mass @ new])
        new = _independent(responses(loads), section_modes, mass)
        section_modes = np.hstack([section_modes, new])
    return section_modes


def _independent(shapes: Array, known: Array, mass: Array) -> Array:
    """Orthonormal basis (n×k) of the part of `shapes` that is orthogonal to `known` modes.

    Orthogonality is that of the `mass` matrix. Shapes that are zero up to round-off are left out.
    """
    sizes = np.sqrt(np.einsum("ij,ij->j", shapes, mass @ shapes))
    shapes = shapes[:, sizes > _ORTHOGONAL * sizes.max()]
    shapes = shapes / np.sqrt(np.einsum("ij,ij->j", shapes, mass @ shapes))
    for _ in range(2):
        shapes = shapes - known @ (known.T @ (mass @ shapes))
    squares, directions = eigh(shapes.T @ mass @ shapes)
    kept = squares > _DEPENDENT**2
    return np.asarray(shapes @ directions[:, kept] / np.sqrt(squares[kept]))


def _polynomials(points: Array, derivative: int = 0) -> Array:
    """Values (s×p) at `points` (s, from −1 to 1) of the polynomials along a leg.

    The first two are linear and 1 at the root and at the tip. The others are zero at both ends, and
    their derivatives are orthogonal.
    """
    coefficients = np.zeros((_DEGREE + 1, _DEGREE + 1))
    coefficients[:2, 0], coefficients[0, 1], coefficients[1, 1] = 0.5, -0.5, 0.5
    for degree in range(2, _DEGREE + 1):
        coefficients[degree, [degree, degree - 2]] = np.array([1.0, -1.0]) / np.sqrt(
            2.0 * (2 * degree - 1)
        )
    return np.stack(
        [legendre.legval(points, legendre.legder(row, derivative)) for row in coefficients], axis=1
    )


def _line_products(length: float) -> tuple[Array, Array, Array]:
    """Matrices ∫p′q′ dx, ∫p′q dx and ∫pq dx of the polynomials along a leg of `length` (m)."""
    points, weights = legendre.leggauss(_DEGREE + 1)
    values, slopes = _polynomials(points), _polynomials(points, 1)
    products = (
        2.0 / length * slopes.T @ (weights[:, None] * slopes),
        slopes.T @ (weights[:, None] * values),
        0.5 * length * values.T @ (weights[:, None] * values),
    )
    for product in products:
        product[np.abs(product) < _ORTHOGONAL * np.abs(product).max()] = 0.0
    return products
