"""Uniform beams that represent the inside of a leg of which only the 6×6 compliance is known.

They are used for the modes of the leg with fixed ends, which this compliance does not determine. A
straight uniform beam of length L has the tip compliances c66 = L/EI, c26 = L²/2EI and c22 = L³/3EI
+ L/κGA, so that EI follows from c66. Its transverse stiffness (K = c⁻¹, all other twists fixed) is
1/K22 = L³/12EI + L/κGA: the excess over L² c66/12 is attributed to shear. A 6×6 compliance does not
show

- whether this excess is due to shear along the leg or to compliance at its ends. With shear, the
  frequencies with fixed ends are lower: the deflections under a uniform load have the ratio 1 + 4Φ
  to 1 + Φ, Φ = 12EI/κGAL²;
- how much of the stiffness is due to rigid end faces, which prevent contraction and warping;
- whether torsion follows Saint-Venant, c44 = L/GJ, or is resisted by warping that the ends prevent,
  c44 = L³/12EΓ + L/GI_p (`fem.sections.nonuniform_torsion` with J = 0), as in I-sections. For the
  same c44, a leg that resists by warping has a first frequency with fixed ends up to 22.37/(π√12) =
  2.06 times as high.

The "uniform" beam attributes the excess to shear, and the whole stiffness to the leg between its
ends. The "soft" beam additionally attributes a part of the stiffness to rigid end faces, so that
the leg itself is softer. The "stiff" beam has no shear deformation, and its torsion is resisted by
warping. The stiffness of the leg with fixed ends lies between those of the "soft" and of the
"stiff" beam. So does each frequency of the robot (Rayleigh), except for an effect of about 1e-3 on
the lowest frequencies: different shapes between the ends also change the mass matrix. Radii of
gyration are those of a homogeneous leg, I/A = EI/EA with the EI that follow from c55 and c66.
"""

from math import sqrt
from typing import Literal, NamedTuple, TypeAlias

import numpy as np

from fem.beams.beam import beam_leg, with_warping
from fem.sections.nonuniform_torsion import WarpingRod
from lumped.beam_properties import BeamProperties
from lumped.equivalent_leg import require_positive_definite
from lumped.legs import GivenLeg
from lumped.mechanism.body_model import LegMatrices

Interior: TypeAlias = Literal["uniform", "soft", "stiff"]
# Largest length that a rigid end face stiffens, divided by the height of the section. Fitted to 343
# modes of 60 random robots with solid rectangles, tubes, boxes and I-sections, 4 to 20 times as
# long as high: median 0.023, 95 % below 0.06, all but two below 0.1. In tension it is 0.0225 (ν =
# 0.3), which is 0.9 % of a leg five times as long as high.
_HELD_LENGTH = 0.1
# Largest length of a stiffened end, divided by the length of the leg. It limits the estimate from
# the height √12 i, which is uncertain for a leg that is not a prism.
_LONGEST_HELD = 1.0 / 8.0
# E/G of isotropic metals, ν = 0.3.
_E_OVER_G = 2.6
# Largest fraction of the transverse flexibility that is attributed to shear.
_MOST_SHEAR = 0.9
# Relative round-off of a printed 6×6.
_ROUND_OFF = 1e-6


class _Bending(NamedTuple):
    """Bending stiffness EI (N m²) and shear stiffness κGA (N) of one plane. κGA may be infinite."""

    EI: float
    GA: float


def interior_properties(leg: GivenLeg, interior: Interior) -> BeamProperties:
    """Properties of the uniform beam that represents the inside of a leg given by its compliance.

    K is the inverse of the compliance c of the leg. A beam of the `interior` "uniform" or "stiff"
    has the stiffnesses K11, K22, K33 and K44. The "soft" one has them on the shorter length between
    the end regions that rigid faces stiffen. Unless `interior` is "stiff", the compliances c55 and
    c66 are matched, too, and κGA is at most EA/2.6. If c55 or c66 would require a larger κGA
    (because the ends of the leg are locally compliant), only K33 or K22 is matched. Raises
    InputError if the compliance of the leg is not positive definite.
    """
    require_positive_definite(leg)
    length = leg.length
    k11, k22, k33, k44 = np.diag(np.linalg.inv(leg.compliance))[:4].tolist()
    c55, c66 = np.diag(leg.compliance)[4:].tolist()
    EA, mu = k11 * length, leg.mass / length
    # Squared radii of gyration. They are not from K22 and K33 alone, which shear reduces.
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
    """Length (m) of a leg without the end regions that rigid faces stiffen.

    `length` (m) is that of the whole leg, `squared_height` (m²) the square of the section's height.
    """
    return length - 2.0 * min(_HELD_LENGTH * sqrt(squared_height), _LONGEST_HELD * length)


def _bending(transverse: float, turning: float, axial: float, elastic: float) -> _Bending:
    """Bending and shear stiffness of a beam with a given transverse stiffness of its ends.

    `transverse` (N/m) is the force per deflection of one end with all other end motions fixed.
    `turning` (rad/(N m)) is the rotation of the tip per moment, `axial` (N/m) the axial stiffness,
    which limits κGA, and `elastic` (m) the length that deforms.
    """
    # Transverse flexibility (m/N) due to shear.
    shear = max(1.0 / transverse - elastic**2 * turning / 12.0, _E_OVER_G / axial)
    shear = min(shear, _MOST_SHEAR / transverse)
    return _Bending(elastic**3 / 12.0 / (1.0 / transverse - shear), elastic / shear)


def interior_beam(leg: GivenLeg, interior: Interior, elements: int) -> LegMatrices:
    """Free uniform beam with `elements` elements for the inside of a leg given by its compliance.

    The unknowns are those of `warping_beam_leg`.
    """
    properties = interior_properties(leg, interior)
    beam = beam_leg(properties, leg.length, elements)
    if interior != "stiff":
        return beam
    # E I_p from the radii of gyration.
    polar = properties.EA * properties.rho_J / properties.mu
    twist = polar / _E_OVER_G
    # The torsional stiffness of a closed section is GI_p without warping.
    if twist * (1.0 - _ROUND_OFF) <= properties.GJ:
        return beam
    bimoment = leg.length**2 / 12.0 / (1.0 / properties.GJ - 1.0 / twist)
    rod = WarpingRod(twist, twist, bimoment, properties.rho_J, 0.0)
    return with_warping(beam, rod, elements, "rigid")
