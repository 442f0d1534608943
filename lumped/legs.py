"""Legs of a robot, given by sections and a material, or by a compliance matrix and a mass.

Leg axes: x runs from the root to the tip, z is as near to the robot's z axis as possible.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from itertools import pairwise
from typing import Literal, TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.centre_line import CentreLine, LinePiece
from lumped.errors import ComputationError
from lumped.line_sections import FIELDS, FURTHER, TOGETHER, LineSections
from lumped.memo import memo
from lumped.screws import move_compliance
from lumped.sections import Section, symmetric_moments
from lumped.tapers import NODES, TAPER, taper_flexibilities, taper_rates

Theory: TypeAlias = Literal["euler-bernoulli", "timoshenko"]
Ends: TypeAlias = Literal["rigid", "free"]

# Largest value of 2νG/E in the shear coefficient κ. At 1 the Poisson's ratio ν′ would be infinite.
_LARGEST_RATIO = 0.999


class NoBeamTheoryError(ComputationError):
    """Error: a negative shear coefficient, with which no Timoshenko beam is stable."""


@dataclass(frozen=True)
class Material:
    """Linear elastic material with cubic symmetry, whose axes of symmetry are those of the leg.

    Young's modulus `E` and shear modulus `G` in Pa, Poisson's ratio `nu`, density `rho` in kg/m³.
    The material is isotropic if G = E/2(1+ν).
    """

    E: float
    G: float
    nu: float
    rho: float

    @classmethod
    def isotropic(cls, E: float, nu: float, rho: float) -> "Material":
        """Isotropic material from Young's modulus E (Pa), Poisson's ratio ν, density ρ (kg/m³)."""
        return cls(E=E, G=E / (2.0 * (1.0 + nu)), nu=nu, rho=rho)

    @property
    def shear_nu(self) -> float:
        """Poisson's ratio ν′ for Cowper's formulas, from ν′/2(1 + ν′) = νG/E.

        Saint-Venant's shear stresses, and hence the shear coefficient κ, depend on νG/E alone. A
        material whose G is independent of E and ν therefore has the κ of an isotropic material with
        ν′. As G approaches E/2ν, ν′ grows without bound and κ tends to a limit. This limit is also
        used for larger G. The relative error of the deflection is then at most ν (i/L)², with the
        radius of gyration i.
        """
        share = min(2.0 * self.nu * self.G / self.E, _LARGEST_RATIO)
        return share / (1.0 - share)


@dataclass(frozen=True)
class BeamProperties:
    """Stiffnesses and inertias of a prismatic leg, about the line of its centroids.

    `EA` is in N, `EIy`, `EIz` and `GJ` are in N m². `GAy` and `GAz` (N) are κGA for shear along y
    and along z, infinite without shear deformation. `mu` is the mass per length (kg/m). `rho_J`,
    `rho_Iy` and `rho_Iz` (kg m) are the rotary inertia per length about x, y and z. `rho_Iy` and
    `rho_Iz` are zero in Euler–Bernoulli theory.

    The remaining fields are zero for a section of one material with two axes of symmetry. `EIyz` is
    E∫yz dA (N m²) and `rho_Iyz` is ρ∫yz dA (kg m). `shear_yz` (1/N) is the shear strain along z due
    to a unit force along y. (`centre_y`, `centre_z`) is the position (m) of the shear centre,
    through which forces do not twist the leg, and (`mass_y`, `mass_z`) that of the centre of mass.
    Both are relative to the centroid, which is weighted by Young's modulus. Rotary inertias are
    taken about this centroid.

    Helical fibres couple tension with torsion, and shear with bending: `twist_x` is the rate of
    twist per axial force, and `turn_y` and `turn_z` are the rates of φy and φz per shear force
    along y and along z (1/(N m)). `EA`, `GJ`, EI and κGA are then stiffnesses with all other stress
    resultants zero. Such a section must have its shear centre and its centre of mass at the
    centroid.
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
    mass_y: float = 0.0
    mass_z: float = 0.0
    twist_x: float = 0.0
    turn_y: float = 0.0
    turn_z: float = 0.0

    @property
    def is_helical(self) -> bool:
        """True if tension twists the leg, or a shear force bends it normal to the force."""
        return bool(self.twist_x or self.turn_y or self.turn_z)

    @property
    def couples_bending(self) -> bool:
        """True if a force along y also deflects the leg along z."""
        return bool(self.EIyz or self.shear_yz)

    @property
    def couples_torsion(self) -> bool:
        """True if forces through the centroid twist the leg."""
        return bool(self.centre_y or self.centre_z)

    @property
    def is_eccentric(self) -> bool:
        """True if the centre of mass differs from the centroid."""
        return bool(self.mass_y or self.mass_z)

    @property
    def couplings(self) -> dict[tuple[int, int], float]:
        """Entries of the section's 6×6 flexibility due to helical fibres, by row and column."""
        if not self.is_helical:
            return {}
        return {(0, 3): self.twist_x, (1, 4): self.turn_y, (2, 5): self.turn_z}

    @property
    def section_mass(self) -> Array:
        """6×6 mass matrix per length (kg/m, kg, kg m) of a section, for the twist of its centroid.

        An eccentric mass couples axial motion with bending rotations. Euler–Bernoulli beams have no
        rotary inertia of bending, and this coupling is left out for them, too.
        """
        mass = np.diag([self.mu] * 3 + [self.rho_J, self.rho_Iy, self.rho_Iz])
        mass[4, 5] = mass[5, 4] = -self.rho_Iyz
        mass[1, 3] = mass[3, 1] = -self.mu * self.mass_z
        mass[2, 3] = mass[3, 2] = self.mu * self.mass_y
        if self.rho_Iy or self.rho_Iz:
            mass[0, 4] = mass[4, 0] = self.mu * self.mass_z
            mass[0, 5] = mass[5, 0] = -self.mu * self.mass_y
        return mass

    @property
    def bending(self) -> Array:
        """Bending stiffness [EIz EIyz; EIyz EIy] (N m²).

        Multiplied by the curvatures of the deflections along y and z it gives (Mz, −My).
        """
        return np.array([[self.EIz, self.EIyz], [self.EIyz, self.EIy]])

    @property
    def shear_flexibility(self) -> Array:
        """Shear flexibility [1/GAy s; s 1/GAz] (1/N) with s = `shear_yz`.

        Multiplied by the shear forces (Vy, Vz) it gives the shear strains along y and z.
        """
        return np.array([[1.0 / self.GAy, self.shear_yz], [self.shear_yz, 1.0 / self.GAz]])

    @property
    def rotary_inertia(self) -> Array:
        """Rotary inertia per length [ρIz ρIyz; ρIyz ρIy] (kg m) for the rotations (φz, −φy)."""
        return np.array([[self.rho_Iz, self.rho_Iyz], [self.rho_Iyz, self.rho_Iy]])

    @property
    def to_shear_centre(self) -> Array:
        """6×6 matrix T: twist at the shear centre of a section = T · twist at its centroid."""
        transfer = np.eye(6)
        transfer[1, 3], transfer[2, 3] = -self.centre_z, self.centre_y
        return transfer

    def as_euler_bernoulli(self) -> "BeamProperties":
        """Copy of the properties without shear deformation and rotary inertia of bending."""
        rigid = replace(self, GAy=np.inf, GAz=np.inf, shear_yz=0.0, turn_y=0.0, turn_z=0.0)
        return replace(rigid, rho_Iy=0.0, rho_Iz=0.0, rho_Iyz=0.0)

    def piece_compliance(self, length: float) -> Array:
        """6×6 compliance (SI, leg axes) of a piece of `length` l (m), referred to its middle.

        The reference point is the centroid of the section in the middle of the piece. For a section
        with two axes of symmetry the matrix is diagonal: (l/EA, l³/12EIz + l/κGA, l³/12EIy + l/κGA,
        l/GJ, l/EIy, l/EIz). Rigid elements joined by such springs have exact static deflections for
        any number of elements. For sections without these symmetries, bending and shear are 2×2
        blocks. If the shear centre is not the centroid, the compliance C_s is computed for the
        shear centre, which torsion does not move, and transformed to the centroid: C = T⁻¹ C_s T⁻ᵀ
        with T = `to_shear_centre`.
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
            # φz = dv/dx for the deflection v along y, φy = −dw/dx for the deflection w along z.
            signs = np.array([[1.0, -1.0], [-1.0, 1.0]])
            compliance[4:, 4:] = length * signs * flexibility[::-1, ::-1]
        # Shear forces are constant along the piece, and bending is odd about its middle, so that
        # couplings are those of the section.
        for (row, column), coupling in self.couplings.items():
            compliance[row, column] = compliance[column, row] = length * coupling
        if self.couples_torsion:
            from_shear_centre = np.linalg.inv(self.to_shear_centre)
            compliance = from_shear_centre @ compliance @ from_shear_centre.T
        return np.asarray(compliance)


@dataclass(frozen=True)
class ConstantLeg:
    """Prismatic leg of `length` (m) with one section and one material.

    The x axis of the leg is its line of centroids. `ends` is the end condition: "rigid" if the
    bodies to which the end faces are bolted keep them plane and rigid, "free" if they can warp.
    None if the robot file does not specify it. `name` is used in messages only: legs that differ in
    their name alone are equal.
    """

    length: float
    section: Section
    material: Material
    ends: Ends | None = None
    name: str = field(default="", compare=False)

    @property
    def mass(self) -> float:
        """Mass (kg) of the leg."""
        return self.material.rho * self.section.area * self.length

    @cached_property
    def timoshenko(self) -> BeamProperties:
        """Beam properties of Timoshenko theory, with the constants in `lumped.sections`.

        Raises NoBeamTheoryError if the shear coefficient κ of the section is negative for the
        Poisson's ratio of the material: such a beam is not stable.
        """
        section, material = self.section, self.material
        kappas = section.shear_coefficients(material.shear_nu)
        if min(kappas) < 0.0:
            raise NoBeamTheoryError(
                f"{self.name or 'leg'}, {section.shape}: the shear stiffness κGA = "
                f"{min(kappas) * material.G * section.area:.3g} N is negative; the formula of κ "
                f"does not hold for this section and ν = {material.nu:g}; use theory "
                '"euler-bernoulli"'
            )
        return self._beam(kappas)

    def _beam(self, kappas: tuple[float, float]) -> BeamProperties:
        section, material = self.section, self.material
        kappa_y, kappa_z = kappas
        area, iy, iz = section.area, section.second_moment_y, section.second_moment_z
        product, (centre_y, centre_z) = section.product_moment, section.shear_centre
        inertia_y, inertia_z, inertia_yz = section.inertia_moments
        mass_y, mass_z = section.mass_centre
        twist_x, turn_y, turn_z = section.couplings
        coupling = section.shear_coupling(material.shear_nu) / (material.G * area)
        return BeamProperties(
            EA=material.E * area,
            EIy=material.E * iy,
            EIz=material.E * iz,
            GJ=material.G * section.torsion_constant,
            GAy=kappa_y * material.G * area,
            GAz=kappa_z * material.G * area,
            mu=material.rho * area,
            rho_J=material.rho * (inertia_y + inertia_z),
            rho_Iy=material.rho * inertia_y,
            rho_Iz=material.rho * inertia_z,
            EIyz=material.E * product,
            rho_Iyz=material.rho * inertia_yz,
            shear_yz=coupling,
            centre_y=centre_y,
            centre_z=centre_z,
            mass_y=mass_y,
            mass_z=mass_z,
            twist_x=twist_x,
            turn_y=turn_y,
            turn_z=turn_z,
        )

    def properties(self, theory: Theory) -> BeamProperties:
        """Beam properties in the beam theory `theory`.

        Raises NoBeamTheoryError for Timoshenko theory with a negative shear coefficient.
        """
        if theory == "euler-bernoulli":
            return self._beam((1.0, 1.0)).as_euler_bernoulli()
        return self.timoshenko


@dataclass(frozen=True, eq=False)
class GivenLeg:
    """Leg specified by its 6×6 tip compliance (root clamped, leg axes, SI), length and mass.

    `length` is in m, `mass` in kg. `mass_centre` (m from the root along x) and `inertia` (3×3, in
    kg m², leg axes, about the mass centre) describe the mass distribution. They are None if the
    mass distribution is unknown. `name` is used in messages only.
    """

    length: float
    mass: float
    compliance: Array
    inertia: Array | None = None
    mass_centre: float | None = None
    name: str = field(default="", compare=False)


@dataclass(frozen=True)
class Span:
    """Part of a leg from `start` to `end` (m along its line), with linearly varying sections.

    `first` and `last` are the sections at its ends.
    """

    start: float
    end: float
    first: Section
    last: Section

    def section(self, share: float) -> Section:
        """Section at the fraction `share` of the span, with linearly interpolated dimensions."""
        if self.first == self.last:
            return self.first
        sizes = {
            entry.name: (1.0 - share) * getattr(self.first, entry.name)
            + share * getattr(self.last, entry.name)
            for entry in fields(self.first)
        }
        return type(self.first)(**sizes)

    def taper_rates(self, shares: Array) -> Array:
        """Rates d ln a/ds (p×2, 1/m) of the lever arms a = I/S at p fractions `shares` of the span.

        The columns are for bending about z and about y. I is the second moment of area, S the first
        moment of area of half the section. The rates are zero if the section is constant or does
        not have two axes of symmetry.
        """
        if not self.converges:
            return np.zeros((len(shares), 2))
        return taper_rates(self._sections, self.end - self.start, shares)

    def taper_flexibilities(self, material: Material) -> Array:
        """Taper rates, and flexibility due to inclined fibres (p×7), at p points of the span.

        The points are at the fractions `lumped.tapers.NODES` of the span. The columns are named in
        `lumped.tapers.TAPER`. All entries are zero if the section is constant or does not have two
        axes of symmetry.
        """
        if not self.converges:
            return np.zeros((len(NODES), len(TAPER)))
        moduli = material.E, material.G, material.nu
        return taper_flexibilities(self._sections, self.end - self.start, moduli)

    @property
    def converges(self) -> bool:
        """True if the effects of fibres that converge in a taper are computed for this span.

        This requires that the section varies and that its shape has two axes of symmetry.
        """
        return self.first != self.last and symmetric_moments(self.first) is not None

    @property
    def _sections(self) -> list[Section]:
        return [self.section(share) for share in NODES.tolist()]


@dataclass(frozen=True)
class LineLeg:
    """Leg along a centre line, with sections at stations and one material.

    `stations` are pairs of a position (m along the line, ascending, from its start to its end) and
    the section there. Dimensions of sections vary linearly between two stations, which therefore
    have the same shape. Two stations at one position make a step. The centroids of all sections are
    on the line. `ends` and `name` have the same meaning as in `ConstantLeg`.
    """

    line: CentreLine
    stations: tuple[tuple[float, Section], ...]
    material: Material
    ends: Ends | None = None
    name: str = field(default="", compare=False)

    @property
    def length(self) -> float:
        """Straight distance (m) from root to tip of the leg."""
        return self.line.chord

    @cached_property
    def spans(self) -> tuple[Span, ...]:
        """Parts of the leg without jumps of section or direction, in order from root to tip.

        Each lies between two neighbouring stations and within one piece of the centre line.
        """
        slack = TOGETHER * self.line.length
        spans = []
        for (start, first), (end, last) in pairwise(self.stations):
            if end - start <= slack:
                continue
            span = Span(start, end, first, last)
            inner = [x for x in self.line.ends.tolist() if start + slack < x < end - slack]
            edges = [start, *inner, end]
            for a, b in pairwise(edges):
                sections = (span.section((x - start) / (end - start)) for x in (a, b))
                spans.append(Span(a, b, *sections))
        return tuple(spans)

    @property
    def largest_extent(self) -> float:
        """Largest side (m) of the bounding boxes of the sections."""
        return max(max(section.extent) for _, section in self.stations)

    def section_at(self, position: float) -> Section:
        """Section at `position` (m along the line). At a step this is the section beyond it."""
        span = next((s for s in reversed(self.spans) if s.start <= position), self.spans[0])
        return span.section(min(1.0, (position - span.start) / (span.end - span.start)))

    @property
    def mass(self) -> float:
        """Mass (kg) of the leg, an integral over its sections."""
        along = self.sections("euler-bernoulli")
        origin = np.zeros((1, 3))
        return float(along.masses(along.ends[[0, -1]], origin)[0, 0, 0])

    def inertia_points(self, positions: Array, corners: Array) -> tuple[Array, Array]:
        """Points (n×c×3) that represent the mass of n sections, and mass per length (n, kg/m).

        The sections are at the n `positions` (m along the line). Each is represented by c points
        (m, leg axes). `corners` (c×2) are their coordinates y and z in the axes of the section, in
        units of its radii of gyration.
        """
        along = self.sections("euler-bernoulli")
        constants = along.constants(along.span_at(positions), positions)
        EA, EIy, EIz, mu = (constants[:, FIELDS.index(name)] for name in ("EA", "EIy", "EIz", "mu"))
        radii = np.sqrt(np.column_stack([EIz, EIy]) / EA[:, None])
        centres, axes = self.line.frames(positions)
        offsets = np.einsum("nij,nj,cj->nci", axes[:, :, 1:], radii, corners)
        return centres[:, None] + offsets, mu

    def sections(self, theory: Theory) -> LineSections:
        """Flexibility and mass of the sections along the line, in the beam theory `theory`.

        Raises NoBeamTheoryError for Timoshenko theory with a negative shear coefficient.
        """
        return _line_sections(self, theory)

    def sections_by(self, beam: Callable[[ConstantLeg], BeamProperties]) -> LineSections:
        """Flexibility and mass of the sections along the line by Timoshenko's theory.

        `beam` computes the beam properties of a prism that has the section at one point of the
        line.
        """
        return self._sections(beam, inclined=True)

    def _sections(
        self, beam: Callable[[ConstantLeg], BeamProperties], *, inclined: bool
    ) -> LineSections:
        """Flexibility and mass of the sections along the line.

        `beam` computes the beam properties of a prism that has the section at one point of the
        line. If `inclined` is False, the effects of converging fibres in tapers are left out.
        """
        values = []
        for span in self.spans:
            prismatic = span.first == span.last
            rows = []
            for share in [0.0] if prismatic else NODES.tolist():
                prism = ConstantLeg(
                    span.end - span.start, span.section(share), self.material, self.ends, self.name
                )
                properties = beam(prism)
                constants = [getattr(properties, name) for name in FIELDS]
                moments = symmetric_moments(prism.section)
                fourth = (moments.yyyy, moments.zzzz, moments.yyzz) if moments else (0.0,) * 3
                rows.append([*constants, *(self.material.E * moment for moment in fourth)])
            constants_and_moments = np.broadcast_to(rows, (len(NODES), len(rows[0])))
            taper = span.taper_flexibilities(self.material)
            values.append(np.hstack([constants_and_moments, taper if inclined else 0.0 * taper]))
        ends = np.array([self.spans[0].start, *(span.end for span in self.spans)])
        return LineSections(self.line, ends, np.array(values, dtype=float))


@memo(32)
def _line_sections(leg: LineLeg, theory: Theory) -> LineSections:
    return leg._sections(lambda prism: prism.properties(theory), inclined=theory == "timoshenko")


# Legs with sections and a material.
SectionedLeg: TypeAlias = ConstantLeg | LineLeg
Leg: TypeAlias = GivenLeg | SectionedLeg


def tip_compliance(properties: BeamProperties, length: float) -> Array:
    """6×6 compliance (SI, leg axes) at the tip of a prismatic cantilever of `length` L (m).

    It is the compliance of the whole leg about its middle, transferred to its end. For a section
    with two axes of symmetry, c22 = L³/3EIz + L/κGA, c26 = L²/2EIz and c35 = −L²/2EIy.
    """
    return move_compliance(properties.piece_compliance(length), np.array([length / 2.0, 0.0, 0.0]))


def prism_sections(properties: BeamProperties, length: float) -> LineSections:
    """Sections of a prism of `length` (m) along its centre line.

    The sections have the given `properties`, whose centre of mass must be the centroid.
    """
    line = CentreLine((LinePiece((0.0, 0.0, 0.0), (length, 0.0, 0.0)),), (0.0, 0.0, 1.0))
    constants = [*(getattr(properties, name) for name in FIELDS), *[0.0] * len(FURTHER)]
    values = np.tile(constants, (1, len(NODES), 1))
    return LineSections(line, np.array([0.0, length]), values)


def is_bent(leg: Leg) -> bool:
    """True if the centre line of a leg is not straight."""
    return isinstance(leg, LineLeg) and not leg.line.is_straight


def sectioned_compliance(leg: SectionedLeg, theory: Theory) -> Array:
    """6×6 tip compliance (SI, leg axes) of a leg with sections, by the beam theory `theory`."""
    if isinstance(leg, LineLeg):
        return leg.sections(theory).tip_compliance
    return tip_compliance(leg.properties(theory), leg.length)


def given_compliance(leg: Leg) -> Array:
    """6×6 tip compliance (SI, leg axes) of a leg.

    For a leg specified by its 6×6 it is the matrix in the robot file. For a leg with sections it is
    computed by Timoshenko's theory.
    """
    if isinstance(leg, GivenLeg):
        return leg.compliance
    return sectioned_compliance(leg, "timoshenko")
