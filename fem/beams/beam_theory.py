"""Natural frequencies of a prismatic cantilever by beam theory, as reference values.

Tension, torsion and Euler–Bernoulli bending have explicit solutions. Timoshenko bending (and its
limit with rotary inertia only, Rayleigh) has the transcendental equation of Huang, J. Appl. Mech.
28 (1961) 579. Its roots are found here from the exact dynamic stiffness K(ω) of the beam divided
into pieces. This matrix is singular at the same frequencies, but requires no case distinction at
the cut-off of the second spectrum and does not overflow as hyperbolic functions do. The pieces are
so short that the first frequency of each, with both its ends clamped, is above ω. Then the k-th
smallest eigenvalue of K decreases monotonically with ω and is zero only at the k-th natural
frequency (Wittrick & Williams, Q. J. Mech. Appl. Math. 24 (1971) 263). No root can be missed.

In sections without two axes of symmetry, bending in both planes is coupled, or bending is coupled
with torsion (`BeamProperties`). Deformations that are coupled vibrate together and form one kind,
such as "torsion with bending y". For such a kind the same method is used with all its deflections
and rotations.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from heapq import merge
from itertools import count as naturals
from itertools import islice
from math import pi, sqrt
from typing import Literal, TypeAlias

import numpy as np
import scipy
from scipy.linalg import eigvalsh, expm
from scipy.sparse.csgraph import connected_components

from lumped.arrays import Array
from lumped.beam_properties import BeamProperties
from lumped.errors import ComputationError
from lumped.memo import memo

Plane: TypeAlias = Literal["y", "z"]
# Deformations that vibrate together: names of `_DEFORMATIONS` in their order, joined by `TOGETHER`.
Kind: TypeAlias = str

TOGETHER = " with "
# Names of the deformations, with their indices among the displacements of `_Coupled`.
_DEFORMATIONS: dict[str, tuple[int, ...]] = {
    "tension": (5,),
    "torsion": (2,),
    "bending z": (0, 3),
    "bending y": (1, 4),
}

# Relative tolerance of roots. brentq does not accept a smaller one.
_ROOT_TOLERANCE = 4.0 * np.finfo(float).eps
# Factor on the upper end of the bracket of a root, because the upper bound may be the root itself.
_ROOM = 1.0 + 1e-6


@dataclass(frozen=True)
class CantileverFrequency:
    """Natural `frequency` (Hz) of a cantilever.

    It is number `order` (1, 2, …) among the frequencies of one `kind` of deformation.
    """

    frequency: float
    kind: Kind
    order: int


@dataclass(frozen=True)
class _Plane:
    """Bending data of one plane: EI (N m²), 1/κGA (1/N), μ (kg/m), ρI (kg m)."""

    EI: float
    shear_flexibility: float
    mu: float
    rho_I: float


@memo(64)
def cantilever_frequencies(
    properties: BeamProperties, length: float, count: int
) -> tuple[CantileverFrequency, ...]:
    """The lowest `count` natural frequencies of the clamped–free leg of `length` (m), ascending."""
    # The frequencies are computed one by one: of each kind, at most one that is not returned.
    kinds = (_ascending(properties, length, kind) for kind in kinds_of(properties))
    return tuple(islice(merge(*kinds, key=lambda item: item.frequency), count))


def kinds_of(properties: BeamProperties) -> tuple[Kind, ...]:
    """Kinds of deformation that vibrate independently of each other, such as "tension".

    Two deformations vibrate together if the flexibility or the mass of the section couples them,
    or if each of them vibrates together with a third one.
    """
    section = _coupled(properties, 1.0)
    coupling = (section.flexibility != 0.0) | (section.mass != 0.0)
    blocks = [
        [coupling[np.ix_(rows, columns)].any() for columns in _DEFORMATIONS.values()]
        for rows in _DEFORMATIONS.values()
    ]
    count, labels = connected_components(np.array(blocks), directed=False)
    names = np.array(list(_DEFORMATIONS))
    return tuple(TOGETHER.join(names[labels == label]) for label in range(count))


def _ascending(
    properties: BeamProperties, length: float, kind: Kind
) -> Iterator[CantileverFrequency]:
    """Yield all natural frequencies of one `kind` of deformation, ascending. `length` is in m."""
    for order in naturals(1):
        frequency = frequency_of_kind(properties, length, kind, order)
        yield CantileverFrequency(frequency, kind, order)


def frequency_of_kind(properties: BeamProperties, length: float, kind: Kind, order: int) -> float:
    """Natural frequency (Hz) number `order` (from 1) of one `kind` of deformation.

    `length` is in m. Raises ComputationError if κGA is negative.
    """
    match kind:
        case "tension":
            return _quarter_waves(properties.EA / properties.mu, length, order)
        case "torsion":
            return _quarter_waves(properties.GJ / properties.rho_J, length, order)
        case "bending y":
            return _bending_frequency(_plane(properties, "y"), length, order)
        case "bending z":
            return _bending_frequency(_plane(properties, "z"), length, order)
        case _:
            return _coupled_frequency(properties, length, kind, order)


def tension_frequencies(properties: BeamProperties, length: float, count: int) -> Array:
    """Frequencies (Hz) of longitudinal vibration, (2k − 1)/4L √(EA/μ) for k = 1 … `count`.

    `length` is L in m.
    """
    return _of_kind(properties, length, "tension", count)


def torsion_frequencies(properties: BeamProperties, length: float, count: int) -> Array:
    """Frequencies (Hz) of torsion, (2k − 1)/4L √(GJ/ρJ) for k = 1 … `count`, with free warping.

    `length` is L in m.
    """
    return _of_kind(properties, length, "torsion", count)


def bending_frequencies(
    properties: BeamProperties, length: float, plane: Plane, count: int
) -> Array:
    """Frequencies (Hz) of bending in one plane, for k = 1 … `count`. `length` is in m.

    `plane` "y" is bending about y (EIy, deflection along z), "z" is bending about z (EIz,
    deflection along y). The theory is that of Euler and Bernoulli if κGA is infinite and ρI zero,
    Rayleigh's if only κGA is infinite, otherwise Timoshenko's with both spectra. Raises
    ComputationError if κGA is negative.
    """
    return _of_kind(properties, length, "bending y" if plane == "y" else "bending z", count)


def _of_kind(properties: BeamProperties, length: float, kind: Kind, count: int) -> Array:
    orders = range(1, count + 1)
    return np.array([frequency_of_kind(properties, length, kind, order) for order in orders])


def _plane(p: BeamProperties, plane: Plane) -> _Plane:
    """Bending data of one plane. Raises ComputationError if κGA is negative."""
    if plane == "y":
        beam = _Plane(p.EIy, 1.0 / p.GAz, p.mu, p.rho_Iy)
    else:
        beam = _Plane(p.EIz, 1.0 / p.GAy, p.mu, p.rho_Iz)
    if beam.shear_flexibility < 0.0:
        # Thin-walled formulas give a negative κ for ν far below zero. Such a beam does not exist.
        raise ComputationError(
            f"bending {plane}: the shear stiffness κGA = {1.0 / beam.shear_flexibility:.3g} N is "
            "negative; the formula of κ does not hold for this section and ν"
        )
    return beam


def _bending_frequency(beam: _Plane, length: float, order: int) -> float:
    """Natural frequency (Hz) number `order` (from 1) of bending in one plane. `length` is in m."""
    root = _euler_bernoulli_root(order)
    explicit = root**2 * sqrt(beam.EI / beam.mu) / length**2
    if beam.shear_flexibility == 0.0 and beam.rho_I == 0.0:
        return explicit / (2.0 * pi)
    bound = _upper_bound(beam, length, order, explicit)
    return _root(beam, length, order - 1, bound) / (2.0 * pi)


def euler_bernoulli_roots(count: int) -> Array:
    """The first `count` roots βL of cos x cosh x = −1: 1.875104, 4.694091, 7.854757 and so on."""
    return np.array([_euler_bernoulli_root(order) for order in range(1, count + 1)])


@memo(64)
def _euler_bernoulli_root(order: int) -> float:
    def bounded(x: float) -> float:
        # cos x + 1/cosh x, which does not overflow, unlike cosh x.
        return float(np.cos(x) + 2.0 * np.exp(-x) / (1.0 + np.exp(-2.0 * x)))

    # The function changes its sign once between consecutive multiples of π: there cos x is ±1 and
    # 1/cosh x is below 1.
    bracket = (order - 1) * pi, order * pi
    return float(scipy.optimize.brentq(bounded, *bracket, xtol=1e-15, rtol=_ROOT_TOLERANCE))


def _quarter_waves(speed_squared: float, length: float, order: int) -> float:
    return (2.0 * order - 1.0) * sqrt(speed_squared) / (4.0 * length)


def _upper_bound(beam: _Plane, length: float, order: int, euler_bernoulli: float) -> float:
    """Upper bound of the angular frequency ω (rad/s) of mode `order`, by the minimax principle.

    It is the smallest of the frequencies number `order` of three stiffer or lighter beams: without
    shear strain and rotary inertia (Euler–Bernoulli, `euler_bernoulli`), without rotation of the
    sections (shear beam), and without shear strain and inertia of the deflection (EI and ρI only).
    """
    bound = euler_bernoulli
    odd = 0.5 * pi * (2.0 * order - 1.0) / length
    if beam.shear_flexibility > 0.0:
        bound = min(bound, odd / sqrt(beam.shear_flexibility * beam.mu))
    if beam.rho_I > 0.0:
        bound = min(bound, odd * sqrt(beam.EI / beam.rho_I))
    return bound


def _root(beam: _Plane, length: float, index: int, bound: float) -> float:
    """Angular frequency ω (rad/s) number `index` (from 0) of a cantilever in bending.

    The root lies below `bound` (rad/s). `length` (m) is that of the cantilever.
    """
    pieces = _pieces(beam, length, _ROOM * bound)

    def eigenvalue(omega: float) -> float:
        return float(eigvalsh(_dynamic_stiffness(beam, length, pieces, omega))[index])

    return float(
        scipy.optimize.brentq(eigenvalue, 0.0, _ROOM * bound, xtol=1e-300, rtol=_ROOT_TOLERANCE)
    )


def _pieces(beam: _Plane, length: float, omega: float) -> int:
    """Smallest number of equal pieces with a first clamped–clamped frequency above `omega` (rad/s).

    A lower bound of that frequency is used. With ‖w‖ ≤ (l/π)‖w′‖, ‖θ‖ ≤ (l/π)‖θ′‖ and w′ = θ + γ
    for a piece of length l, Rayleigh's quotient gives 1/ω² ≤ p² μ/EI + p (μ/κGA + ρI/EI) with p =
    (l/π)². The inequality is solved for p.
    """
    a = beam.mu / beam.EI
    b = beam.mu * beam.shear_flexibility + beam.rho_I / beam.EI
    p = 2.0 / omega**2 / (b + np.sqrt(b**2 + 4.0 * a / omega**2))
    return int(length / (np.pi * np.sqrt(p))) + 1


def _dynamic_stiffness(beam: _Plane, length: float, pieces: int, omega: float) -> Array:
    """Dynamic stiffness K(ω) of the clamped–free beam, in units of EI/l.

    The beam is divided into `pieces` of length l. `omega` is ω in rad/s. The unknowns are (w/l, θ)
    at the ends of the pieces, except at the root.
    """
    return _clamped_chain(_piece_stiffness(beam, length / pieces, omega), pieces)


def _clamped_chain(piece: Array, pieces: int) -> Array:
    """Stiffness matrix of a chain of equal pieces that is clamped at its start.

    `piece` (2n×2n) is the stiffness matrix of one piece. Its unknowns are n motions of its start,
    then n motions of its end. Those of the chain are the motions of the ends of all pieces.
    """
    n = len(piece) // 2
    assembled = np.zeros((n * (pieces + 1), n * (pieces + 1)))
    for first in range(0, n * pieces, n):
        assembled[first : first + 2 * n, first : first + 2 * n] += piece
    return assembled[n:, n:]


def _piece_stiffness(beam: _Plane, l: float, omega: float) -> Array:
    """Exact dynamic stiffness K(ω) (4×4, units of EI/l) of a piece of length l.

    The unknowns are (w/l, θ) at both ends. `omega` is ω in rad/s. K follows from the matrix
    exponential for the state (w, θ, V, M) with w′ = θ + V/κGA, θ′ = M/EI, V′ = −ω²μ w, M′ = −V −
    ω²ρI θ.
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
    """State equations of bending in both planes with torsion and tension, dimensionless.

    The 6 displacements are v_s and w_s of the shear centre, the twist φx, the rotations θ of the
    section in bending along y and along z, and u. The 6 forces are work conjugate to these
    displacements. `flexibility` (6×6) gives the strains for the forces, `mass` (6×6) the inertia
    forces per length for the displacements. `unit_squared` (rad²/s²) is the unit of ω².
    """

    flexibility: Array
    mass: Array
    unit_squared: float


