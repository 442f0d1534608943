"""Craig–Bampton reduction: ends, fixed-interface modes, and the static response of the rest.

u = Ψ q_ends + Φ a + Z b: constraint modes Ψ, modes K Φ = M Φ Λ with both ends held up to a cut-off
(Craig and Bampton, AIAA J. 6, 1968), and Z = A M Ψ less its share of Φ, the response of the dropped
modes to the inertia of the ends' motion (twelve residual modes; without them the error in tension
falls with the third power of the cut-off alone).

Bounds. Eliminating all amplitudes gives the dynamic stiffness of the ends, λ = ω²,
D(λ) = K − λM − λ² Σ p pᵀ/(λ_k − λ), p = ΨᵀMφ_k. Let λ_c be the cut-off and sum over dropped modes.
Z spans Σ φ_k pᵀ/λ_k, so that Galerkin's solution misses at most the energy of its distance from
Σ φ_k pᵀ/(λ_k − λ): for λ < λ_c the reduced D is too large by at most λ⁴/(1 − λ/λ_c) W with
W = Σ p pᵀ/λ_k³, and W = (MZ)ᵀ A (MZ) is known without the dropped modes. So below any λ ≤ λ_j the
true robot has no more eigenvalues than the reduced one with a mass λ_j³/(1 − λ_j/λ_c) W added at
the ends of each leg; and it has no fewer than the reduced one (Rayleigh).
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

# The error of a frequency f falls as (f/f_cut)⁷ in tension, faster in bending. For the first twenty
# frequencies of a robot 2.5 leaves 1e-5 at the highest (2: 3e-5, 1.5: 3e-4), and bounds it by 1e-4.
CUTOFF_FACTOR = 2.5


@dataclass(frozen=True, eq=False)
class CraigBampton(Superelement):
    """Superelement with all fixed-interface modes up to `cutoff` (Hz).

    Unknowns: 12 motions of the ends, then amplitudes of the fixed-interface modes and of the
    residual modes. `frequencies` (Hz): of the fixed-interface modes. `truncated`: W = Σ p pᵀ/ω_k⁶
    over the dropped modes (12×12, kg s⁶ for translations), p = ΨᵀMφ_k on the twists of the ends.
    """

    cutoff: float
    frequencies: Array
    truncated: Array

    def loosened(self, squared: float) -> tuple[Array, Array]:
        """See `Truncated`."""
        return heavier_at_interfaces(self.truncated, self.cutoff, self.matrices.size, squared)


class Truncated(Protocol):
    """A reduced body with the data for `frequency_bounds`."""

    @property
    def cutoff(self) -> float:
        """Frequency (Hz) below which all its modes of the reduction's kind are kept."""
        ...

    def loosened(self, squared: float) -> tuple[Array, Array]:
        """Additions to its stiffness and mass (n×n) that bound the unreduced body.

        With them K − λM is nowhere above that of the unreduced body, for no λ up to `squared`
        (rad²/s²), once its inner unknowns have done what they can.
        """
        ...


@dataclass(frozen=True)
class FrequencyBounds:
    """The unreduced robot's frequencies (Hz, ascending) lie between `lower` and `upper`."""

    lower: Array
    upper: Array

    @property
    def relative_width(self) -> Array:
        """Bound on the relative error of each frequency of the reduced robot, `upper`."""
        return np.asarray(1.0 - self.lower / self.upper)


@dataclass(frozen=True, eq=False)
class Reduction:
    """A body of any number of interfaces on (their twists, amplitudes) q: u = `recovery` q.

    `stiffness`, `mass` (r×r); `cutoff`, `frequencies`, `truncated` as in `CraigBampton`; `counted`
    as in `fem.reduction.counted_modes`.
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
    """Additions of `Truncated.loosened` for W (6m×6m) on n = `size` unknowns: added mass."""
    added = np.zeros((size, size))
    outer = slice(len(truncated))
    share = squared / (2.0 * np.pi * cutoff) ** 2
    added[outer, outer] = squared**3 / (1.0 - share) * truncated
    return np.zeros_like(added), added


def chosen_cutoff(highest_frequency: float, cutoff: float | None) -> float:
    """Cut-off (Hz); by default `CUTOFF_FACTOR` times the highest frequency.

    Raises InputError if it is not above the highest frequency.
    """
    if not highest_frequency > 0.0:
        raise InputError(f"highest frequency = {highest_frequency!r} Hz: must be above 0 Hz")
    frequency = CUTOFF_FACTOR * highest_frequency if cutoff is None else cutoff
    if not frequency > highest_frequency:
        raise InputError(
            f"cut-off = {frequency:g} Hz: must be above the highest frequency asked for, "
            f"{highest_frequency:g} Hz ({CUTOFF_FACTOR:g} times that is usual)"
        )
    return frequency


def craig_bampton(
    held: HeldLeg, highest_frequency: float, cutoff: float | None = None
) -> CraigBampton:
    """A leg reduced for frequencies up to `highest_frequency` (Hz); see `reduction`."""
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
    """A body reduced for frequencies up to `highest_frequency` (Hz).

    `cutoff` (Hz) of the fixed-interface modes; None means `CUTOFF_FACTOR` times the highest.
    Raises InputError for a cut-off that is not above the highest frequency, ComputationError where
    the modes do not converge.
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
    """A body on the twists of its interfaces and on `shapes` (n×k), which leave these in place.

    `shapes` are orthonormal in the mass, their ω² `squared` (k, rad²/s²); `momenta` MΨ (n×6m);
    `modes` are those below the cut-off, `truncated` bounds the others.
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
    """Bounds on the first `count` frequencies of the robot whose legs were reduced to `legs`.

    `system` is the reduced robot, assembled from the matrices of `legs` by name of the body.
    Raises InputError if a frequency is not below the cut-off of a leg.
    """
    dense_system = replace(system, stiffness=dense(system.stiffness), mass=dense(system.mass))
    upper = solution.modes(solution.solved(dense_system), count).frequencies
    cutoff = min(leg.cutoff for leg in legs.values())
    if upper[-1] >= cutoff:
        raise InputError(
            f"{system.name}: frequency {count} of the reduced robot is {upper[-1]:g} Hz, and "
            f"the legs' modes are cut off at {cutoff:g} Hz: raise the cut-off or ask for fewer"
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
    # If nothing is dropped, both are equal except for rounding.
    return FrequencyBounds(lower=np.minimum(lower, upper), upper=upper)
