"""Effect of rigid end faces on the compliance of a prism (Saint-Venant's end effects).

The solution is exact along x. On the mesh of the section, a prism satisfies E₀u″ + Gu′ − E₂u = 0
(semi-analytical finite elements, with the 3N displacements u of a section). Twelve solutions are
polynomials: rigid motions, and Saint-Venant's states of tension, torsion, bending and flexure. All
other solutions are fields e^{∓γx} that decay from either end (R. A. Toupin, Arch. Rat. Mech. Anal.
18 (1965) 83). In a strip, the decaying fields are the solutions of Papkovich and Fadle, with γc =
2.106 + 1.125i for half its height c. At a face that stays plane and rigid the decaying fields occur
as well: the face prevents warping by torque and shear and, if ν > 0, contraction by tension and
bending.

The decaying fields v have no resultant, and v = −w + a rigid motion on both faces, where w is the
warping of the state of a unit wrench. With the tractions f of this state and t of v, Betti's
theorem gives two forms of the change of compliance, ∮ fᵢᵀvⱼ = −∮ vᵢᵀtⱼ: it is twice the negative
strain energy of v. Neither form is a difference of compliances of the whole length. The second form
is used. The first form equals it only if v has not lost digits, which is checked.
"""

from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eig

from fem.couplings.section_fields import SectionFields, saint_venant_states, section_fields
from fem.sections.moduli import Moduli
from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh

# Largest difference between the two forms of the change of compliance, in units of √(c_ii c_jj) of
# the leg with rigid faces: half the tolerance of solids with rigid faces (0.02 %). For steel walls
# of a hundredth of the side the difference is 1e-5, of which a hundredth is an error of the change
# itself.
_LOST = 1e-4


def restrained_compliance(mesh: SectionMesh, material: Material | Moduli, length: float) -> Array:
    """Change (6×6, SI, leg axes, at the tip) of a prism's tip compliance due to rigid end faces.

    It is the tip compliance with plane, rigid faces at root and tip minus the tip compliance with
    Saint-Venant's tractions on both faces. Tip displacements are work conjugate to the loads. The
    change is negative semidefinite. It is exact in x for any `length` (m), so that the effects of
    both ends may overlap. Raises ComputationError if round-off dominates, because the moduli, or
    the wall thickness and the sides, differ by too much.
    """
    change = np.zeros((6, 6))
    for fields in section_fields(mesh, material):
        change[np.ix_(fields.twists, fields.twists)] = _change(fields, length)
    return change


class _Squares:
    """Solver of L z = r and Lᵀy = r with L = [C 0; Bᵀ F] of `SectionFields.squares_problem`.

    The null spaces of C and F contain the rigid motions without strain. A load r must therefore do
    no work on these motions.
    """

    def __init__(self, fields: SectionFields) -> None:
        p = self.axial = fields.axial
        self.left, self.right = fields.squares_problem()
        self.coupling = self.right[:p, p:]
        rigid = fields.unstrained
        self.solve_axial = _solver(self.left[:p, :p], rigid[:p])
        self.solve_in_plane = _solver(self.left[p:, p:], rigid[p:])

    def solve(self, load: Array) -> Array:
        """Solution z (n or n×k) of L z = `load`, for one or k loads."""
        axial = self.solve_axial(load[: self.axial])
        in_plane = self.solve_in_plane(load[self.axial :] - self.coupling.T @ axial)
        return np.concatenate([axial, in_plane])

    def solve_transposed(self, load: Array) -> Array:
        """Solution y (n or n×k) of Lᵀy = `load`, for one or k loads."""
        in_plane = self.solve_in_plane(load[self.axial :])
        axial = self.solve_axial(load[: self.axial] - self.coupling @ in_plane)
        return np.concatenate([axial, in_plane])

    def zeros(self, fields: SectionFields) -> tuple[Array, Array]:
        """Generalised eigenvectors (n×c each) for γ² = 0 of L z = γ² R z and of its transpose.

        The first array contains z₀ with L z₀ = 0 and, for deflections only, z₁ with L z₁ = R z₀.
        The second array contains the corresponding y₀ and y₁ of the transposed problem. A solution
        z₁ exists only if R z₀ is orthogonal to all y₀. Tension and torsion have no z₁. Multiples of
        their z₀ are therefore subtracted from the z₀ of each deflection, so that its R z₀ is
        orthogonal to the y₀ of tension and torsion.
        """
        rigid, p = fields.unstrained, self.axial
        solutions, adjoint_solutions = rigid.copy(), rigid.copy()
        solutions[p:] -= self.solve_in_plane(self.coupling.T @ rigid[:p])
        adjoint_solutions[:p] -= self.solve_axial(self.coupling @ rigid[p:])
        deflects = np.array(fields.deflects)
        if deflects.any() and not deflects.all():
            pairing = adjoint_solutions.T @ self.right @ solutions
            ends = pairing[np.ix_(~deflects, ~deflects)]
            solutions[:, deflects] -= solutions[:, ~deflects] @ np.linalg.solve(
                ends, pairing[np.ix_(~deflects, deflects)]
            )
            adjoint_solutions[:, deflects] -= adjoint_solutions[:, ~deflects] @ np.linalg.solve(
                ends.T, pairing[np.ix_(deflects, ~deflects)].T
            )
        following = self.solve(self.right @ solutions[:, deflects])
        adjoint = self.solve_transposed(self.right.T @ adjoint_solutions[:, deflects])
        return np.hstack([solutions, following]), np.hstack([adjoint_solutions, adjoint])


