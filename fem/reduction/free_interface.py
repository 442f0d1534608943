"""Free-interface reduction of a body: kept free modes, and residual flexibility of dropped ones.

The displacements are u = R r + Φ a + Z f with rigid motions R, elastic modes Φ of the free body up
to a cut-off frequency, and residual modes Z. The residual modes are the static response Z = Σ φ_k
pᵀ/λ_k of the dropped modes to wrenches at the interfaces, p = Bᵀφ_k (MacNeal, Comput. Struct. 1,
1971). Their mass is included (Rubin, AIAA J. 13, 1975). The constraint modes Ψ are among these u:
statics are exact, and the twists of the interfaces can replace as many amplitudes. The remaining
shapes have fixed interfaces, as in `fem.reduction.craig_bampton`.

Error bounds. With λ = ω² the dropped modes are a flexibility H = Σ p pᵀ/(λ_k − λ) between the body
with the kept modes and its interfaces. Galerkin's method on Z gives Σ P Pᵀ/(Λ − λ) instead, with
its Ritz values Λ. This is too small by at most the energy of the distance of Z from Σ φ_k pᵀ/(λ_k −
λ). For λ below the cut-off λ_c, it is too small by at most λ²/(1 − λ/λ_c) W with W = Σ p pᵀ/λ_k³.
The flexibility H, its approximation and the bound all grow with λ. Let λ_j be an eigenvalue of the
reduced robot. For any λ ≤ λ_j, the unreduced robot has at most as many eigenvalues below λ as a
robot whose interfaces are connected to the kept modes by massless springs with the approximate
flexibility plus the bound at λ_j, and at least as many as the reduced robot (Rayleigh).
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

    The reduction has s shapes: rigid motions, modes, and 6m residual modes for m interfaces, in
    this order, all with unit modal mass. `squared` (s, in rad²/s²) are their ω². `shares` P (6m×s)
    are the twists of the interfaces in the shapes. `truncated` (6m×6m) is the matrix W, on wrenches
    at the interfaces.
    """

    cutoff: float
    squared: Array
    shares: Array
    truncated: Array

    def loosened(self, squared: float) -> tuple[Array, Array]:
        """Stiffness and mass (s×s) of a reduced body that gives lower bounds of frequencies.

        The unknowns are twists of the interfaces, then amplitudes of rigid motions and modes. For
        any λ up to `squared` (rad²/s²), the dynamic stiffness of its interfaces is not above that
        of the unreduced body.
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

    `cutoff` (Hz) is the cut-off of the modes of the free body, whose frequencies are the
    `frequencies` of the result. None stands for `CUTOFF_FACTOR` times the highest frequency. Raises
    errors as `craig_bampton.reduction` does, and ComputationError if no mode is dropped.
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
    """Amplitudes (s × (s − 6m)) of orthonormal shapes with fixed interfaces, and their ω² (s − 6m).

    Each column contains the amplitudes of the s shapes of `FreeTruncation`, from which its `shares`
    (6m×s) and `squared` (s) are taken.
    """
    sizes = np.linalg.norm(shares, axis=1)
    across = qr((shares / sizes[:, None]).T)[0][:, len(shares) :]
    values, vectors = eigh(across.T @ (squared[:, None] * across))
    return np.asarray(across @ vectors), np.asarray(values)
