"""Free-interface reduction: modes of the free body, and the residual flexibility of the rest.

u = R r + Φ a + Z f: rigid motions R, elastic modes Φ of the free body up to a cut-off, and the
static response Z = Σ φ_k pᵀ/λ_k of the dropped ones to wrenches at the interfaces, p = Bᵀφ_k, with
its own mass (MacNeal, Comput. Struct. 1, 1971; Rubin, AIAA J. 13, 1975). The constraint modes Ψ lie
among these u: statics are exact, and the twists of the interfaces can take the place of as many of
the amplitudes; what is left moves with all interfaces held, as in fem.reduction.craig_bampton.

Bounds. With λ = ω² the dropped modes are a flexibility H = Σ p pᵀ/(λ_k − λ) between the body of the
kept ones and its interfaces. Galerkin on Z has Σ P Pᵀ/(Λ − λ) in its place, of its Ritz values Λ,
which is too small by at most the energy of the distance of Z from Σ φ_k pᵀ/(λ_k − λ): for λ below
the cut-off λ_c by λ²/(1 − λ/λ_c) W with W = Σ p pᵀ/λ_k³. All three grow with λ. So below any
λ ≤ λ_j the true robot has no more eigenvalues than one whose interfaces hang on the kept modes by
springs as flexible as that at λ_j, without mass; and it has no fewer than the reduced (Rayleigh).
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
    """Truncation of the modes of a free body above `cutoff` (Hz).

    `squared` (s, rad²/s²): ω² of rigid motions, modes and residual modes; `shares` P (6m×s): twists
    of the interfaces in them, mass-normalised, of which the last 6m are residual; `truncated` W
    (6m×6m) on the wrenches at the interfaces.
    """

    cutoff: float
    squared: Array
    shares: Array
    truncated: Array

    def loosened(self, squared: float) -> tuple[Array, Array]:
        """Stiffness and mass (s×s) on (twists of the interfaces, rigid motions and modes).

        Of a body with no more stiffness at any λ up to `squared` than the unreduced one.
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
    """A body reduced for frequencies up to `highest_frequency` (Hz), and what bounds its error.

    `cutoff` (Hz) as for `craig_bampton.reduction`, of the free body's modes, which are the
    reduction's `frequencies`. Raises as that does, ComputationError where nothing is dropped too.
    """
    body = free_body(rooted)
    modes = counted_modes(body, chosen_cutoff(highest_frequency, cutoff))
    wrenches = rooted.solid.twists
    residual, truncated = residual_modes(body, wrenches, modes)
    if residual.shapes.shape[1] < wrenches.shape[1]:
        raise ComputationError(
            f"{body.state}: its modes up to {modes.cutoff:.6g} Hz leave nothing of its "
            "flexibility; a lower cut-off is needed"
        )
    fields = np.hstack([body.rigid, modes.shapes, residual.shapes])
    elastic = np.concatenate([modes.frequencies, residual.frequencies])
    squared = (2.0 * np.pi * np.concatenate([np.zeros(body.rigid.shape[1]), elastic])) ** 2
    shares = wrenches.T @ fields
    amplitudes, inner = _held(shares, squared)
    held = held_body(rooted)
    momenta = held.mass @ held.constraint_modes
    reduced_body = reduction_on(held, momenta, fields @ amplitudes, inner, modes, truncated)
    return reduced_body, FreeTruncation(modes.cutoff, squared, shares, truncated)


def _held(shares: Array, squared: Array) -> tuple[Array, Array]:
    """Amplitudes (s×(s−6m)) that leave the interfaces where they are, orthonormal, and their ω²."""
    sizes = np.linalg.norm(shares, axis=1)
    across = qr((shares / sizes[:, None]).T)[0][:, len(shares) :]
    values, vectors = eigh(across.T @ (squared[:, None] * across))
    return np.asarray(across @ vectors), np.asarray(values)