def _coupled(p: BeamProperties, size: float) -> _Coupled:
    """Dimensionless state equations of bending in both planes with torsion and tension.

    The unit of length is `size` (m), and the unit of ω² is EI/(μ `size`⁴) with the larger EI of
    both planes.
    """
    EI, mu = max(p.EIy, p.EIz), p.mu
    flexibility = np.zeros((6, 6))
    flexibility[:2, :2] = p.shear_flexibility * EI / size**2
    flexibility[2, 2] = EI / p.GJ
    flexibility[3:5, 3:5] = EI * np.linalg.inv(p.bending)
    # The displacements of the centre of mass are v_s + (z_s − z_m) φx and w_s − (y_s − y_m) φx.
    arm = np.array([p.centre_z - p.mass_z, p.mass_y - p.centre_y]) / size
    mass = np.zeros((6, 6))
    mass[:2, :2] = np.eye(2)
    mass[:2, 2] = mass[2, :2] = arm
    own_polar = p.rho_J - mu * (p.mass_y**2 + p.mass_z**2)
    mass[2, 2] = own_polar / (mu * size**2) + arm @ arm
    mass[3:5, 3:5] = p.rotary_inertia / (mu * size**2)
    flexibility[5, 5] = EI / (p.EA * size**2)
    flexibility[2, 5] = flexibility[5, 2] = p.twist_x * EI / size
    # θ of the deflection along y is φz, that of the deflection along z is −φy.
    flexibility[0, 4] = flexibility[4, 0] = -p.turn_y * EI / size
    flexibility[1, 3] = flexibility[3, 1] = p.turn_z * EI / size
    mass[5, 5] = 1.0
    # u + z_m φy − y_m φz; φy turns against θ of the deflection along z.
    mass[3, 5] = mass[5, 3] = p.section_mass[0, 5] / (mu * size)
    mass[4, 5] = mass[5, 4] = -p.section_mass[0, 4] / (mu * size)
    return _Coupled(flexibility, mass, EI / (mu * size**4))


