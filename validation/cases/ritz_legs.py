"""Legs as polynomials for Ritz's method: strain and kinetic energies, and twists of the ends.

Input: a beam, or the 6×6 compliance of a leg. Output: `RitzLeg`. Rule: displacements are sums of
Legendre polynomials along the leg, with energies by quadrature.
"""

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre

from lumped.arrays import Array
from lumped.beam_properties import BeamProperties

# Matrix that exchanges the two components of a vector.
_EXCHANGE = np.array([[0.0, 1.0], [1.0, 0.0]])


@dataclass(frozen=True, eq=False)
class RitzLeg:
    """Energies and end motions of a leg by its n polynomial coefficients (SI, leg axes).

    `stiffness` and `mass` (n×n): matrices of twice the strain and kinetic energies. `root` and
    `tip` (6×n): twists of the ends.
    """

    stiffness: Array
    mass: Array
    root: Array
    tip: Array

    @property
    def size(self) -> int:
        """Number of polynomial coefficients."""
        return len(self.stiffness)


def ritz_beam(beam: BeamProperties, length: float, degree: int) -> RitzLeg:
    """Prism with Legendre polynomials of a `degree` in stretch, shear strains and rotations.

    Deflections follow from shear strains and rotations. If deflections were unknowns, shear strains
    would be small differences between slopes and rotations, and bending would be lost in round-off
    with a large shear stiffness. Euler–Bernoulli beams have no shear strains. Shear strains, and
    the deflections that follow from them, are those of the shear centre, v − z_s φx and w + y_s φx;
    mass moves with the centroid.
    """
    points, weights = legendre.leggauss(degree + 2)
    weights = 0.5 * length * weights
    q, slopes = fields(beam, length, points, degree)
    shears = (
        slopes[1] - beam.centre_z * slopes[3] - q[5],
        slopes[2] + beam.centre_y * slopes[3] + q[4],
    )
    flexibilities = np.diag([1.0 / beam.GAy, 1.0 / beam.GAz]) + beam.shear_yz * _EXCHANGE
    shear = np.linalg.inv(flexibilities) if np.isfinite(beam.GAy) else np.zeros((2, 2))
    terms = [
        (beam.EA, slopes[0], slopes[0]),
        (beam.GJ, slopes[3], slopes[3]),
        (beam.EIy, slopes[4], slopes[4]),
        (beam.EIz, slopes[5], slopes[5]),
        (-beam.EIyz, slopes[4], slopes[5]),
        (-beam.EIyz, slopes[5], slopes[4]),
        *((shear[i, j], shears[i], shears[j]) for i in range(2) for j in range(2)),
    ]
    if beam.is_helical:
        strains = (slopes[0], *shears, *slopes[3:])
        terms = [
            (k, strains[i], strains[j]) for (i, j), k in np.ndenumerate(_helical_stiffness(beam))
        ]
    inertias = (beam.mu, beam.mu, beam.mu, beam.rho_J, beam.rho_Iy, beam.rho_Iz)
    products = [(m, f, f) for m, f in zip(inertias, q, strict=True)]
    # Coupling terms of the kinetic energy. A mass at (y, z) of the section moves by
    # u + z φy − y φz, v − z φx, w + y φx.
    couplings = [
        (-beam.rho_Iyz, 4, 5),
        (-beam.mu * beam.mass_z, 1, 3),
        (beam.mu * beam.mass_y, 2, 3),
    ]
    if beam.rho_Iy or beam.rho_Iz:
        couplings += [(beam.mu * beam.mass_z, 0, 4), (-beam.mu * beam.mass_y, 0, 5)]
    products += [(m, q[i], q[j]) for m, a, b in couplings for i, j in ((a, b), (b, a))]
    zeros = np.zeros((q.shape[2], q.shape[2]))
    ends, _ = fields(beam, length, np.array([-1.0, 1.0]), degree)
    return RitzLeg(
        stiffness=sum((k * (row.T * weights) @ column for k, row, column in terms), zeros),
        mass=sum((m * (row.T * weights) @ column for m, row, column in products), zeros),
        root=ends[:, 0],
        tip=ends[:, 1],
    )


