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

# Largest 2νG/E in κ, just below 1, for which Cowper's ν is infinite.
_LARGEST_RATIO = 0.999


class NoBeamTheoryError(ComputationError):
    """Error of a section without a stable Timoshenko beam: its shear coefficient is negative."""


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
        """Poisson's ratio ν′ for Cowper's formulas: ν′/2(1 + ν′) = νG/E.

        Saint-Venant's shear stresses depend on νG/E alone, and so does κ. With an independent shear
        modulus κ is therefore that of an isotropic material with ν′. As G approaches E/2ν, ν′ grows
        without bound and κ tends to its limit, which is used beyond: an error of up to ν (i/L)² in
        bending.
        """
        share = min(2.0 * self.nu * self.G / self.E, _LARGEST_RATIO)
        return share / (1.0 - share)


@dataclass(frozen=True)
class BeamProperties:
    """Stiffnesses and inertias of a prismatic leg along the line of its centroids.

    EA, GAy, GAz (N; κGA for shear along y and z, infinite without shear deformation), EIy, EIz,
    GJ (N m²), mass per length `mu` (kg/m), rotary inertia per length `rho_J` about x, `rho_Iy`
    and `rho_Iz` (kg m; the latter two zero in Euler–Bernoulli theory).

    A section without two axes of symmetry has in addition: EIyz = E∫yz dA (N m²) and `rho_Iyz` (kg
    m), `shear_yz` (1/N), the shear strain along z by a unit force along y, and the shear centre at
    (`centre_y`, `centre_z`) (m) from the centroid: forces through it do not twist the leg.
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
    EIyz: float = 0.0
    rho_Iyz: float = 0.0
    shear_yz: float = 0.0
    centre_y: float = 0.0
    centre_z: float = 0.0

    @property
    def couples_bending(self) -> bool:
        """True if a force along y deflects the leg along z too."""
        return bool(self.EIyz or self.shear_yz)

    @property
    def couples_torsion(self) -> bool:
        """True if forces through the centroid twist the leg."""
        return bool(self.centre_y or self.centre_z)

    @property
    def bending(self) -> Array:
        """[EIz EIyz; EIyz EIy] (N m²): (Mz, −My) from the curvatures along y and along z."""
        return np.array([[self.EIz, self.EIyz], [self.EIyz, self.EIy]])

    @property
    def shear_flexibility(self) -> Array:
        """[1/GAy s; s 1/GAz] (1/N), s = `shear_yz`: shear strains along y and z from Vy and Vz."""
        return np.array([[1.0 / self.GAy, self.shear_yz], [self.shear_yz, 1.0 / self.GAz]])

    @property
    def rotary_inertia(self) -> Array:
        """[ρIz ρIyz; ρIyz ρIy] (kg m): inertia against the rotations of `bending`."""
        return np.array([[self.rho_Iz, self.rho_Iyz], [self.rho_Iyz, self.rho_Iy]])

    @property
    def to_shear_centre(self) -> Array:
        """6×6 map of the centroid's twist to one with the deflections of the shear centre."""
        transfer = np.eye(6)
        transfer[1, 3], transfer[2, 3] = -self.centre_z, self.centre_y
        return transfer

    def as_euler_bernoulli(self) -> "BeamProperties":
        """Return the beam without shear deformation and without rotary inertia of bending."""
        return replace(
            self, GAy=np.inf, GAz=np.inf, shear_yz=0.0, rho_Iy=0.0, rho_Iz=0.0, rho_Iyz=0.0
        )

    def piece_compliance(self, length: float) -> Array:
        """6×6 compliance of a piece of `length` (m), referred to the centroid in its middle.

        (l/EA, l³/12EIz + l/κGA, l³/12EIy + l/κGA, l/GJ, l/EIy, l/EIz) on the diagonal of a section
        with two axes of symmetry: the spring between two rigid elements that makes a chain of them
        exact in statics for any number of elements. Otherwise bending and shear are 2×2 blocks,
        and the shear centre's offset adds a term of torsion: its deflections, not the centroid's,
        are free of the twist, C = T⁻¹ C_s T⁻ᵀ.
        """
        compliance = np.diag(
            [
                length / self.EA,
                length**3 / (12.0 * self.EIz) + length / self.GAy,
                length**3 / (12.0 * self.EIy) + length / self.GAz,
                length / self.GJ,
                length / self.EIy,
                length / self.EIz,
            ]
        )
        if self.couples_bending:
            flexibility = np.linalg.inv(self.bending)
            shear = length * self.shear_flexibility
            compliance[1:3, 1:3] = length**3 / 12.0 * flexibility + shear
            # φz turns with the deflection along y, φy against that along z.
            signs = np.array([[1.0, -1.0], [-1.0, 1.0]])
            compliance[4:, 4:] = length * signs * flexibility[::-1, ::-1]
        if self.couples_torsion:
            from_shear_centre = np.linalg.inv(self.to_shear_centre)
            compliance = from_shear_centre @ compliance @ from_shear_centre.T
        return np.asarray(compliance)


@dataclass(frozen=True)
class ConstantLeg:
    """Prismatic leg of `length` (m) with one section and one material, centroids along its axis.

    `ends`: end condition of its end faces, kept plane by the bodies to which they are bolted or
    free to warp. None if the robot file does not specify it. `name` is used in messages alone: legs
    that differ in name alone are equal.
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
        product, (centre_y, centre_z) = section.product_moment, section.shear_centre
        coupling = section.shear_coupling(material.shear_nu) / (material.G * area)
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
            EIyz=material.E * product,
            rho_Iyz=material.rho * product,
            shear_yz=coupling,
            centre_y=centre_y,
            centre_z=centre_z,
        )

    def properties(self, theory: Theory) -> BeamProperties:
        """Beam properties in the given beam theory; raises as `timoshenko` does."""
        if theory == "euler-bernoulli":
            return self._beam((1.0, 1.0)).as_euler_bernoulli()
        return self.timoshenko


@dataclass(frozen=True, eq=False)
class GivenLeg:
    """Leg known by its 6×6 tip compliance (root clamped, leg axes, SI) and its mass (kg).

    `mass_centre` (m from the root along x) and `inertia` (3×3, kg m², leg axes) about it describe
    the mass distribution. None if they are unknown. `name` is used in messages.
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

    The compliance of the whole piece, referred to its middle, is transferred to its end: c22 =
    L³/3EIz + L/κGA, c26 = L²/2EIz, c35 = −L²/2EIy with two axes of symmetry.
    """
    return move_compliance(properties.piece_compliance(length), np.array([length / 2.0, 0.0, 0.0]))


def given_compliance(leg: Leg) -> Array:
    """6×6 tip compliance (SI, leg axes) of a leg: as given in the file, or Timoshenko's."""
    if isinstance(leg, GivenLeg):
        return leg.compliance
    return tip_compliance(leg.timoshenko, leg.length)