def _coupled_frequency(p: BeamProperties, length: float, kind: Kind, order: int) -> float:
    """Natural frequency (Hz) number `order` (from 1) of coupled deformations. `length` is in m."""
    lower, upper = 0.0, np.pi / (2.0 * length) ** 2 * sqrt(max(p.EIy, p.EIz) / p.mu)
    while _coupled_count(p, length, kind, upper) < order:
        lower, upper = upper, 1.5 * upper
    pieces = _coupled_pieces(p, length, upper)
    equations = _coupled(p, length / pieces)

    def eigenvalue(omega: float) -> float:
        return float(eigvalsh(_coupled_stiffness(equations, pieces, kind, omega))[order - 1])

    root = scipy.optimize.brentq(eigenvalue, lower, upper, xtol=1e-300, rtol=_ROOT_TOLERANCE)
    return float(root) / (2.0 * pi)


def _coupled_count(p: BeamProperties, length: float, kind: Kind, omega: float) -> int:
    """Number of natural frequencies of one `kind` below `omega` (rad/s) of a cantilever."""
    pieces = _coupled_pieces(p, length, omega)
    stiffness = _coupled_stiffness(_coupled(p, length / pieces), pieces, kind, omega)
    return int(np.count_nonzero(eigvalsh(stiffness) < 0.0))