def _helical_stiffness(beam: BeamProperties) -> Array:
    """Stiffness (6×6) of a section whose fibres couple stretch and twist, shear and bending.

    Rows and columns have the order of a twist. An infinite shear stiffness is replaced by zero,
    because the shear strain is then zero.
    """
    stiffness = np.zeros((6, 6))
    pairs = (
        ((0, 3), beam.EA, beam.GJ, beam.twist_x),
        ((1, 4), beam.GAy, beam.EIy, beam.turn_y),
        ((2, 5), beam.GAz, beam.EIz, beam.turn_z),
    )
    for (i, j), first, second, coupling in pairs:
        if np.isinf(first):
            stiffness[j, j] = second
            continue
        determinant = 1.0 / (first * second) - coupling**2
        stiffness[i, i], stiffness[j, j] = 1.0 / (second * determinant), 1.0 / (first * determinant)
        stiffness[i, j] = stiffness[j, i] = -coupling / determinant
    return stiffness


def fields(beam: BeamProperties, length: float, points: Array, degree: int) -> tuple[Array, Array]:
    """Twist of the centreline and its derivative along x for unit coefficients (6×p×n each).

    `points` (p): from −1 at the root to 1 at the tip. The n coefficients are, in this order: those
    of the polynomials of u, φx, φy and φz; the deflection v at the root and the coefficients of the
    shear strain γy; the deflection w at the root and the coefficients of γz. Shapes: p points.
    """
    unit = np.eye(degree + 1)
    values = legendre.legvander(points, degree)
    slopes = legendre.legval(points, legendre.legder(unit)).T * 2.0 / length
    integrals = legendre.legval(points, legendre.legint(unit, lbnd=-1.0)).T * 0.5 * length
    count = degree + 1
    shear_counts = [1 + count * bool(np.isfinite(k)) for k in (beam.GAy, beam.GAz)]
    firsts = (4 * count, 4 * count + shear_counts[0])
    total = firsts[1] + shear_counts[1]
    q, slope_fields = np.zeros((6, len(points), total)), np.zeros((6, len(points), total))
    for block, component in enumerate((0, 3, 4, 5)):
        columns = slice(block * count, (block + 1) * count)
        q[component, :, columns], slope_fields[component, :, columns] = values, slopes
    # v' = γy + φz, w' = γz − φy.
    for component, first, sign, rotation in ((1, firsts[0], 1.0, 3), (2, firsts[1], -1.0, 2)):
        columns, rotation_columns = (
            slice(first + 1, first + count + 1),
            slice(rotation * count, (rotation + 1) * count),
        )
        q[component, :, first] = 1.0
        q[component, :, rotation_columns] = sign * integrals
        slope_fields[component, :, rotation_columns] = sign * values
        if shear_counts[component - 1] > 1:
            q[component, :, columns], slope_fields[component, :, columns] = integrals, values
    for field in (q, slope_fields):
        field[1] += beam.centre_z * field[3]
        field[2] -= beam.centre_y * field[3]
    return q, slope_fields


def ritz_compliance_leg(compliance: Array, length: float) -> RitzLeg:
    """Massless leg with a 6×6 tip compliance. Its 12 coefficients are the twists of its ends."""
    root, tip = np.vsplit(np.eye(12), 2)
    deformation = tip - point_transfer(np.array([length, 0.0, 0.0])) @ root
    stiffness = np.asarray(deformation.T @ np.linalg.solve(compliance, deformation))
    return RitzLeg(0.5 * (stiffness + stiffness.T), np.zeros((12, 12)), root, tip)


def ritz_rigid_leg(length: float) -> RitzLeg:
    """Rigid leg without mass. Its 6 coefficients are the twist of its root."""
    tip = point_transfer(np.array([length, 0.0, 0.0]))
    return RitzLeg(np.zeros((6, 6)), np.zeros((6, 6)), np.eye(6), tip)


def point_transfer(offset: Array) -> Array:
    """Transfer (6×6) of a twist to a point `offset` (3, m) away on the same body: u + φ × r."""
    x, y, z = offset
    transfer = np.eye(6)
    transfer[:3, 3:] = [[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]]
    return transfer
