"""Equivalent leg: a prism in place of a leg given by its 6×6 compliance (paper §2.3)."""

from dataclasses import replace
from math import sqrt

import numpy as np

from lumped.errors import InputError
from lumped.legs import ConstantLeg, GivenLeg, Leg, Material, SectionedLeg, given_compliance
from lumped.model_choices import EquivalentBy
from lumped.sections import Rectangle


def constant_leg(
    length: float, EA: float, EIy: float, EIz: float, GJ: float, mass: float
) -> ConstantLeg:
    """Prismatic leg of solid rectangular section with given stiffnesses (N, N m²) and mass (kg).

    The sides of the section are h = √(12 EIy/EA) along z and b = √(12 EIz/EA) along y. The material
    has E = EA/(bh), G = GJ/J(b, h) and ν = 0. It is cubic, not isotropic, because no rectangle of
    an isotropic material has four arbitrary stiffnesses.
    """
    section = Rectangle(width=sqrt(12.0 * EIz / EA), height=sqrt(12.0 * EIy / EA))
    material = Material(
        E=EA / section.area,
        G=GJ / section.torsion_constant,
        nu=0.0,
        rho=mass / (section.area * length),
    )
    return ConstantLeg(length, section, material)


def require_positive_definite(leg: GivenLeg) -> None:
    """Raise InputError if the leg's compliance is not positive definite."""
    if np.linalg.eigvalsh(leg.compliance)[0] <= 0.0:
        raise InputError(
            "the 6×6 compliance is not positive definite, so that no equivalent leg exists",
            part=leg.name or "leg",
        )


def equivalent_leg(leg: Leg, by: EquivalentBy = "stiffness") -> ConstantLeg:
    """Prismatic leg with the same first four diagonal terms of its 6×6 as `leg` (paper §2.3).

    With c the 6×6 compliance of a leg of length L: if `by` is "stiffness", the terms are those of K
    = c⁻¹: EA = K11 L, EIz = K22 L³/12, EIy = K33 L³/12, GJ = K44 L. If `by` is "compliance", they
    are those of c: EA = L/c11, EIz = L³/3c22, EIy = L³/3c33, GJ = L/c44. A leg that is prismatic
    already is returned unchanged. Raises InputError if c is not positive definite.
    """
    if isinstance(leg, ConstantLeg):
        return leg
    length = leg.length
    if isinstance(leg, GivenLeg):
        require_positive_definite(leg)
    compliance = given_compliance(leg)
    if by == "stiffness":
        k11, k22, k33, k44 = np.diag(np.linalg.inv(compliance))[:4]
        stiffnesses = (k11 * length, k33 * length**3 / 12.0, k22 * length**3 / 12.0, k44 * length)
    else:
        c11, c22, c33, c44 = np.diag(compliance)[:4]
        stiffnesses = (length / c11, length**3 / (3.0 * c33), length**3 / (3.0 * c22), length / c44)
    EA, EIy, EIz, GJ = (float(value) for value in stiffnesses)
    constant = constant_leg(length, EA=EA, EIy=EIy, EIz=EIz, GJ=GJ, mass=leg.mass)
    return replace(constant, name=f"equivalent of {leg.name}" if leg.name else "")


def sectioned_leg(leg: Leg, by: EquivalentBy = "stiffness") -> SectionedLeg:
    """The leg itself if it has sections, otherwise its equivalent leg.

    `by` selects the terms that the equivalent leg shares with the leg, as in `equivalent_leg`.
    """
    return equivalent_leg(leg, by) if isinstance(leg, GivenLeg) else leg