def _coupled_pieces(p: BeamProperties, length: float, omega: float) -> int:
    """Number of equal pieces with a first clamped–clamped frequency above `omega` (rad/s).

    A lower bound of that frequency is used, for which bending, torsion and tension are separated.
    Bending is separated from torsion by |v_m|² ≤ 2|v_s|² + 2 r² φx², with the displacements v_m of
    the centre of mass and v_s of the shear centre, and the distance r between them. Tension is
    separated in the same way. Bending is bounded with the smaller stiffness and the larger inertia
    of both planes. Two coupled strains have at most twice the flexibility that they have without
    coupling.
    """
    if p.is_helical:
        doubled = {
            name: 0.5 * getattr(p, name) for name in ("EA", "EIy", "EIz", "GJ", "GAy", "GAz")
        }
        p = replace(p, **doubled, twist_x=0.0, turn_y=0.0, turn_z=0.0)
    bending = np.linalg.eigvalsh(p.bending)[0]
    eccentric = p.mu * (p.mass_y**2 + p.mass_z**2)
    shear, rotary = (
        float(np.linalg.eigvalsh(matrix)[-1]) for matrix in (p.shear_flexibility, p.rotary_inertia)
    )
    plane = _Plane(float(bending), shear, 2.0 * p.mu, rotary + eccentric)
    squared = (p.mass_y - p.centre_y) ** 2 + (p.mass_z - p.centre_z) ** 2
    polar = p.rho_J - eccentric + 2.0 * p.mu * squared
    speeds = [sqrt(p.GJ / polar), sqrt(p.EA / (2.0 * p.mu))]
    by_waves = int(length * omega / (np.pi * min(speeds))) + 1
    return max(_pieces(plane, length, omega), by_waves)


