"""Sections of several materials, bonded along the edges of their parts.

The axis of the leg passes through the centroid weighted by Young's moduli, Σ E_i ∫ s dA = 0, where
an axial force does not bend the leg. EA and EI are sums over the parts. GJ, shear centre and shear
stiffness are computed by integrals over the edges of all parts (`lumped.sections.saint_venant`).
GJ is computed with the shear modulus of each part. Shear centre and shear stiffness are computed
with one mean Poisson's ratio EA/2GA − 1.

Parts with different Poisson's ratios restrain each other's contraction. This increases EA and EI by
an amount of second order in the difference of the ratios, which is neglected here.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations
from math import pi, sin, sqrt
from typing import ClassVar

import numpy as np

from lumped.arrays import Array
from lumped.memo import memo
from lumped.sections.boundary_elements import Region
from lumped.sections.edged import OFF_CENTRE, EdgedSection, product_of
from lumped.sections.outlined import OutlinedSection
from lumped.sections.polygons import TOUCHING, Loop, is_inside, partition_edges
from lumped.sections.saint_venant import (
    RimSolution,
    area_moments,
    rim_solution,
    weighted_moments,
)
from lumped.sections.shapes import Circle, HollowRectangle, ISection, Rectangle, Section, Tube

# Sides of the polygon of equal area that stands for a circle: J differs by 1e-5.
_SIDES = 64
# Share of the size by which a point beside an edge lies inside its part.
_BESIDE = 10.0 * TOUCHING


@dataclass(frozen=True)
class CompositePart:
    """Part of a composite: a shape of one isotropic material with E (Pa), ν and ρ (kg/m³).

    `at` (y and z, in m) is the position of the shape's origin in the composite's coordinates. The
    origin of a shape with two axes of symmetry is its middle. That of a channel or an angle is the
    corner at the smallest y and z, and that of a tee is the lower end of its middle line. A polygon
    has the origin of its coordinates.
    """

    section: Section
    E: float
    nu: float
    rho: float
    at: tuple[float, float] = (0.0, 0.0)

    @property
    def loops(self) -> tuple[Loop, ...]:
        """Outline (counter-clockwise) and holes (clockwise) in the composite's coordinates (m)."""
        return tuple(loop + np.array(self.at) for loop in outline(self.section))

    @property
    def G(self) -> float:
        """Shear modulus (Pa)."""
        return self.E / (2.0 * (1.0 + self.nu))


def outline(section: Section) -> tuple[Loop, ...]:
    """Outline (counter-clockwise) and holes (clockwise) of a shape in its own coordinates (m)."""
    match section:
        case OutlinedSection():
            return section.loops
        case Rectangle():
            return (_box(section.width, section.height),)
        case HollowRectangle():
            inner = section.inner
            return _box(section.width, section.height), _box(inner.width, inner.height)[::-1]
        case Circle():
            return (_ring(section.diameter),)
        case Tube():
            return _ring(section.diameter), _ring(section.inner_diameter)[::-1]
        case ISection():
            return (section.outline,)
    raise TypeError(f"{section.shape}: a section of this shape has no outline")


def _box(width: float, height: float) -> Loop:
    return np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) * [width / 2.0, height / 2.0]


def _ring(diameter: float) -> Loop:
    """Corners (m) of a regular polygon with the same area as a circle of `diameter` (m)."""
    angles = 2.0 * pi * np.arange(_SIDES) / _SIDES
    radius = diameter / 2.0 * sqrt(2.0 * pi / (_SIDES * sin(2.0 * pi / _SIDES)))
    return np.asarray(radius * np.column_stack([np.cos(angles), np.sin(angles)]))


