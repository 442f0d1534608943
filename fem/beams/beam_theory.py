"""Natural frequencies of a prismatic cantilever in closed form, as reference values.

Tension, torsion and Euler–Bernoulli bending have explicit roots. Timoshenko bending (with its
limit of rotary inertia alone, Rayleigh) has the transcendental equation of Huang, J. Appl. Mech.
28 (1961) 579. Its roots are found here from the exact dynamic stiffness K(ω) of the beam cut into
pieces, which has the same roots but neither two cases around the second spectrum's cut-off nor
overflowing hyperbolic functions: with every piece below its own first clamped–clamped frequency,
the k-th smallest eigenvalue of K falls steadily with ω and is zero at the k-th frequency alone
(Wittrick & Williams, Q. J. Mech. Appl. Math. 24 (1971) 263). No root can be missed.

Sections without two axes of symmetry couple bending in both planes, or bending and torsion
(`BeamProperties`): one kind "coupled", with the same method on all deflections and rotations.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from heapq import merge
from itertools import count as naturals
from itertools import islice
from math import pi, sqrt
from typing import Literal, TypeAlias

import numpy as np
import scipy
from scipy.linalg import eigvalsh, expm

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.legs import BeamProperties
from lumped.memo import memo

Plane: TypeAlias = Literal["y", "z"]
Kind: TypeAlias = Literal["tension", "torsion", "bending y", "bending z", "coupled"]

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


@memo(64)
def cantilever_frequencies(
    properties: BeamProperties, length: float, count: int
) -> tuple[CantileverFrequency, ...]:
    """The lowest `count` frequencies of the clamped–free leg of `length` (m), ascending."""
    # Of each kind no more than one is computed that is not among the lowest.
    kinds = (_ascending(properties, length, kind) for kind in kinds_of(properties))
    return tuple(islice(merge(*kinds, key=lambda item: item.frequency), count))


def kinds_of(properties: BeamProperties) -> tuple[Kind, ...]:
    """Kinds of deformation that vibrate by themselves."""
    if properties.couples_bending or properties.couples_torsion:
        return "tension", "coupled"
    return "tension", "torsion", "bending y", "bending z"


def _ascending(
    properties: BeamProperties, length: float, kind: Kind
) -> Iterator[CantileverFrequency]:
    """All frequencies of one kind."""
    for order in naturals(1):
        frequency = frequency_of_kind(properties, length, kind, order)
        yield CantileverFrequency(frequency, kind, order)


def frequency_of_kind(properties: BeamProperties, length: float, kind: Kind, order: int) -> float:
    """Frequency (Hz) number `order` of one kind; raises as `bending_frequencies` does."""
    match kind:
        case "tension":
            return _quarter_waves(properties.EA / properties.mu, length, order)
        case "torsion":
            return _quarter_waves(properties.GJ / properties.rho_J, length, order)
        case "bending y":
            return _bending_frequency(_plane(properties, "y"), length, order)
        case "bending z":
            return _bending_frequency(_plane(properties, "z"), length, order)
        case "coupled":
            return _coupled_frequency(properties, length, order)


def tension_frequencies(properties: BeamProperties, length: float, count: int) -> Array:
    """(2k − 1)/4L √(EA/μ) in Hz, k = 1 … `count`; `length` in m."""
    return _of_kind(properties, length, "tension", count)


def torsion_frequencies(properties: BeamProperties, length: float, count: int) -> Array:
    """(2k − 1)/4L √(GJ/ρJ) in Hz, k = 1 … `count`; `length` in m; sections free to warp."""
    return _of_kind(properties, length, "torsion", count)


def bending_frequencies(
    properties: BeamProperties, length: float, plane: Plane, count: int
) -> Array:
    """Frequencies k = 1 … `count` (Hz) of bending y (EIy, along z) or z (EIz, along y).

    Euler–Bernoulli where κGA is infinite and ρI zero, Rayleigh where κGA is infinite, else
    Timoshenko with both spectra. `length` in m. Raises ComputationError where κGA is negative.
    """
    return _of_kind(properties, length, "bending y" if plane == "y" else "bending z", count)


def _of_kind(properties: BeamProperties, length: float, kind: Kind, count: int) -> Array:
    orders = range(1, count + 1)
    return np.array([frequency_of_kind(properties, length, kind, order) for order in orders])


def _plane(p: BeamProperties, plane: Plane) -> _Plane:
    """Bending data of one plane; raises ComputationError if κGA is negative."""
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
    return beam


def _bending_frequency(beam: _Plane, length: float, order: int) -> float:
    """Frequency (Hz) number `order` of bending."""
    root = _euler_bernoulli_root(order)
    explicit = root**2 * sqrt(beam.EI / beam.mu) / length**2
    if beam.shear_flexibility == 0.0 and beam.rho_I == 0.0:
        return explicit / (2.0 * pi)
    bound = _upper_bound(beam, length, order, explicit)
    return _root(beam, length, order - 1, bound) / (2.0 * pi)


def euler_bernoulli_roots(count: int) -> Array:
    """The first `count` roots βL of cos x cosh x = −1: 1.875104, 4.694091, 7.854757."""
    return np.array([_euler_bernoulli_root(order) for order in range(1, count + 1)])


@memo(64)
def _euler_bernoulli_root(order: int) -> float:
    def bounded(x: float) -> float:
        # cos x + 1/cosh x, which unlike cosh x itself never overflows.
        return float(np.cos(x) + 2.0 * np.exp(-x) / (1.0 + np.exp(-2.0 * x)))

    # One sign change between consecutive multiples of π, where cos is ±1 and 1/cosh below 1.
    bracket = (order - 1) * pi, order * pi
    return float(scipy.optimize.brentq(bounded, *bracket, xtol=1e-15, rtol=_ROOT_TOLERANCE))


def _quarter_waves(speed_squared: float, length: float, order: int) -> float:
    return (2.0 * order - 1.0) * sqrt(speed_squared) / (4.0 * length)


def _upper_bound(beam: _Plane, length: float, order: int, euler_bernoulli: float) -> float:
    """Upper bound of ω (rad/s) by minimax: each candidate is the beam with one more constraint.

    Euler–Bernoulli has no shear strain (and less inertia), the shear beam no rotation; the beam
    whose deflection has no inertia, and no shear strain, is a bar of EI and ρI.
    """
    bound = euler_bernoulli
    odd = 0.5 * pi * (2.0 * order - 1.0) / length
    if beam.shear_flexibility > 0.0:
        bound = min(bound, odd / sqrt(beam.shear_flexibility * beam.mu))
    if beam.rho_I > 0.0:
        bound = min(bound, odd * sqrt(beam.EI / beam.rho_I))
    return bound


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


@dataclass(frozen=True, eq=False)
class _Coupled:
    """State equations of bending in both planes with torsion, in units of `size` and EI.

    Unknowns are v_s and w_s of the shear centre, φx, θ of deflection along y and along z; forces
    are conjugate to these: with `flexibility` (5×5) and `mass` (5×5), and θ in v_s′ and w_s′.
    """

    flexibility: Array
    mass: Array
    unit_squared: float


def _coupled(p: BeamProperties, size: float) -> _Coupled:
    """The equations, lengths in `size` (m), ω² in EI/(μ size⁴)."""
    EI, mu = max(p.EIy, p.EIz), p.mu
    flexibility = np.zeros((5, 5))
    flexibility[:2, :2] = p.shear_flexibility * EI / size**2
    flexibility[2, 2] = EI / p.GJ
    flexibility[3:, 3:] = EI * np.linalg.inv(p.bending)
    # The centroid moves by v_s + z_s φx and w_s − y_s φx.
    arm = np.array([p.centre_z, -p.centre_y]) / size
    mass = np.zeros((5, 5))
    mass[:2, :2] = np.eye(2)
    mass[:2, 2] = mass[2, :2] = arm
    mass[2, 2] = p.rho_J / (mu * size**2) + arm @ arm
    mass[3:, 3:] = p.rotary_inertia / (mu * size**2)
    return _Coupled(flexibility, mass, EI / (mu * size**4))


def _coupled_frequency(p: BeamProperties, length: float, order: int) -> float:
    """Frequency (Hz) number `order` of bending in both planes with torsion."""
    lower, upper = 0.0, np.pi / (2.0 * length) ** 2 * sqrt(max(p.EIy, p.EIz) / p.mu)
    while _coupled_count(p, length, upper) < order:
        lower, upper = upper, 1.5 * upper
    pieces = _coupled_pieces(p, length, upper)
    equations = _coupled(p, length / pieces)

    def eigenvalue(omega: float) -> float:
        return float(eigvalsh(_coupled_stiffness(equations, pieces, omega))[order - 1])

    root = scipy.optimize.brentq(eigenvalue, lower, upper, xtol=1e-300, rtol=_ROOT_TOLERANCE)
    return float(root) / (2.0 * pi)


def _coupled_count(p: BeamProperties, length: float, omega: float) -> int:
    """Number of frequencies below ω (rad/s)."""
    pieces = _coupled_pieces(p, length, omega)
    stiffness = _coupled_stiffness(_coupled(p, length / pieces), pieces, omega)
    return int(np.count_nonzero(eigvalsh(stiffness) < 0.0))


def _coupled_pieces(p: BeamProperties, length: float, omega: float) -> int:
    """Pieces that have their first frequency, clamped at both ends, above ω (rad/s).

    From below: |v_c|² ≤ 2|v_s|² + 2 r² φx² with r the distance of the shear centre parts bending
    and torsion, and the softer of both planes with the more inert one bounds bending.
    """
    bending = np.linalg.eigvalsh(p.bending)[0]
    matrices = p.shear_flexibility, p.rotary_inertia
    largest = (float(np.linalg.eigvalsh(matrix)[-1]) for matrix in matrices)
    plane = _Plane(float(bending), next(largest), 2.0 * p.mu, next(largest))
    polar = p.rho_J + 2.0 * p.mu * (p.centre_y**2 + p.centre_z**2)
    by_torsion = int(length * omega / (np.pi * sqrt(p.GJ / polar))) + 1
    return max(_pieces(plane, length, omega), by_torsion)


def _coupled_stiffness(equations: _Coupled, pieces: int, omega: float) -> Array:
    """K(ω) of the clamped–free beam on five motions of the cuts and the tip, in units of EI/l.

    `equations` are those of a piece.
    """
    state = np.zeros((10, 10))
    state[0, 3] = state[1, 4] = 1.0
    state[:5, 5:] = equations.flexibility
    state[5:, :5] = -(omega**2) / equations.unit_squared * equations.mass
    # M′ = −V − ω²ρIθ.
    state[8, 5] = state[9, 6] = -1.0
    transfer = expm(state)
    uu, uf, fu, ff = transfer[:5, :5], transfer[:5, 5:], transfer[5:, :5], transfer[5:, 5:]
    flexible = np.linalg.inv(uf)
    piece = np.block([[flexible @ uu, -flexible], [fu - ff @ flexible @ uu, ff @ flexible]])
    assembled = np.zeros((5 * pieces + 5, 5 * pieces + 5))
    for first in range(0, 5 * pieces, 5):
        assembled[first : first + 10, first : first + 10] += piece
    clamped = assembled[5:, 5:]
    return np.asarray(0.5 * (clamped + clamped.T))