def _coupled_stiffness(equations: _Coupled, pieces: int, kind: Kind, omega: float) -> Array:
    """Dynamic stiffness K(ω) of the clamped–free beam for one `kind` of coupled deformations.

    The unknowns are the n dimensionless displacements of `_Coupled` that belong to `kind`, at the
    ends of all pieces except the root. `equations` are those of one piece of length l, `pieces` is
    the number of pieces. The unit of K is EI/l, with the larger EI of both planes.
    """
    state = np.zeros((12, 12))
    state[0, 3] = state[1, 4] = 1.0
    state[:6, 6:] = equations.flexibility
    state[6:, :6] = -(omega**2) / equations.unit_squared * equations.mass
    # Shear force in the moment equation M′ = −V − ω²ρI θ.
    state[9, 6] = state[10, 7] = -1.0
    names = kind.split(TOGETHER)
    displacements = np.concatenate([_DEFORMATIONS[name] for name in names])
    n = len(displacements)
    rows = np.concatenate([displacements, displacements + 6])
    transfer = expm(state[np.ix_(rows, rows)])
    uu, uf, fu, ff = transfer[:n, :n], transfer[:n, n:], transfer[n:, :n], transfer[n:, n:]
    flexible = np.linalg.inv(uf)
    piece = np.block([[flexible @ uu, -flexible], [fu - ff @ flexible @ uu, ff @ flexible]])
    clamped = _clamped_chain(piece, pieces)
    return np.asarray(0.5 * (clamped + clamped.T))