@dataclass(frozen=True)
class Composite(EdgedSection):
    """Section of parts of different materials that touch along edges and do not overlap.

    Its constants are those of a section of the `mean_material`: E of this material times
    `second_moment_y` is EIy, its G times `torsion_constant` is GJ, and its ρ times
    `inertia_moments` are the rotary inertias per length.
    """

    parts: tuple[CompositePart, ...]
    shape: ClassVar[str] = "composite"

    @property
    def is_uniform(self) -> bool:
        return False

    @property
    def centred_loops(self) -> tuple[tuple[Loop, ...], ...]:
        """Loops of each part in coordinates (m) relative to the centroid weighted by E."""
        centroid, _ = _stiffness_moments(self)
        return tuple(tuple(loop - centroid for loop in part.loops) for part in self.parts)

    @property
    def flexure(self) -> tuple[RimSolution, float]:
        return _solution(self, "E")

    @property
    def mean_material(self) -> tuple[float, float, float, float]:
        """E, G (Pa), ν and ρ (kg/m³) of one material with the same EA, GA and mass per length."""
        areas = np.array([_area(part) for part in self.parts])
        E, G, rho = (
            float(areas @ [getattr(part, name) for part in self.parts] / areas.sum())
            for name in ("E", "G", "rho")
        )
        return E, G, E / (2.0 * G) - 1.0, rho

    @property
    def area(self) -> float:
        return float(sum(_area(part) for part in self.parts))

    @property
    def second_moment_y(self) -> float:
        return float(_stiffness_moments(self)[1][1, 1])

    @property
    def second_moment_z(self) -> float:
        return float(_stiffness_moments(self)[1][0, 0])

    @property
    def product_moment(self) -> float:
        return product_of(_stiffness_moments(self)[1])

    @property
    def part_moments(self) -> tuple[Array, ...]:
        """Unweighted Σ = ∫ s sᵀ dA (2×2, m⁴) of each part about the E-weighted centroid."""
        centred = [area_moments(loops) for loops in self.centred_loops]
        return tuple(
            moments + area * np.outer(centroid, centroid) for area, centroid, moments in centred
        )

    @property
    def inertia_moments(self) -> tuple[float, float, float]:
        _, moments = _mass_moments(self)
        return float(moments[1, 1]), float(moments[0, 0]), product_of(moments)

    @property
    def mass_centre(self) -> tuple[float, float]:
        offset = _mass_moments(self)[0] - _stiffness_moments(self)[0]
        y, z = np.where(np.abs(offset) > OFF_CENTRE * max(self.extent), offset, 0.0)
        return float(y), float(z)

    @property
    def torsion_constant(self) -> float:
        return _torsion_constant(self)

    @property
    def extent(self) -> tuple[float, float]:
        corners = np.vstack([loop for part in self.parts for loop in part.loops])
        width, height = np.ptp(corners, axis=0)
        return float(width), float(height)

    def faults(self, unit: str = "m") -> list[str]:
        faults = [
            f"parts[{number}].section.{fault}"
            for number, part in enumerate(self.parts, start=1)
            for fault in part.section.faults(unit)
        ]
        return faults or part_faults([part.loops for part in self.parts])


def _area(part: CompositePart) -> float:
    return part.section.area


@memo(64)
def _stiffness_moments(section: Composite) -> tuple[Array, Array]:
    """Centroid (2, in m), and Σ = ∫ s sᵀ dA (2×2, in m⁴) about it.

    The integrals are weighted by E of each part, divided by the mean E.
    """
    E, *_ = section.mean_material
    _, centroid, moments = weighted_moments(_regions(section, "E", E))
    return centroid, moments


@memo(64)
def _mass_moments(section: Composite) -> tuple[Array, Array]:
    """Centre of mass (2, in m), and ∫ s sᵀ dA (2×2, in m⁴) about the E-weighted centroid.

    The integrals are weighted by the density of each part, divided by the mean density.
    """
    *_, rho = section.mean_material
    area, centre, moments = weighted_moments(_regions(section, "rho", rho))
    offset = centre - _stiffness_moments(section)[0]
    return centre, moments + area * np.outer(offset, offset)


