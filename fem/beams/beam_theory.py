"""Natural frequencies of a prismatic cantilever in closed form: what the numbers are held against.

Tension, torsion and Euler–Bernoulli bending have explicit roots. Timoshenko bending (with its
limit of rotary inertia alone, Rayleigh) has the transcendental equation of Huang, J. Appl. Mech.
28 (1961) 579. Its roots are found here from the exact dynamic stiffness K(ω) of the beam cut into
pieces, which has the same roots but neither two cases around the second spectrum's cut-off nor
overflowing hyperbolic functions: with every piece below its own first clamped–clamped frequency,
the k-th smallest eigenvalue of K falls steadily with ω and is zero at the k-th frequency alone
(Wittrick & Williams, Q. J. Mech. Appl. Math. 24 (1971) 263). No root can be missed.
"""

from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np
import scipy
from scipy.linalg import eigvalsh, expm

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.legs import BeamProperties

Plane: TypeAlias = Literal["y", "z"]
Kind: TypeAlias = Literal["tension", "torsion", "bending y", "bending z"]

# Roots to a few units in the last place; brentq takes no relative tolerance below 4 eps.
_ROOT_TOLERANCE = 4.0 * np.finfo(float).eps
# The upper bound of a frequency may be the frequency itself: a little room for the bracket.
_ROOM = 1.0 + 1e-6


@dataclass(frozen=True)
class CantileverFrequency:
    """Frequency (Hz) number `order` (1, 2, …) of one kind of deformation of a cantilever."""

    frequency: float
    kind: Kind
    order: int


@dataclass(frozen=True)
class _Plane:
    """Bending data in one plane: EI (N m²), 1/κGA (1/N), μ (kg/m), ρI (kg m)."""

    EI: float
    shear_flexibility: float
    mu: float
    rho_I: float


def cantilever_frequencies(
    properties: BeamProperties, length: float, count: int
) -> tuple[CantileverFrequency, ...]:
    """The lowest `count` frequencies of the clamped–free leg of `length` (m), ascending."""
    by_kind: dict[Kind, Array] = {
        "tension": tension_frequencies(properties, length, count),
        "torsion": torsion_frequencies(properties, length, count),
        "bending y": bending_frequencies(properties, length, "y", count),
        "bending z": bending_frequencies(properties, length, "z", count),
    }
    merged = [
        CantileverFrequency(float(frequency), kind, order)
        for kind, frequencies in by_kind.items()
        for order, frequency in enumerate(frequencies, start=1)
    ]
    return tuple(sorted(merged, key=lambda item: item.frequency)[:count])


def tension_frequencies(properties: BeamProperties, length: float, count: int) -> Array:
    """(2k − 1)/4L √(EA/μ) in Hz, k = 1 … `count`; `length` in m."""
    return _quarter_waves(properties.EA / properties.mu, length, count)


def torsion_frequencies(properties: BeamProperties, length: float, count: int) -> Array:
    """(2k − 1)/4L √(GJ/ρJ) in Hz, k = 1 … `count`; `length` in m; sections free to warp."""
    return _quarter_waves(properties.GJ / properties.rho_J, length, count)


def bending_frequencies(
    properties: BeamProperties, length: float, plane: Plane, count: int
) -> Array:
    """Frequencies k = 1 … `count` (Hz) of bending y (EIy, along z) or z (EIz, along y).

    Euler–Bernoulli where κGA is infinite and ρI zero, Rayleigh where κGA is infinite, else
    Timoshenko with both spectra. `length` in m. Raises ComputationError where κGA is negative.
    """
    p = properties
    if plane == "y":
        beam = _Plane(p.EIy, 1.0 / p.GAz, p.mu, p.rho_Iy)
    else:
        beam = _Plane(p.EIz, 1.0 / p.GAy, p.mu, p.rho_Iz)
    if beam.shear_flexibility < 0.0:
        # Thin-walled formulas at ν far below zero: neither bounds nor roots are those of a beam.
        raise ComputationError(
            f"bending {plane}: the shear stiffness κGA = {1.0 / beam.shear_flexibility:.3g} N is "
            "negative; the formula of κ does not hold for this section and ν"
        )
    explicit: Array = euler_bernoulli_roots(count) ** 2 * np.sqrt(beam.EI / beam.mu) / length**2
    if beam.shear_flexibility == 0.0 and beam.rho_I == 0.0:
        return explicit / (2.0 * np.pi)
    bounds = _upper_bounds(beam, length, explicit)
    return np.array([_root(beam, length, k, bound) for k, bound in enumerate(bounds)]) / (
        2.0 * np.pi
    )


