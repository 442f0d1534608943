"""End restraint of rigid faces on a prism's compliance: Saint-Venant's end effects, exact along x.

On the section's mesh a prism obeys E₀u″ + Gu′ − E₂u = 0 (semi-analytical finite elements, u the 3N
displacements of a section). Its solutions are twelve polynomials, rigid motions and Saint-Venant's
states of tension, torsion, bending and flexure, and fields e^{∓γx} that decay from either end
(R. A. Toupin, Arch. Rat. Mech. Anal. 18 (1965) 83; those of a strip are Papkovich's and Fadle's,
γc = 2.106 + 1.125i with c half its height). A face that stays plane and rigid needs these as well:
they hold warping by torque and shear, and with ν > 0 contraction by tension and bending.

The decaying fields v bear no resultant, and v = −w + a rigid motion on both faces, w the warping
of a state of unit wrench. By Betti's theorem the compliance changes by ∮ fᵢᵀvⱼ = −∮ vᵢᵀtⱼ, with the
tractions f of that state and t of v: twice the negative strain energy of v. Neither subtracts
compliances of the whole length. The second is computed; the first, equal to it only if v has lost
no digits, is the check.
"""

from collections.abc import Callable
from functools import partial

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eig

from fem.couplings.section_fields import SectionFields, saint_venant_states, section_fields
from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.legs import Material
from meshes.section.section_mesh import SectionMesh

# Largest difference of both forms of the change, in units of √(c_ii c_jj) of the leg with held
# faces: half the tolerance of solids with rigid faces (0.02 %). Steel walls of a hundredth of the
# side leave 1e-5, of which the change itself loses a hundredth.
_LOST = 1e-4


def restrained_compliance(mesh: SectionMesh, material: Material, length: float) -> Array:
    """6×6 change (SI, leg axes, at the tip) of a prism's tip compliance by rigid end faces.

    Tip compliance with plane, rigid faces at root and tip less that with Saint-Venant's tractions
    on both, work conjugate: negative semidefinite. Exact in x for any length, so that both ends may
    interact. Raises ComputationError if round-off dominates: moduli, or walls and sides, that
    differ by too much.
    """
    change = np.zeros((6, 6))
    for fields in section_fields(mesh, material):
        change[np.ix_(fields.twists, fields.twists)] = _change(fields, length)
    return change


class _Squares:
    """Solutions of L z = r and Lᵀy = r, L = [C 0; Bᵀ F] as in `SectionFields.squares_problem`.

    C and F have the unstrained rigid motions as null space. Loads have no resultant along them.
    """

    def __init__(self, fields: SectionFields) -> None:
        p = self.axial = fields.axial
        self.left, self.right = fields.squares_problem()
        self.coupling = self.right[:p, p:]
        rigid = fields.unstrained
        self.solve_axial = _solver(self.left[:p, :p], rigid[:p])
        self.solve_in_plane = _solver(self.left[p:, p:], rigid[p:])

    def solve(self, load: Array) -> Array:
        """Solution z (n or n×k) of L z = `load`."""
        axial = self.solve_axial(load[: self.axial])
        in_plane = self.solve_in_plane(load[self.axial :] - self.coupling.T @ axial)
        return np.concatenate([axial, in_plane])

    def solve_transposed(self, load: Array) -> Array:
        """Solution y (n or n×k) of Lᵀy = `load`."""
        in_plane = self.solve_in_plane(load[self.axial :])
        axial = self.solve_axial(load[: self.axial] - self.coupling @ in_plane)
        return np.concatenate([axial, in_plane])

    def zeros(self, fields: SectionFields) -> tuple[Array, Array]:
        """Chains of γ² = 0: z of L z₀ = 0, of a deflection L z₁ = R z₀, and y of the transposes.

        L z₁ = R z₀ has a solution if R z₀ is orthogonal to all y₀: tension and torsion, whose
        chains end there, are taken out of the deflections.
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
    """Solution of a symmetric `block` that is positive definite across `rigid` (n×k)."""
    moving = rigid[:, np.linalg.norm(rigid, axis=0) > 0.0]
    if moving.size:
        unit = np.linalg.qr(moving)[0]
        block = block + np.trace(block) / len(block) * unit @ unit.T
    return partial(cho_solve, cho_factor(block))


def _decays(fields: SectionFields) -> tuple[Array, Array]:
    """Decay rates γ (k, Re γ > 0) and the fields (n×k) of e^{γ(x − L)}, which decay from the tip.

    Those of e^{−γx}, from the root, have u_x of the other sign. Found from 1/γ² across the chains
    of γ² = 0: walls of thickness t beside a side b leave the slowest γ² only (t/b)² of the fastest
    or less, and its digits count.
    """
    squares = _Squares(fields)
    chain, adjoint = squares.zeros(fields)
    # Bi-orthogonal to the adjoint chain, as all decaying fields are.
    across = adjoint.T @ squares.right
    basis = np.linalg.qr(across.T, mode="complete")[0][:, len(across) :]
    images = squares.solve(squares.right @ basis)
    images -= chain @ np.linalg.solve(across @ chain, across @ images)
    inverses, shapes = eig(basis.T @ images)
    rates = 1.0 / np.sqrt(inverses.astype(complex))
    if not np.all(rates.real > 0.0):
        raise ComputationError(
            "end effects: decay rates along the leg are lost in rounding; moduli (E and G, say) or "
            "walls and sides of the section differ by too much"
        )
    shapes = (basis @ shapes).astype(complex)
    shapes[: fields.axial] /= rates
    return rates, np.asarray(shapes / np.linalg.norm(shapes, axis=0))


def _change(fields: SectionFields, length: float) -> Array:
    """Compliance (m×m) of the class with held faces less that with Saint-Venant's tractions."""
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
            "moduli (E and G, say) or walls and sides of the section differ by too much"
        )
    return np.asarray(0.5 * (change + change.T))
