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


@dataclass(frozen=True, eq=False)
class RitzLeg:
    """A leg on n coefficients, SI, leg axes.

    Twice its energies, `stiffness` and `mass` (n×n); twists of its `root` and `tip` (6×n).
    """

    stiffness: Array
    mass: Array
    root: Array
    tip: Array

    @property
    def size(self) -> int:
        """How many coefficients there are."""
        return len(self.stiffness)


def of_beam(beam: BeamProperties, length: float, degree: int) -> RitzLeg:
    """Legendre polynomials of `degree` in stretch, shear strains and rotations of a prism.

    Deflections follow from the shear strains and rotations: were they unknowns, strains would be
    their differences, and bending lost beside what a material hardly shears. Euler and Bernoulli
    have no shear strains.
    """
    points, weights = legendre.leggauss(degree + 2)
    weights = 0.5 * length * weights
    q, slopes = fields(beam, length, points, degree)
    shears = slopes[1] - q[5], slopes[2] + q[4]
    strains = (
        (beam.EA, slopes[0]),
        (beam.GJ, slopes[3]),
        (beam.EIy, slopes[4]),
        (beam.EIz, slopes[5]),
        *((k, e) for k, e in zip((beam.GAy, beam.GAz), shears, strict=True) if np.isfinite(k)),
    )
    size = q.shape[2]
    ends, _ = fields(beam, length, np.array([-1.0, 1.0]), degree)
    return RitzLeg(
        stiffness=_sum([k * (e.T * weights) @ e for k, e in strains], size),
        mass=_sum([m * (f.T * weights) @ f for m, f in zip(inertias(beam), q, strict=True)], size),
        root=ends[:, 0],
        tip=ends[:, 1],
    )


def inertias(beam: BeamProperties) -> tuple[float, ...]:
    """Mass (kg/m) and rotary inertia (kg m) per length against each component of a twist."""
    return (beam.mu, beam.mu, beam.mu, beam.rho_J, beam.rho_Iy, beam.rho_Iz)


def fields(beam: BeamProperties, length: float, at: Array, degree: int) -> tuple[Array, Array]:
    """Twist of the centreline and its slope (6×p×n) on the coefficients of `of_beam`.

    `at` p points, the root at −1, the tip at 1. Coefficients are those of u, φx, φy, φz, then of
    the root's v with γy, of its w with γz.
    """
    unit = np.eye(degree + 1)
    values = legendre.legvander(at, degree)
    slopes = legendre.legval(at, legendre.legder(unit)).T * 2.0 / length
    integrals = legendre.legval(at, legendre.legint(unit, lbnd=-1.0)).T * 0.5 * length
    count = degree + 1
    sheared = [1 + count * bool(np.isfinite(k)) for k in (beam.GAy, beam.GAz)]
    firsts = (4 * count, 4 * count + sheared[0])
    total = firsts[1] + sheared[1]
    q, moving = np.zeros((6, len(at), total)), np.zeros((6, len(at), total))
    for block, component in enumerate((0, 3, 4, 5)):
        own = slice(block * count, (block + 1) * count)
        q[component, :, own], moving[component, :, own] = values, slopes
    # v' = γy + φz, w' = γz − φy.
    for component, first, sign, about in ((1, firsts[0], 1.0, 3), (2, firsts[1], -1.0, 2)):
        own, turning = (
            slice(first + 1, first + count + 1),
            slice(about * count, (about + 1) * count),
        )
        q[component, :, first] = 1.0
        q[component, :, turning], moving[component, :, turning] = sign * integrals, sign * values
        if sheared[component - 1] > 1:
            q[component, :, own], moving[component, :, own] = integrals, values
    return q, moving


def of_compliance(compliance: Array, length: float) -> RitzLeg:
    """A leg known by its 6×6 at the tip, root clamped; massless, on the twists of its ends."""
    root, tip = np.vsplit(np.eye(12), 2)
    bent = tip - carried(np.array([length, 0.0, 0.0])) @ root
    stiffness = np.asarray(bent.T @ np.linalg.solve(compliance, bent))
    return RitzLeg(0.5 * (stiffness + stiffness.T), np.zeros((12, 12)), root, tip)


def rigid(length: float) -> RitzLeg:
    """A rigid leg without mass, on the twist of its root."""
    tip = carried(np.array([length, 0.0, 0.0]))
    return RitzLeg(np.zeros((6, 6)), np.zeros((6, 6)), np.eye(6), tip)


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
