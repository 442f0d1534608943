"""A leg by polynomials, by its 6×6 or rigid: its energies on coefficients, twists of its ends.

Neither elements nor springs between segments, and no algebra of the other models.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre
from scipy.linalg import null_space

from lumped.arrays import Array
from lumped.legs import BeamProperties

# Statics of Timoshenko beams are cubic; modes converge geometrically.
STATIC_DEGREE = 3
_FIELDS = 6  # u, v, w, φx, φy, φz of a leg, leg axes


@dataclass(frozen=True, eq=False)
class RitzLeg:
    """A leg on n coefficients, SI, leg axes.

    Twice its energies, `stiffness` and `mass` (n×n); twists of its `root` and `tip` (6×n); rows of
    `shut` (c×n) must vanish: the shear strains that Euler and Bernoulli leave out.
    """

    stiffness: Array
    mass: Array
    root: Array
    tip: Array
    shut: Array

    @property
    def size(self) -> int:
        """How many coefficients there are."""
        return len(self.stiffness)


def of_beam(beam: BeamProperties, length: float, degree: int) -> RitzLeg:
    """Legendre polynomials of `degree` in each of displacements and rotations of a prism."""
    weights, values, slopes = sampled(length, degree)
    size = _FIELDS * (degree + 1)

    def field(number: int, of: Array) -> Array:
        return placed(of, number * (degree + 1), size)

    u, v, w, about_x, about_y, about_z = range(_FIELDS)
    strains = (
        (beam.EA, field(u, slopes)),
        (beam.GJ, field(about_x, slopes)),
        (beam.EIy, field(about_y, slopes)),
        (beam.EIz, field(about_z, slopes)),
        (beam.GAy, field(v, slopes) - field(about_z, values)),
        (beam.GAz, field(w, slopes) + field(about_y, values)),
    )
    inertias = (beam.mu, beam.mu, beam.mu, beam.rho_J, beam.rho_Iy, beam.rho_Iz)
    motions = (field(number, values) for number in range(_FIELDS))
    ends = (legendre.legvander(np.array([end]), degree) for end in (-1.0, 1.0))
    root, tip = (np.asarray(np.kron(np.eye(_FIELDS), end), dtype=np.float64) for end in ends)
    return RitzLeg(
        stiffness=_sum([k * (e.T * weights) @ e for k, e in strains if np.isfinite(k)], size),
        mass=_sum([m * (f.T * weights) @ f for m, f in zip(inertias, motions, strict=True)], size),
        root=root,
        tip=tip,
        shut=np.vstack([np.zeros((0, size)), *(e for k, e in strains if not np.isfinite(k))]),
    )


def sampled(length: float, degree: int) -> tuple[Array, Array, Array]:
    """Weights (p) of Gauss's points along a leg, polynomials there and their slopes (p×n)."""
    points, weights = legendre.leggauss(degree + 1)
    values = legendre.legvander(points, degree)
    of_unit = legendre.legval(points, legendre.legder(np.eye(degree + 1))).T
    return 0.5 * length * weights, np.asarray(values), np.asarray(of_unit * 2.0 / length)


def of_compliance(compliance: Array, length: float) -> RitzLeg:
    """A leg known by its 6×6 at the tip, root clamped; massless, on the twists of its ends."""
    root, tip = np.vsplit(np.eye(12), 2)
    bent = tip - carried(np.array([length, 0.0, 0.0])) @ root
    stiffness = np.asarray(bent.T @ np.linalg.solve(compliance, bent))
    return RitzLeg(
        0.5 * (stiffness + stiffness.T), np.zeros((12, 12)), root, tip, np.zeros((0, 12))
    )


def between_ends(prism: RitzLeg) -> Array:
    """Coefficients (n×12) of the shape that a prism takes when its ends, root first, are moved."""
    ends = np.vstack([prism.root, prism.tip])
    free, moved = null_space(ends), np.linalg.pinv(ends)
    left = np.linalg.solve(free.T @ prism.stiffness @ free, free.T @ prism.stiffness @ moved)
    return np.asarray(moved - free @ left)


def field_at(length: float, station: float, degree: int) -> Array:
    """Twist (6×n, leg axes) of the centreline at `station` (m) on the coefficients of `of_beam`."""
    place = np.array([2.0 * station / length - 1.0])
    return np.asarray(np.kron(np.eye(_FIELDS), legendre.legvander(place, degree)), dtype=np.float64)


def rigid(length: float) -> RitzLeg:
    """A rigid leg without mass, on the twist of its root."""
    tip = carried(np.array([length, 0.0, 0.0]))
    return RitzLeg(np.zeros((6, 6)), np.zeros((6, 6)), np.eye(6), tip, np.zeros((0, 6)))


def placed(block: Array, first: int, total: int) -> Array:
    """The columns of `block` from number `first` on among `total`, zeros elsewhere."""
    wide = np.zeros((len(block), total))
    wide[:, first : first + block.shape[1]] = block
    return wide


def carried(offset: Array) -> Array:
    """Twist (6×6) at a point `offset` (3, m) away on the same body: u + φ × r."""
    x, y, z = offset
    moved = np.eye(6)
    moved[:3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return moved


def free_motions(stiffness: Array, conditions: Array) -> Array:
    """Basis (n×k) of what `conditions` (c×n), which must vanish, leave free of n unknowns.

    Each unknown is measured by its own stiffness (n×n), each condition has unit size: in rounding
    torsion of a thin wall would be lost beside what holds the wall along, a small lever taken for
    none.
    """
    own = np.diag(stiffness)
    # What has none of its own, rigid motions, is measured by the softest.
    softest = np.min(own[own > 0.0], initial=np.max(own) or 1.0)
    units = 1.0 / np.sqrt(np.where(own > 0.0, own, softest))
    measured = conditions * units
    free = null_space(measured / np.linalg.norm(measured, axis=1, keepdims=True))
    return np.asarray(units[:, None] * free)


def _sum(parts: list[Array], size: int) -> Array:
    return np.asarray(sum(parts, start=np.zeros((size, size))))
