"""Uniform beams that stand for the inside of a leg of which only the 6×6 of its tip is known.

A straight uniform beam of length L has the tip compliances c66 = L/EI, c26 = L²/2EI and
c22 = L³/3EI + L/κGA, so that c66 gives EI. Its transverse stiffness (K = c⁻¹, all other twists
held) is 1/K22 = L³/12EI + L/κGA: what exceeds L² c66/12 is shear. No 6×6 contains

- whether that excess is shear along the leg or flexibility at its ends. The first has lower held
  frequencies: a uniform load deflects the two as 1 + 4Φ to 1 + Φ, Φ = 12EI/κGAL².
- how much of the stiffness is at the ends, where rigid faces hold contraction and warping.
- whether torsion is Saint-Venant's, c44 = L/GJ, or resisted by warping that the ends hold,
  c44 = L³/12EΓ + L/GI_p (`fem.sections.nonuniform_torsion` with J = 0), as in I-sections. With one
  c44 the second has a first held frequency up to 22.37/(π√12) = 2.06 times as high.

The held stiffness of such legs lies between that of the "soft" and of the "stiff" beam, and with it
every frequency of their robot by its number, whatever its shape (Rayleigh), but for what the shapes
by which the inside follows the ends do to the mass: some 1e-3 of the lowest ones. Radii of gyration
are those of a homogeneous leg, I/A = EI/EA with the EI of c55 and c66.
"""

from math import sqrt
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from fem.beams.beam import beam_leg, with_warping
from fem.sections.nonuniform_torsion import WarpingRod
from lumped.equivalent_leg import require_positive_definite
from lumped.legs import BeamProperties, GivenLeg
from lumped.mechanism.body_model import LegMatrices

Interior: TypeAlias = Literal["uniform", "soft", "stiff"]
# Length that a rigid end face stiffens, in heights of the section, at most. Fitted to 343 modes of
# 60 random robots of solid rectangles, tubes, boxes and I-sections, 4 to 20 times as long as high:
# median 0.023, 95 % below 0.06, all but two below 0.1. In tension it is 0.0225 (ν = 0.3; 0.9 % of a
# leg five times as long as high).
_HELD_LENGTH = 0.1
# Longest stiffened end, in lengths of the leg: the height √12 i of a leg that is no prism is vague.
_LONGEST_HELD = 1.0 / 8.0
# E/G of isotropic metals, ν = 0.3.
_E_OVER_G = 2.6
# Largest share of the transverse flexibility that is shear.
_MOST_SHEAR = 0.9
# Relative round-off of a printed 6×6.
_ROUND_OFF = 1e-6


class _Bending(NamedTuple):
    """EI (N m²) and κGA (N, infinite without shear deformation) of one plane."""

    EI: float
    GA: float


def interior_properties(leg: GivenLeg, interior: Interior) -> BeamProperties:
    """Constants of a uniform beam with the leg's K11, K22, K33, K44 and, with shear, c55 and c66.

    κGA is EA/2.6 at most. If c55 or c66 needs more (the ends of the leg give way locally), the beam
    has K33 or K22 alone. Raises InputError if the compliance is not positive definite.
    """
    require_positive_definite(leg)
    length = leg.length
    k11, k22, k33, k44 = np.diag(np.linalg.inv(leg.compliance))[:4].tolist()
    c55, c66 = np.diag(leg.compliance)[4:].tolist()
    EA, mu = k11 * length, leg.mass / length
    # Squared radii of gyration: K22 and K33 alone would leave out what shear takes off them.
    ry2, rz2 = (max(length / c, k * length**3 / 12.0) / EA for k, c in ((k33, c55), (k22, c66)))
    elastic, about_y, about_z = [
        _between_ends(length, 12.0 * squared) if interior == "soft" else length
        for squared in (0.5 * (ry2 + rz2), ry2, rz2)
    ]
    if interior == "stiff":
        bending = [_Bending(k * length**3 / 12.0, np.inf) for k in (k33, k22)]
    else:
        bending = [_bending(k33, c55, k11, about_y), _bending(k22, c66, k11, about_z)]
    (EIy, GAz), (EIz, GAy) = bending
    return BeamProperties(
        EA=k11 * elastic,
        EIy=EIy,
        EIz=EIz,
        GJ=k44 * elastic,
        GAy=GAy,
        GAz=GAz,
        mu=mu,
        rho_J=mu * (ry2 + rz2),
        rho_Iy=mu * ry2,
        rho_Iz=mu * rz2,
    )


def _between_ends(length: float, squared_height: float) -> float:
    """Length (m) between ends that rigid faces stiffen, of a section of such a height (m²)."""
    return length - 2.0 * min(_HELD_LENGTH * sqrt(squared_height), _LONGEST_HELD * length)


def _bending(transverse: float, turning: float, axial: float, elastic: float) -> _Bending:
    """Plane with such a `transverse` stiffness, κGA at most as of the `axial` one (N/m).

    `turning`: rotation per moment (rad/(N m)); `elastic`: the length (m) that gives way.
    """
    # Transverse flexibility (m/N) by shear.
    shear = max(1.0 / transverse - elastic**2 * turning / 12.0, _E_OVER_G / axial)
    shear = min(shear, _MOST_SHEAR / transverse)
    return _Bending(elastic**3 / 12.0 / (1.0 / transverse - shear), elastic / shear)


def interior_beam(leg: GivenLeg, interior: Interior, elements: int) -> LegMatrices:
    """The leg as a free uniform beam in so many elements; unknowns as of `warping_beam_leg`."""
    properties = interior_properties(leg, interior)
    beam = beam_leg(properties, leg.length, elements)
    if interior != "stiff":
        return beam
    # E I_p, by the radii of gyration.
    polar = properties.EA * properties.rho_J / properties.mu
    twist = polar / _E_OVER_G
    # A closed section resists warping with all of GI_p and does not need it.
    if twist * (1.0 - _ROUND_OFF) <= properties.GJ:
        return beam
    bimoment = leg.length**2 / 12.0 / (1.0 / properties.GJ - 1.0 / twist)
    rod = WarpingRod(twist, twist, bimoment, properties.rho_J, 0.0)
    return with_warping(beam, rod, elements, "rigid")
