"""Additional flexibility of tapered sections due to inclined fibres, to second order in the slope.

In a taper, fibres converge: the fibre at (y, z) has the slope s = (λy y, λz z) against the centre
line. Here λ = d ln a/dx is the rate of the lever arm a = I/S in bending about z for λy, and about y
for λz, with the second moment of area I and the first moment S of half the section. The forces that
shear the section are Qy + λy Mz and Qz − λz My (see `lumped.line_sections`).

In bending about y, let M be the moment and Q the second of these forces, σ = (M/I) z the normal
stress due to M, and τ the shear stress due to Q. The complementary energy per length is

    (1/2E) ∫ σ² dA + (1/2G) ∫ |s σ + τ|² dA − (ν/E) ∫ σ (σyy + σzz) dA.

The last term contains the transverse normal stresses that equilibrium requires. Only their moment
about y is needed. It follows from the total shear stress t = s σ + τ, if the equations of
equilibrium are multiplied by polynomials and integrated over the section:

    ∫ (σyy + σzz) z dA = dK/dx,   K = ∫ (yz ty + ½ (z² − y²) tz) dA = k Q + m M.

This moment is zero in a prism. With P = I ∫ yz τy dA for a unit force Q, and with the fourth
moments Z = ∫ z⁴ dA and X = ∫ y²z² dA,

    k = (2P + Z/6 − X/2)/I,   m = ((λy − λz/2) X + λz Z/2)/I.

The terms of the energy in M Q couple moment and shear force, and those in M² add to the flexibility
in bending. Terms in ν cancel for cones and pyramids, which shrink in all directions alike. Terms in
P cancel for wedges. For bending about z, y and z are exchanged.
"""

from collections.abc import Sequence

import numpy as np
from numpy.polynomial import chebyshev

from lumped.arrays import Array
from lumped.sections import Section, flexure_moments, symmetric_moments

# Fractions of a span at which sections are evaluated: 12, exact for polynomials of degree 11.
NODES: Array = np.asarray(0.5 * (1.0 + chebyshev.chebpts1(12)))
# Names of the columns of `taper_flexibilities`: rates λy and λz (1/m); increases of the flexibility
# in tension and in bending about y and z, relative to 1/EA, 1/EIy and 1/EIz; curvature about z due
# to a force Qy, and about y due to Qz (1/(N m)).
TAPER = ("rate_y", "rate_z", "softer", "softer_y", "softer_z", "cross_y", "cross_z")


def taper_rates(sections: Sequence[Section], length: float, shares: Array) -> Array:
    """Rates d ln a/dx (p×2, 1/m) of the lever arms a = I/S at p fractions `shares` of a span.

    The columns are for bending about z and about y. I is the second moment of area, S the first
    moment of area of half the section. `length` (m) is the length of the span. `sections` are its
    sections at the fractions `NODES`. Their shape must have two axes of symmetry.
    """
    arms = np.array([_lever_arms(section) for section in sections])
    fitted = chebyshev.chebfit(2.0 * NODES - 1.0, np.log(arms), len(NODES) - 1)
    slopes = chebyshev.chebval(2.0 * shares - 1.0, chebyshev.chebder(fitted)).T
    return np.asarray(slopes * 2.0 / length)


def taper_flexibilities(
    sections: Sequence[Section], length: float, moduli: tuple[float, float, float]
) -> Array:
    """Taper rates, and flexibility due to inclined fibres (p×7), at the p `NODES` of a span.

    The columns are named in `TAPER`. `length` (m) is the length of the span. `sections` are its
    sections at the fractions `NODES`. Their shape must have two axes of symmetry. `moduli` are E
    and G (Pa) and ν.
    """
    E, G, nu = moduli
    rates = taper_rates(sections, length, NODES)
    moments = np.array([symmetric_moments(section) for section in sections])
    flexures = np.array([flexure_moments(section, nu * G / E) for section in sections])
    seconds = np.array([[s.second_moment_z, s.second_moment_y] for s in sections])
    areas = np.array([section.area for section in sections])
    columns = [*rates.T, 2.0 * (rates**2 * seconds).sum(axis=1) / areas]
    softer, cross = [], []
    for axis, other in ((0, 1), (1, 0)):
        inertia, flexure = seconds[:, axis], flexures[:, axis]
        fourth, mixed = moments[:, 2 + axis], moments[:, 4]
        rate, across = rates[:, axis], rates[:, other]
        of_force = (2.0 * flexure + fourth / 6.0 - mixed / 2.0) / inertia
        of_moment = ((across - rate / 2.0) * mixed + rate * fourth / 2.0) / inertia
        # Coefficients of Q and M in K′, with Q′ = −λ′M − λ(Q + λM) for the force that shears.
        force_slope = _slope(of_force, length) - rate * of_force + of_moment
        moment_slope = _slope(of_moment, length) + rate * of_moment
        moment_slope -= of_force * (_slope(rate, length) + rate**2)
        inclined = rate**2 * fourth + across**2 * mixed
        softer.append(E / G * inclined / inertia - 2.0 * nu * moment_slope)
        sheared = (rate * fourth / 3.0 + across * flexure) / inertia
        cross.append((sheared / G - nu / E * force_slope) / inertia)
    return np.column_stack([*columns, softer[1], softer[0], *cross])


def _slope(values: Array, length: float) -> Array:
    """Derivatives (p, per m) at the p `NODES` of a span of `length` (m), from `values` there."""
    coordinates = 2.0 * NODES - 1.0
    fitted = chebyshev.chebfit(coordinates, values, len(NODES) - 1)
    return np.asarray(chebyshev.chebval(coordinates, chebyshev.chebder(fitted)) * 2.0 / length)


def _lever_arms(section: Section) -> tuple[float, float]:
    """Lever arms I/S (m) in bending about z and about y, as in `taper_rates`."""
    if (moments := symmetric_moments(section)) is None:
        raise TypeError(f"{section.shape}: has no two axes of symmetry, as lever arms require")
    return 2.0 * section.second_moment_z / moments.y, 2.0 * section.second_moment_y / moments.z
