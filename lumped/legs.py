"""Legs of a robot: as a section and a material, or as a compliance matrix and a mass.

A leg's local x axis runs from its root to its tip, its local z axis is the robot's z axis.
"""

from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.errors import ComputationError
from lumped.screws import move_compliance
from lumped.sections import Section

Theory: TypeAlias = Literal["euler-bernoulli", "timoshenko"]
Ends: TypeAlias = Literal["rigid", "free"]

# Largest 2νG/E in κ, just short of the one where Cowper's ν is infinite.
_MOST_POISSON = 0.999


class NoBeamTheoryError(ComputationError):
    """A section has no stable Timoshenko beam: its shear coefficient is negative."""


@dataclass(frozen=True)
class Material:
    """Linear elastic material with cubic symmetry along the leg's axes; isotropic if G = E/2(1+ν).

    E, G in Pa, density `rho` in kg/m³.
    """

    E: float
    G: float
    nu: float
    rho: float

    @classmethod
    def isotropic(cls, E: float, nu: float, rho: float) -> "Material":
        """Isotropic material of Young's modulus E (Pa), Poisson's ratio ν, density ρ (kg/m³)."""
        return cls(E=E, G=E / (2.0 * (1.0 + nu)), nu=nu, rho=rho)

    @property
    def shear_nu(self) -> float:
        """Poisson's ratio ν′ with which Cowper's formulas hold: ν′/2(1 + ν′) = νG/E.

        Saint-Venant's shear stresses depend on νG/E alone, κ of an isotropic material on ν by it;
        with a shear modulus of its own κ is that of ν′. As G nears E/2ν ν′ grows without bound, and
        κ to its limit, which is kept beyond: an error of up to ν (i/L)² in bending.
        """
        share = min(2.0 * self.nu * self.G / self.E, _MOST_POISSON)
        return share / (1.0 - share)


@dataclass(frozen=True)
class BeamProperties:
    """What a beam model knows of a prismatic leg.

    EA, GAy, GAz (N; κGA for shear along y and z, infinite without shear deformation), EIy, EIz,
    GJ (N m²), mass per length `mu` (kg/m), rotary inertia per length `rho_J` about x, `rho_Iy`
    and `rho_Iz` (kg m; the latter two zero in Euler–Bernoulli theory).
    """

    EA: float
    EIy: float
    EIz: float
    GJ: float
    GAy: float
    GAz: float
    mu: float
    rho_J: float
    rho_Iy: float
    rho_Iz: float

    def as_euler_bernoulli(self) -> "BeamProperties":
        """The same beam without shear deformation and without rotary inertia of bending."""
        return replace(self, GAy=np.inf, GAz=np.inf, rho_Iy=0.0, rho_Iz=0.0)

    def piece_compliance(self, length: float) -> Array:
        """6×6 compliance of a piece of `length` (m), referred to its middle: diagonal, leg axes.

        (l/EA, l³/12EIz + l/κGA, l³/12EIy + l/κGA, l/GJ, l/EIy, l/EIz): the spring between two
        rigid elements that makes a chain of them exact in statics for any number of elements.
        """
        return np.diag(
            [
                length / self.EA,
                length**3 / (12.0 * self.EIz) + length / self.GAy,
                length**3 / (12.0 * self.EIy) + length / self.GAz,
                length / self.GJ,
                length / self.EIy,
                length / self.EIz,
            ]
        )


@dataclass(frozen=True)
class ConstantLeg:
    """Prismatic leg of `length` (m) with one section and one material.

    `ends`: whether its end faces are kept plane by what they are bolted to or may warp; None where
    nobody said so. `name` serves messages alone: alike legs are equal whatever they are called.
    """

    length: float
    section: Section
    material: Material
    ends: Ends | None = None
    name: str = field(default="", compare=False)

    @property
    def mass(self) -> float:
        """Mass (kg)."""
        return self.material.rho * self.section.area * self.length

    @cached_property
    def timoshenko(self) -> BeamProperties:
        """Beam properties with shear deformation and rotary inertia, textbook section constants.

        Raises NoBeamTheoryError if the section's κ is negative at this ν: no such beam is stable.
        """
        section, material = self.section, self.material
        kappas = section.shear_coefficients(material.shear_nu)
        if min(kappas) < 0.0:
            raise NoBeamTheoryError(
                f"{self.name or 'leg'}, {section.shape}: the shear stiffness κGA = "
                f"{min(kappas) * material.G * section.area:.3g} N is negative; the formula of κ "
                f"does not hold for this section and ν = {material.nu:g}; use Euler–Bernoulli"
            )
        return self._beam(kappas)

    def _beam(self, kappas: tuple[float, float]) -> BeamProperties:
        section, material = self.section, self.material
        kappa_y, kappa_z = kappas
        area, iy, iz = section.area, section.second_moment_y, section.second_moment_z
        return BeamProperties(
            EA=material.E * area,
            EIy=material.E * iy,
            EIz=material.E * iz,
            GJ=material.G * section.torsion_constant,
            GAy=kappa_y * material.G * area,
            GAz=kappa_z * material.G * area,
            mu=material.rho * area,
            rho_J=material.rho * (iy + iz),
            rho_Iy=material.rho * iy,
            rho_Iz=material.rho * iz,
        )

    def properties(self, theory: Theory) -> BeamProperties:
        """Beam properties in the given beam theory; raises as `timoshenko` does."""
        if theory == "euler-bernoulli":
            return self._beam((1.0, 1.0)).as_euler_bernoulli()
        return self.timoshenko


@dataclass(frozen=True, eq=False)
class GivenLeg:
    """Leg known by its 6×6 tip compliance (root clamped, leg axes, SI) and its mass (kg).

    Of where the mass lies, if known, `mass_centre` (m from the root along x) and `inertia` (3×3,
    kg m², leg axes) about it; `name` serves messages.
    """

    length: float
    mass: float
    compliance: Array
    inertia: Array | None = None
    mass_centre: float | None = None
    name: str = field(default="", compare=False)


Leg: TypeAlias = GivenLeg | ConstantLeg


def tip_compliance(properties: BeamProperties, length: float) -> Array:
    """6×6 compliance (SI, leg axes) at the tip of a prismatic cantilever of `length` (m).

    The compliance of the whole piece, diagonal at its middle, moved to its end: c22 = L³/3EIz +
    L/κGA, c26 = L²/2EIz, c35 = −L²/2EIy.
    """
    return move_compliance(properties.piece_compliance(length), np.array([length / 2.0, 0.0, 0.0]))


def given_compliance(leg: Leg) -> Array:
    """6×6 tip compliance (SI, leg axes) of a leg as described: its own, or Timoshenko's."""
    if isinstance(leg, GivenLeg):
        return leg.compliance
    return tip_compliance(leg.timoshenko, leg.length)