@memo(64)
def _torsion_constant(section: Composite) -> float:
    """Torsion constant J (m⁴) that gives GJ when multiplied by the mean shear modulus."""
    one_ratio = len({part.nu for part in section.parts}) == 1
    solution, size = _solution(section, "E" if one_ratio else "G")
    return solution.torsion_constant * size**4


@memo(64)
def _solution(section: Composite, modulus: str) -> tuple[RimSolution, float]:
    """Solution of torsion and flexure for the section scaled to size 1, and its size (m).

    Each part is weighted by its `modulus` ("E" or "G"), divided by the mean of this modulus.
    """
    E, G, *_ = section.mean_material
    mean = E if modulus == "E" else G
    size = max(section.extent)
    regions = _regions(section, modulus, mean)
    scaled = [Region([loop / size for loop in region.loops], region.weight) for region in regions]
    return rim_solution(scaled), size


def _regions(section: Composite, constant: str, mean: float) -> list[Region]:
    """Region of each part. Its weight is its `constant` ("E", "G" or "rho") divided by `mean`."""
    return [Region(part.loops, getattr(part, constant) / mean) for part in section.parts]


def part_faults(regions: Sequence[Sequence[Loop]]) -> list[str]:
    """Faults of parts that overlap, or that are not joined into one piece, one text each.

    `regions` contains the loops of each part: its outline and its holes.
    """
    names = [f"parts[{number}]" for number in range(1, len(regions) + 1)]
    corners = np.vstack([loop for loops in regions for loop in loops])
    size = float(np.ptp(corners, axis=0).max())
    faults = [
        f"{names[j]}: overlaps {names[i]}; parts must lie beside each other (a core within a part "
        "with a hole of its size)"
        for i, j in combinations(range(len(regions)), 2)
        if _overlap(regions[i], regions[j], size)
    ]
    if faults:
        return faults
    partition = partition_edges(regions)
    joined, waiting = {0}, set(range(1, len(regions)))
    neighbours = [{int(a), int(b)} for a, b in zip(partition.left, partition.right, strict=True)]
    while adjacent := {n for pair in neighbours if pair & joined for n in pair} & waiting:
        joined |= adjacent
        waiting -= adjacent
    return [
        f"{names[number]}: has no common edge with the other parts; must touch one of them"
        for number in sorted(waiting)
    ]


def _overlap(first: Sequence[Loop], second: Sequence[Loop], size: float) -> bool:
    """True if the interiors of two regions, given by their loops, have points in common.

    `size` is the size of the section, in the unit of the loops.
    """
    partition = partition_edges([first, second])
    starts, ends = (partition.vertices[partition.ends[:, i]] for i in (0, 1))
    if _crossing(starts, ends, TOUCHING * size):
        return True
    ways = ends - starts
    normals = np.column_stack([-ways[:, 1], ways[:, 0]])
    normals *= _BESIDE * size / np.linalg.norm(normals, axis=1)[:, None]
    middles = 0.5 * (starts + ends)
    for number, other in ((0, second), (1, first)):
        for side, sign in ((partition.left, 1.0), (partition.right, -1.0)):
            inside = middles[side == number] + sign * normals[side == number]
            if any(is_inside(other, point) for point in inside):
                return True
    return False


def _crossing(starts: Array, ends: Array, gap: float) -> bool:
    """True if two of e edges from `starts` to `ends` (e×2) cross.

    The ends of both edges must be more than `gap` away from the line of the other edge.
    """
    ways = ends - starts

    def sides(points: Array) -> Array:
        """Signed distances (e×e) of e points (columns) from the lines of all edges (rows).

        They are positive to the left of an edge.
        """
        away = points[None] - starts[:, None]
        cross = ways[:, None, 0] * away[..., 1] - ways[:, None, 1] * away[..., 0]
        return np.asarray(cross / np.linalg.norm(ways, axis=1)[:, None])

    of_starts, of_ends = sides(starts), sides(ends)
    crosses = (np.minimum(np.abs(of_starts), np.abs(of_ends)) > gap) & (of_starts * of_ends < 0.0)
    return bool((crosses & crosses.T).any())
