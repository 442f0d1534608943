"""Legs of a robot, given by sections and a material, or by a compliance matrix and a mass.

Leg axes: x runs from the root to the tip, z is as near to the robot's z axis as possible.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import cached_property
from itertools import pairwise
from typing import TypeAlias

import numpy as np

from lumped.arrays import Array
from lumped.beam_properties import BeamProperties, tip_compliance
from lumped.centre_line import CentreLine, straight_line
from lumped.errors import ComputationError
from lumped.line_sections import FIELDS, TOGETHER, LineSections
from lumped.memo import memo
from lumped.model_choices import Ends, Theory
from lumped.sections import Section, symmetric_moments
from lumped.tapers import NODES, TAPER, taper_flexibilities, taper_rates

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

    def share_of(self, section: Section) -> float | None:
        """Fraction of the span at which it has the `section`. None if it has it nowhere."""
        if section == self.first:
            return 0.0
        if self.first == self.last or type(section) is not type(self.first):
            return None
        first, last, sizes = (
            np.array([getattr(part, entry.name) for entry in fields(part)], dtype=float)
            for part in (self.first, self.last, section)
        )
        changes = last - first
        share = float((sizes - first) @ changes / (changes @ changes))
        slack = TOGETHER * float(np.abs(first).max())
        is_same = np.abs(first + share * changes - sizes).max() <= slack
        return share if is_same and 0.0 <= share <= 1.0 + TOGETHER else None

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
        """Taper rates and the flexibilities due to inclined faces, together p×7.

        The rows are p points, at the fractions `lumped.tapers.NODES` of the span. The columns are
        named in `lumped.tapers.TAPER`. All entries are zero if the section is constant or does not
        have two axes of symmetry.
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

    @cached_property
    def steps(self) -> tuple[tuple[float, Section, Section], ...]:
        """Position (m along the line) of each step, and the sections before and after it."""
        slack = TOGETHER * self.line.length
        return tuple(
            (start, first, second)
            for (start, first), (end, second) in pairwise(self.stations)
            if end - start <= slack and first != second
        )

    @property
    def largest_extent(self) -> float:
        """Largest side (m) of the bounding boxes of the sections."""
        return max(max(section.extent) for _, section in self.stations)

    def section_at(self, position: float) -> Section:
        """Section at `position` (m along the line). At a step it is the one on the tip's side."""
        span = next((s for s in reversed(self.spans) if s.start <= position), self.spans[0])
        return span.section(min(1.0, (position - span.start) / (span.end - span.start)))

    @property
    def mass(self) -> float:
        """Mass (kg) of the leg, by Simpson's rule: areas of linear tapers vary as parabolas."""
        volumes = [
            (span.end - span.start)
            * (span.first.area + 4.0 * span.section(0.5).area + span.last.area)
            / 6.0
            for span in self.spans
        ]
        return float(self.material.rho * sum(volumes))

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


def is_bent(leg: Leg) -> bool:
    """True if the centre line of a leg is not straight."""
    return isinstance(leg, LineLeg) and not leg.line.is_straight


def centre_line(leg: Leg) -> CentreLine:
    """Centre line of a leg."""
    return leg.line if isinstance(leg, LineLeg) else straight_line(float(leg.length))


def line_length(leg: Leg) -> float:
    """Length (m) of the centre line of a leg, from its root to its tip."""
    return leg.line.length if isinstance(leg, LineLeg) else float(leg.length)


def given_compliance(leg: Leg, theory: Theory = "timoshenko") -> Array:
    """6×6 tip compliance (SI, leg axes) of a leg.

    For a leg specified by its 6×6 it is the matrix in the robot file. For a leg with sections it is
    computed by the beam theory `theory`.
    """
    if isinstance(leg, GivenLeg):
        return leg.compliance
    if isinstance(leg, LineLeg):
        return leg.sections(theory).tip_compliance
    return tip_compliance(leg.properties(theory), leg.length)
