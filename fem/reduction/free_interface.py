"""Free-interface reduction of a body: its free modes, and the residual flexibility of the others.

u = R r + Φ a + Z f: rigid motions R, elastic modes Φ of the free body up to a cut-off frequency,
and the static response Z = Σ φ_k pᵀ/λ_k of the dropped modes to wrenches at the interfaces, p =
Bᵀφ_k, with its mass (MacNeal, Comput. Struct. 1, 1971; Rubin, AIAA J. 13, 1975). The constraint
modes Ψ are among these u: statics are exact, and the twists of the interfaces can replace as many
amplitudes. The remaining shapes have fixed interfaces, as in `fem.reduction.craig_bampton`.

Error bounds. With λ = ω² the dropped modes are a flexibility H = Σ p pᵀ/(λ_k − λ) between the body
with the kept modes and its interfaces. Galerkin's method on Z has Σ P Pᵀ/(Λ − λ) instead, with its
Ritz values Λ. This is too small by at most the energy of the distance of Z from Σ φ_k pᵀ/(λ_k − λ),
that is, for λ below the cut-off λ_c, by λ²/(1 − λ/λ_c) W with W = Σ p pᵀ/λ_k³. All three grow with
λ. So, for any λ ≤ λ_j, the true robot has at most as many eigenvalues below λ as the one whose
interfaces are connected to the kept modes by massless springs with the flexibility at λ_j, and at
least as many as the reduced robot (Rayleigh).
"""

from dataclasses import dataclass

import numpy as np
from scipy.linalg import cho_factor, cho_solve, eigh, qr

from fem.bodies.rooted import RootedBody
from fem.reduction.counted_modes import counted_modes
from fem.reduction.craig_bampton import Reduction, chosen_cutoff, reduction_on
from fem.reduction.held import free_body, held_body, residual_modes
from lumped.arrays import Array
from lumped.errors import ComputationError


@dataclass(frozen=True, eq=False)
class FreeTruncation:
    """Data to bound the error of a free-interface reduction with modes up to `cutoff` (Hz).

    `squared` (s values, rad²/s²) are ω² of rigid motions, modes and residual modes. `shares` P
    (6m×s) are the twists of the interfaces in these, with unit modal mass; the last 6m are residual
    modes. `truncated` is W (6m×6m) on wrenches at the interfaces.
    """

    cutoff: float
    squared: Array
    shares: Array
    truncated: Array

    def loosened(self, squared: float) -> tuple[Array, Array]:
        """Stiffness and mass (s×s) of a reduced body that bounds the unreduced body.

        The unknowns are twists of the interfaces, rigid motions and modes. For any λ up to
        `squared` (rad²/s²), its dynamic stiffness is not above that of the unreduced body.
        """
        count = len(self.shares)
        kept_shares, residual = self.shares[:, :-count], self.shares[:, -count:]
        share = squared / (2.0 * np.pi * self.cutoff) ** 2
        flexibility = (residual / (self.squared[-count:] - squared)) @ residual.T
        flexibility += squared**2 / (1.0 - share) * self.truncated
        scale = 1.0 / np.sqrt(np.diag(flexibility))
        between = np.hstack([np.eye(count), -kept_shares])
        factor = cho_factor(scale[:, None] * flexibility * scale)
        spring = between.T @ (scale[:, None] * cho_solve(factor, scale[:, None] * between))
        stiffness = (spring + spring.T) / 2.0
        inner = slice(count, None)
        stiffness[inner, inner] += np.diag(self.squared[:-count])
        return stiffness, np.diag(np.repeat([0.0, 1.0], [count, len(stiffness) - count]))


def free_interface(
    rooted: RootedBody, highest_frequency: float, cutoff: float | None = None
) -> tuple[Reduction, FreeTruncation]:
    """Body reduced for frequencies up to `highest_frequency` (Hz), and data to bound the error.

    `cutoff` (Hz) is that of the modes of the free body, which are the `frequencies` of the result.
    None stands for `CUTOFF_FACTOR` times the highest frequency. Raises errors as
    `craig_bampton.reduction` does, and ComputationError if no mode is dropped.
    """
    body = free_body(rooted)
    modes = counted_modes(body, chosen_cutoff(highest_frequency, cutoff))
    wrenches = rooted.solid.twists
    residual, truncated = residual_modes(body, wrenches, modes)
    if residual.shapes.shape[1] < wrenches.shape[1]:
        raise ComputationError(
            f"{body.state}: modes up to {modes.cutoff:.6g} Hz already contain all of the "
            "flexibility at the interfaces, so that no static remainder is left; lower the cut-off"
        )
    fields = np.hstack([body.rigid, modes.shapes, residual.shapes])
    elastic = np.concatenate([modes.frequencies, residual.frequencies])
    squared = (2.0 * np.pi * np.concatenate([np.zeros(body.rigid.shape[1]), elastic])) ** 2
    shares = wrenches.T @ fields
    amplitudes, inner = _held(shares, squared)
    fixed_body = held_body(rooted)
    momenta = fixed_body.mass @ fixed_body.constraint_modes
    reduced_body = reduction_on(fixed_body, momenta, fields @ amplitudes, inner, modes, truncated)
    return reduced_body, FreeTruncation(modes.cutoff, squared, shares, truncated)


def _held(shares: Array, squared: Array) -> tuple[Array, Array]:
    """Amplitudes (s × (s − 6m)) of orthonormal shapes with fixed interfaces, and their ω².

    `shares` (6m×s) and `squared` (s values) are those of `FreeTruncation`.
    """
    sizes = np.linalg.norm(shares, axis=1)
    across = qr((shares / sizes[:, None]).T)[0][:, len(shares) :]
    values, vectors = eigh(across.T @ (squared[:, None] * across))
    return np.asarray(across @ vectors), np.asarray(values)
