"""Craig–Bampton reduction of a body: interfaces, fixed-interface modes, and residual modes.

The displacements are u = Ψ q + Φ a + Z b with the twists q of the interfaces, modal amplitudes a
and b, and three kinds of shapes: constraint modes Ψ; modes Φ with all interfaces fixed, K Φ = M Φ
Λ, up to a cut-off frequency (Craig and Bampton, AIAA J. 6, 1968); and residual modes Z. The
residual modes are the columns of A M Ψ (twelve for a leg) without their part in Φ, with the
flexibility A of the body with fixed interfaces. They are the response of the dropped modes to the
inertia of the motion of the interfaces. Without residual modes the error in tension decreases only
with the third power of the cut-off.

Error bounds. Eliminating all amplitudes gives the dynamic stiffness of the interfaces, λ = ω², D(λ)
= K − λM − λ² Σ p pᵀ/(λ_k − λ), p = ΨᵀMφ_k. Let λ_c be the cut-off and sum over the dropped modes. Z
spans Σ φ_k pᵀ/λ_k, so that the error of Galerkin's solution is at most the energy of its distance
from Σ φ_k pᵀ/(λ_k − λ). Therefore, for λ < λ_c, the reduced D is too large by at most λ⁴/(1 −
λ/λ_c) W with W = Σ p pᵀ/λ_k³. W = (MZ)ᵀ A (MZ) can be computed without the dropped modes. Let λ_j
be an eigenvalue of the reduced robot. For any λ ≤ λ_j, the unreduced robot has at most as many
eigenvalues below λ as the reduced robot with a mass λ_j³/(1 − λ_j/λ_c) W added at the interfaces,
and at least as many as the reduced robot (Rayleigh).
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np
from scipy.linalg import block_diag

from fem.reduction.counted_modes import CountedModes, counted_modes
from fem.reduction.held import Held, residual_modes
from fem.reduction.superelement import HeldLeg, Superelement, reduced
from lumped.arrays import Array, dense
from lumped.errors import InputError
from lumped.system import solution
from lumped.system.assembly import System

# Ratio of the cut-off to the highest requested frequency. The error of a frequency f is
# proportional to (f/f_cut)⁷ in tension and decreases faster in bending. For the first twenty
# frequencies of a robot it is 1e-5 at the highest (with 2: 3e-5, with 1.5: 3e-4), and the bound is
# 1e-4.
CUTOFF_FACTOR = 2.5


@dataclass(frozen=True, eq=False)
class CraigBampton(Superelement):
    """A reduced leg with all fixed-interface modes up to `cutoff` (Hz).

    Unknowns: 12 motions of the ends, amplitudes of the fixed-interface modes, amplitudes of the
    residual modes. `frequencies` (Hz) are those of the fixed-interface modes. `truncated` (12×12,
    in kg s⁶ for translations) is W = Σ p pᵀ/ω_k⁶ over the dropped modes, with p = ΨᵀMφ_k for the
    twists of the ends.
    """

    cutoff: float
    frequencies: Array
    truncated: Array

    def loosened(self, squared: float) -> tuple[Array, Array]:
        """Additions (n×n) to stiffness and mass that make the robot's frequencies lower bounds.

        The bound holds for ω² up to `squared` (rad²/s²), see `Truncated.loosened`.
        """
        return heavier_at_interfaces(self.truncated, self.cutoff, self.matrices.size, squared)


class Truncated(Protocol):
    """A reduced body from which modes were dropped, with the data for `frequency_bounds`."""

    @property
    def cutoff(self) -> float:
        """Frequency (Hz) below which no mode of the body has been dropped.

        Depending on the reduction, the modes are those with fixed interfaces or those of the free
        body.
        """
        ...

    def loosened(self, squared: float) -> tuple[Array, Array]:
        """Additions to stiffness and mass (n×n) that make the robot's frequencies lower bounds.

        Let K − λM be the dynamic stiffness of the interfaces after elimination of the internal
        unknowns. With the additions, that of the reduced body is not above that of the unreduced
        body, for any λ up to `squared` (rad²/s²).
        """
        ...


@dataclass(frozen=True)
class FrequencyBounds:
    """Bounds `lower` and `upper` on the frequencies (Hz, ascending) of the unreduced robot.

    `upper` are the frequencies of the reduced robot.
    """

    lower: Array
    upper: Array

    @property
    def relative_width(self) -> Array:
        """Bound on the relative error of each frequency of the reduced robot."""
        return np.asarray(1.0 - self.lower / self.upper)


@dataclass(frozen=True, eq=False)
class Reduction:
    """A body with any number of interfaces, reduced to r unknowns q.

    The unknowns are the twists of the interfaces, then modal amplitudes. Displacements are u =
    `recovery` q. `stiffness` and `mass` are r×r. `cutoff`, `frequencies` and `truncated` are
    explained in `CraigBampton`, `counted` in `fem.reduction.counted_modes`.
    """

    recovery: Array
    stiffness: Array
    mass: Array
    cutoff: float
    frequencies: Array
    truncated: Array
    counted: int | None


def heavier_at_interfaces(
    truncated: Array, cutoff: float, size: int, squared: float
) -> tuple[Array, Array]:
    """Additions to stiffness and mass (n×n) of a Craig–Bampton reduction, see `Truncated.loosened`.

    For this reduction the stiffness is not changed, and mass is added at the interfaces.
    `truncated` is the matrix W (6m×6m) on the twists of the m interfaces, `cutoff` (Hz) that of the
    modes, `size` the number n of unknowns, `squared` the largest ω² (rad²/s²) for which the bound
    holds.
    """
    added = np.zeros((size, size))
    outer = slice(len(truncated))
    share = squared / (2.0 * np.pi * cutoff) ** 2
    added[outer, outer] = squared**3 / (1.0 - share) * truncated
    return np.zeros_like(added), added


def chosen_cutoff(highest_frequency: float, cutoff: float | None) -> float:
    """Cut-off frequency (Hz): `cutoff`, or if None, `CUTOFF_FACTOR` times the highest frequency.

    Raises InputError if the cut-off is not above the highest frequency.
    """
    if not highest_frequency > 0.0:
        raise InputError(f"highest frequency = {highest_frequency!r} Hz: must be above 0 Hz")
    frequency = CUTOFF_FACTOR * highest_frequency if cutoff is None else cutoff
    if not frequency > highest_frequency:
        raise InputError(
            f"cut-off = {frequency:g} Hz: must be above the highest requested frequency, "
            f"{highest_frequency:g} Hz ({CUTOFF_FACTOR:g} times that is usual)"
        )
    return frequency


def craig_bampton(
    held: HeldLeg, highest_frequency: float, cutoff: float | None = None
) -> CraigBampton:
    """Leg reduced for frequencies up to `highest_frequency` (Hz).

    Arguments and errors are those of `reduction`.
    """
    reduced_body = reduction(held, highest_frequency, cutoff)
    superelement = reduced(held, reduced_body.recovery, reduced_body.stiffness, reduced_body.mass)
    return CraigBampton(
        matrices=superelement.matrices,
        recovery=superelement.recovery,
        cutoff=reduced_body.cutoff,
        frequencies=reduced_body.frequencies,
        truncated=reduced_body.truncated,
    )


def reduction(held: Held, highest_frequency: float, cutoff: float | None = None) -> Reduction:
    """Body reduced by Craig and Bampton's method for frequencies up to `highest_frequency` (Hz).

    `cutoff` (Hz) is that of the fixed-interface modes. None stands for `CUTOFF_FACTOR` times the
    highest frequency. Raises InputError if the cut-off is not above the highest frequency,
    ComputationError if the modes do not converge.
    """
    modes = counted_modes(held, chosen_cutoff(highest_frequency, cutoff))
    momenta = held.mass @ held.constraint_modes
    residual, truncated = residual_modes(held, momenta, modes)
    shapes = np.hstack([modes.shapes, residual.shapes])
    squared = (2.0 * np.pi * np.concatenate([modes.frequencies, residual.frequencies])) ** 2
    return reduction_on(held, momenta, shapes, squared, modes, truncated)


def reduction_on(
    held: Held,
    momenta: Array,
    shapes: Array,
    squared: Array,
    modes: CountedModes,
    truncated: Array,
) -> Reduction:
    """Body reduced to the twists of its interfaces and to `shapes` (n×k) with fixed interfaces.

    `shapes` are orthonormal with respect to the mass, and `squared` (k, in rad²/s²) are their ω².
    `momenta` (n×6m) is MΨ with the constraint modes Ψ. `modes` are the modes below the cut-off.
    `truncated` (6m×6m) is the matrix W, which bounds the effect of the other modes.
    """
    constraint = held.constraint_modes
    ends_mass = constraint.T @ momenta
    participation = shapes.T @ momenta
    return Reduction(
        recovery=np.hstack([constraint, shapes]),
        stiffness=block_diag(held.stiffness, np.diag(squared)),
        mass=np.block([[ends_mass, participation.T], [participation, np.eye(len(squared))]]),
        cutoff=modes.cutoff,
        frequencies=modes.frequencies,
        truncated=truncated,
        counted=modes.counted,
    )


def frequency_bounds(system: System, legs: Mapping[str, Truncated], count: int) -> FrequencyBounds:
    """Bounds on the first `count` frequencies of the robot without reduction of its bodies.

    `system` is the reduced robot, which was assembled from the reduced bodies in `legs`, by body
    name. Raises InputError if a frequency is not below the cut-off of each body.
    """
    dense_system = replace(system, stiffness=dense(system.stiffness), mass=dense(system.mass))
    upper = solution.modes(solution.solved(dense_system), count).frequencies
    cutoff = min(leg.cutoff for leg in legs.values())
    if upper[-1] >= cutoff:
        raise InputError(
            f"{system.name}: frequency {count} of the reduced robot is {upper[-1]:g} Hz, and "
            f"the legs' modes are cut off at {cutoff:g} Hz: raise the cut-off or request fewer"
        )
    leg_unknowns = {name: system.body_unknowns(name, np.eye(system.size)) for name in legs}
    lower = np.empty(count)
    for j, frequency in enumerate(upper):
        stiffness, mass = dense_system.stiffness.copy(), dense_system.mass.copy()
        for name, leg in legs.items():
            softer, heavier = leg.loosened((2.0 * np.pi * frequency) ** 2)
            stiffness += leg_unknowns[name].T @ softer @ leg_unknowns[name]
            mass += leg_unknowns[name].T @ heavier @ leg_unknowns[name]
        loosened = replace(dense_system, stiffness=stiffness, mass=mass)
        lower[j] = solution.modes(solution.solved(loosened), j + 1).frequencies[j]
    # If no mode is dropped, both bounds are equal to round-off.
    return FrequencyBounds(lower=np.minimum(lower, upper), upper=upper)