def _solver(block: Array, rigid: Array) -> Callable[[Array], Array]:
    """Function that solves linear equations with the symmetric matrix `block`.

    The matrix is positive semidefinite. Its null space is spanned by `rigid` (n×k).
    """
    moving = rigid[:, np.linalg.norm(rigid, axis=0) > 0.0]
    if moving.size:
        unit = np.linalg.qr(moving)[0]
        block = block + np.trace(block) / len(block) * unit @ unit.T
    return partial(cho_solve, cho_factor(block))


def _decays(fields: SectionFields) -> tuple[Array, Array]:
    """Rates γ (k, Re γ > 0) and shapes (n×k) of the fields e^{γ(x − L)}, which decay from the tip.

    The shapes of e^{−γx}, which decay from the root, have the opposite sign of u_x. The smallest γ²
    must not lose its digits: for walls of thickness t and a side b, it is at most (t/b)² times the
    largest. Rates are therefore computed from the eigenvalues 1/γ², the largest of which belongs to
    the smallest γ². The eigenvalue problem is solved in the space without the generalised
    eigenvectors of γ² = 0.
    """
    squares = _Squares(fields)
    chain, adjoint = squares.zeros(fields)
    # All decaying fields are bi-orthogonal to the adjoint eigenvectors of γ² = 0.
    across = adjoint.T @ squares.right
    basis = np.linalg.qr(across.T, mode="complete")[0][:, len(across) :]
    images = squares.solve(squares.right @ basis)
    images -= chain @ np.linalg.solve(across @ chain, across @ images)
    inverses, shapes = eig(basis.T @ images)
    rates = 1.0 / np.sqrt(inverses.astype(complex))
    if not np.all(rates.real > 0.0):
        raise ComputationError(
            "end effects: decay rates along the leg are lost in rounding; moduli such as E and "
            "G, or walls and sides of the section differ by too much"
        )
    shapes = (basis @ shapes).astype(complex)
    shapes[: fields.axial] /= rates
    return rates, np.asarray(shapes / np.linalg.norm(shapes, axis=0))


def _change(fields: SectionFields, length: float) -> Array:
    """Change of compliance (m×m) due to rigid end faces, for the m wrenches of one symmetry.

    The reference is the compliance with Saint-Venant's tractions on the faces. `length` (m) is that
    of the prism.
    """
    root, tip = (saint_venant_states(fields, x) for x in (0.0, length))
    unit = np.linalg.inv(fields.rigid.T @ tip.forces)
    warping = np.vstack([root.warping @ unit, tip.warping @ unit])
    forces = np.vstack([-root.forces @ unit, tip.forces @ unit])
    free = forces.T @ np.vstack([root.fields @ unit, tip.fields @ unit])

    rates, from_tip = _decays(fields)
    from_root = from_tip.copy()
    from_root[: fields.axial] *= -1.0
    faded = np.exp(-rates * length)
    decaying = np.block([[from_root, from_tip * faded], [from_root * faded, from_tip]])
    slopes = decaying * np.concatenate([-rates, rates])
    rigid = np.kron(np.eye(2), fields.rigid)
    solved = np.linalg.solve(np.hstack([decaying, rigid]), -warping.astype(complex))
    amplitudes = solved[: 2 * len(rates)]
    displacements, slope = (field.real for field in (decaying @ amplitudes, slopes @ amplitudes))
    n = len(fields.E0)
    at_root, at_tip = (
        fields.E0 @ slope[face] + fields.E1 @ displacements[face]
        for face in (slice(n), slice(n, None))
    )
    change = -displacements.T @ np.vstack([-at_root, at_tip])
    sizes = np.sqrt(np.maximum(np.diag(free + change), 0.0))
    if not np.all(np.abs(change - forces.T @ displacements) <= _LOST * np.outer(sizes, sizes)):
        raise ComputationError(
            f"end effects: the end restraint of rigid faces in {fields.name} is lost in rounding; "
            "moduli such as E and G, or walls and sides of the section differ by too much"
        )
    return np.asarray(0.5 * (change + change.T))