def euler_bernoulli_roots(count: int) -> Array:
    """The first `count` roots βL of cos x cosh x = −1: 1.875104, 4.694091, 7.854757."""

    def bounded(x: float) -> float:
        # cos x + 1/cosh x, which unlike cosh x itself never overflows.
        return float(np.cos(x) + 2.0 * np.exp(-x) / (1.0 + np.exp(-2.0 * x)))

    # One sign change between consecutive multiples of π, where cos is ±1 and 1/cosh below 1.
    return np.array(
        [
            scipy.optimize.brentq(
                bounded, k * np.pi, (k + 1) * np.pi, xtol=1e-15, rtol=_ROOT_TOLERANCE
            )
            for k in range(count)
        ]
    )


def _quarter_waves(speed_squared: float, length: float, count: int) -> Array:
    odd = 2.0 * np.arange(1, count + 1) - 1.0
    frequencies: Array = odd * np.sqrt(speed_squared) / (4.0 * length)
    return frequencies


def _upper_bounds(beam: _Plane, length: float, euler_bernoulli: Array) -> Array:
    """Bounds of ω (rad/s) from above, by minimax: each is the beam with a constraint more.

    Euler–Bernoulli has no shear strain (and less inertia), the shear beam no rotation; the beam
    whose deflection has no inertia, and no shear strain, is a bar of EI and ρI.
    """
    bounds = euler_bernoulli
    odd = 0.5 * np.pi * (2.0 * np.arange(1, len(bounds) + 1) - 1.0) / length
    if beam.shear_flexibility > 0.0:
        bounds = np.minimum(bounds, odd / np.sqrt(beam.shear_flexibility * beam.mu))
    if beam.rho_I > 0.0:
        bounds = np.minimum(bounds, odd * np.sqrt(beam.EI / beam.rho_I))
    return bounds


def _root(beam: _Plane, length: float, index: int, bound: float) -> float:
    """ω (rad/s) number `index` (from 0) of the cantilever, known to lie below `bound`."""
    pieces = _pieces(beam, length, _ROOM * bound)

    def eigenvalue(omega: float) -> float:
        return float(eigvalsh(_dynamic_stiffness(beam, length, pieces, omega))[index])

    return float(
        scipy.optimize.brentq(eigenvalue, 0.0, _ROOM * bound, xtol=1e-300, rtol=_ROOT_TOLERANCE)
    )


def _pieces(beam: _Plane, length: float, omega: float) -> int:
    """Pieces so short that each, clamped at both ends, has its first frequency above `omega`.

    With ‖w‖ ≤ (l/π)‖w′‖, ‖θ‖ ≤ (l/π)‖θ′‖ and w′ = θ + γ, Rayleigh's quotient gives
    1/ω² ≤ p² μ/EI + p (μ/κGA + ρI/EI) with p = (l/π)²; solved for p.
    """
    a = beam.mu / beam.EI
    b = beam.mu * beam.shear_flexibility + beam.rho_I / beam.EI
    p = 2.0 / omega**2 / (b + np.sqrt(b**2 + 4.0 * a / omega**2))
    return int(length / (np.pi * np.sqrt(p))) + 1


def _dynamic_stiffness(beam: _Plane, length: float, pieces: int, omega: float) -> Array:
    """K(ω) of the clamped–free beam on (w/l, θ) of the cuts and the tip, in units of EI/l."""
    piece = _piece_stiffness(beam, length / pieces, omega)
    assembled = np.zeros((2 * pieces + 2, 2 * pieces + 2))
    for first in range(0, 2 * pieces, 2):
        assembled[first : first + 4, first : first + 4] += piece
    return assembled[2:, 2:]


def _piece_stiffness(beam: _Plane, l: float, omega: float) -> Array:
    """Exact 4×4 K(ω) of a piece of length l on (w/l, θ) of both ends, in units of EI/l.

    From the exponential of the state (w, θ, V, M):
    w′ = θ + V/κGA, θ′ = M/EI, V′ = −ω²μ w, M′ = −V − ω²ρI θ.
    """
    shear = beam.shear_flexibility * beam.EI / l**2
    translation = omega**2 * beam.mu * l**4 / beam.EI
    rotation = omega**2 * beam.rho_I * l**2 / beam.EI
    transfer = expm(
        np.array(
            [
                [0.0, 1.0, shear, 0.0],
                [0.0, 0.0, 0.0, 1.0],
                [-translation, 0.0, 0.0, 0.0],
                [0.0, -rotation, -1.0, 0.0],
            ]
        )
    )
    uu, uf, fu, ff = transfer[:2, :2], transfer[:2, 2:], transfer[2:, :2], transfer[2:, 2:]
    flexible = np.linalg.inv(uf)
    return np.block([[flexible @ uu, -flexible], [fu - ff @ flexible @ uu, ff @ flexible]])
