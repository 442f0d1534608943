"""Meshes of legs as solids: divisions, slices and known orders of convergence.

Input: a leg of constant section and limits on unknowns. Output: divisions of geometrically similar
meshes, and the lowest order with which results on them converge. Rule: quadratic elements converge
with order 4, except for singular stresses at the edges of rigid faces and at inward corners of
sections, which have lower known orders.
"""

from collections.abc import Callable
from itertools import takewhile
from math import ceil

import numpy as np
import scipy

from fem.sections.moduli import part_materials
from lumped.errors import InputError
from lumped.legs import ConstantLeg, LineLeg, SectionedLeg
from lumped.model_choices import Ends
from lumped.sections import (
    Composite,
    HollowRectangle,
    ISection,
    Laminate,
    LaminateBox,
    OutlinedSection,
    Rectangle,
    Section,
)
from meshes.loft import leg_sections, mesh_section
from meshes.section.section_blocks import Divisions, element_length, side_ratio
from meshes.section.section_mesh import SectionMesh, section_mesh
from validation.context import Preset

# Order for quadratic elements: energies, and with them compliances and frequencies, converge with
# h⁴. Singular stresses at the edges of a rigid face (`edge_order`) and at inward corners converge
# more slowly. The corner's order is that of the shear flow about a right angle, r^(−1/3), λ = 2/3,
# in torsion and flexure of walled sections (G. Strang, G. J. Fix, An Analysis of the Finite Element
# Method, ch. 8).
FORMAL_ORDER = 4.0
CORNER_ORDER = 4.0 / 3.0
# Order for rigid faces at which layers of fibres end, as where several materials meet
# (`corner_order`).
_LAYER_EDGE_ORDER = 1.0
# Divisions of successive meshes. Curved and thin-walled sections keep their proportions only if
# divisions are doubled, from four on.
_RECTANGLE_LADDER = (1, 2, 3, 4, 6, 8, 12)
COARSEST_WALLS = 4
_DOUBLING_LADDER = (COARSEST_WALLS, 8, 16, 32)
# Factor on the number of slices: rigid faces of a box (ν = 0.3) have an error of 0.8 % without it
# and of 6e-5 with it.
_THINNER = 16
# Divisions of rectangles, and of walls, for modes of legs; the next coarser mesh gives the
# numerical uncertainty. Up to four divisions, walls have one element across: half as many divisions
# change only the element length. The error of the section mesh is contained in the section
# constants of the beam, too.
DIVISIONS: dict[Preset, int] = {"quick": 2, "standard": 3, "fine": 4}
WALL_DIVISIONS: dict[Preset, int] = {"quick": 2, "standard": 4, "fine": 8}
# Smallest number of meshes of a study.
_FEWEST_GRIDS = 2


def section_of(leg: SectionedLeg) -> Section:
    """Section from which a leg is meshed.

    It is the section of a prism, or that in the middle of a leg whose section varies. If the leg
    has steps and some of its sections are no solid rectangles, it is the first of these.
    """
    if not isinstance(leg, LineLeg):
        return leg.section
    walled = (section for section in leg_sections(leg) if not isinstance(section, Rectangle))
    return next(walled, mesh_section(leg)) if leg.steps else mesh_section(leg)


def formal_order(leg: SectionedLeg, ends: Ends) -> float:
    """Lowest order with which a leg's compliances and frequencies converge."""
    section = section_of(leg)
    sections = leg_sections(leg) if isinstance(leg, LineLeg) else [section]
    corners = min(line_order(leg), *(corner_order(part) for part in sections))
    if ends == "free":
        return corners
    if isinstance(section, Laminate):
        return _LAYER_EDGE_ORDER
    materials = part_materials(leg) or (leg.material,)
    return min(corners, *(edge_order(material.nu) for material in materials))


def line_order(leg: SectionedLeg) -> float:
    """Lowest order of convergence of energies that corners and steps of a leg cause.

    It is `FORMAL_ORDER` for a leg without them.
    """
    if not isinstance(leg, LineLeg) or not (leg.line.turns or leg.steps):
        return FORMAL_ORDER
    at_steps = [0.5 * np.pi] if leg.steps else []
    return notch_order(np.pi + max([*leg.line.turns.values(), *at_steps]))


def corner_order(section: Section) -> float:
    """Lowest order of convergence of energies that the corners of a section cause.

    It is 2π/α, with the largest inward angle α of the section's corners. For a composite and for a
    box of fibre layers it is taken as 1: where edges of several materials meet, the order is above
    1, except for extreme ratios of moduli.
    """
    if isinstance(section, Composite | LaminateBox):
        return 1.0
    if isinstance(section, OutlinedSection):
        return min(FORMAL_ORDER, 2.0 * np.pi / section.largest_angle)
    return CORNER_ORDER if isinstance(section, HollowRectangle | ISection) else FORMAL_ORDER


def notch_order(angle: float) -> float:
    """Order of convergence 2λ of energies at an inward edge with the `angle` (rad) of material.

    Stresses vary there as r^(λ − 1) with the distance r from the edge. λ is the smallest root of
    sin(λα) = −λ sin α with the angle α between π and 2π (M. L. Williams, J. Appl. Mech. 19 (1952)
    526): 0.545 for 270°, ½ for a crack.
    """

    def misfit(exponent: float) -> float:
        return float(np.sin(exponent * angle) + exponent * np.sin(angle))

    return 2.0 * float(scipy.optimize.brentq(misfit, 0.5, 1.0))


def edge_order(nu: float) -> float:
    """Order of convergence 2 Re λ of energies if a free side meets a rigid face at 90°.

    Stresses vary there as r^(λ − 1) with the distance r from the edge.

    λ is a root of sin²(λπ/2) = (4 (1 − ν)² − λ²)/(3 − 4ν), plane strain (M. L. Williams, J. Appl.
    Mech. 19 (1952) 526): 0.71 for ν = 0.3, 1.04 ± 0.58i for ν = −0.9, where the face restrains
    stretching. With ν = 0 nothing is restrained.
    """
    if nu == 0.0:
        return FORMAL_ORDER

    def misfit(exponent: complex) -> complex:
        free = (4.0 * (1.0 - nu) ** 2 - exponent**2) / (3.0 - 4.0 * nu)
        return complex(np.sin(0.5 * np.pi * exponent) ** 2 - free)

    if nu < 0.0:
        return 2.0 * float(scipy.optimize.newton(misfit, 1.05 + 0.3j).real)
    # λ = 1 is a root as well, that of a uniform stress.
    if misfit(1.0 - 1e-9).real <= 0.0:
        return 2.0
    return 2.0 * float(
        scipy.optimize.brentq(lambda exponent: misfit(exponent).real, 0.25, 1.0 - 1e-9)
    )


def static_divisions(leg: ConstantLeg, most: int) -> tuple[int, ...]:
    """Divisions of successive meshes with at most `most` unknowns per section, for statics.

    () if fewer than two meshes are that small.
    """
    return _ladder(leg, most, lambda _: 1)


def modal_divisions(leg: ConstantLeg, most: int) -> tuple[int, ...]:
    """Divisions of successive solid meshes with at most `most` unknowns, for frequencies.

    () if fewer than two meshes are that small.
    """
    return _ladder(leg, most, lambda divisions: 2 * slices(leg, divisions) + 1)


def _ladder(leg: ConstantLeg, most: int, layers: Callable[[int], int]) -> tuple[int, ...]:
    def affordable(divisions: int) -> bool:
        return 3 * len(face_mesh(leg, divisions).nodes) * layers(divisions) <= most

    steps = _RECTANGLE_LADDER if isinstance(leg.section, Rectangle) else _DOUBLING_LADDER
    meshes = tuple(takewhile(affordable, steps))
    return meshes if len(meshes) >= _FEWEST_GRIDS else ()


def divisions_across(leg: SectionedLeg, rectangle: int, walls: int) -> int:
    """Divisions across the section of a leg.

    These are `rectangle`, across the smaller side, if the section is a rectangle. Otherwise they
    are `walls`, across its walls or rims.
    """
    return rectangle if isinstance(section_of(leg), Rectangle) else walls


def section_counts(leg: ConstantLeg, divisions: int) -> Divisions:
    """Element counts of the section mesh, all inversely proportional to the element size.

    Only geometrically similar meshes show an order. For a rectangle the result has the counts along
    its width and height, both multiples of `divisions`. For any other section it is `divisions`;
    such meshes are similar if divisions are doubled.
    """
    section = leg.section
    if not isinstance(section, Rectangle):
        return divisions
    along = divisions * max(1, round(side_ratio(section)))
    return (divisions, along) if section.width <= section.height else (along, divisions)


def slices(leg: ConstantLeg, divisions: int) -> int:
    """Number of slices along the leg.

    In a leg of rectangular section, slices are as long as the elements are wide. In other sections,
    walls need four or more divisions across their thickness. Elements need not be as short along
    the leg, so slices are four times as long there.
    """
    along = max(2, ceil(leg.length / element_length(leg.section, 1)))
    return divisions * along if isinstance(leg.section, Rectangle) else divisions * along // 4


def static_slices(leg: ConstantLeg, divisions: int) -> int:
    """Number of slices along the leg for the doubling method (`fem.bodies.doubling`).

    The method joins equal pieces in pairs, so its cost grows with the logarithm of the number.
    Slices are so thin that stresses at a rigid face decay over many slices. Only the error of the
    section mesh then remains.
    """
    return _THINNER * slices(leg, divisions)


def face_mesh(leg: ConstantLeg, divisions: int) -> SectionMesh:
    """Section mesh of a leg's solid with this number of divisions."""
    return section_mesh(leg.section, section_counts(leg, divisions))


def doubled_unknowns(leg: ConstantLeg, divisions: int) -> int:
    """Number of unknowns of the mesh that the doubling method condenses to the ends of a leg.

    The method joins equal pieces of the leg in pairs (`fem.bodies.doubling`).
    """
    return 3 * len(face_mesh(leg, divisions).nodes) * (2 * static_slices(leg, divisions) + 1)


def mesh_pair(leg: ConstantLeg, most: int) -> tuple[tuple[int, int], tuple[int, int]]:
    """Divisions across the section and slices along the leg, for a coarse and a fine mesh.

    The two meshes are the finest whose section meshes have at most `most` unknowns. If only one
    section mesh of thin walls is that small, both solids have it, and the coarser solid has half as
    many slices along the leg. The error of the section mesh is then in the section constants of the
    beam as well. Raises InputError if even the coarsest section mesh has more than `most` unknowns.
    """
    meshes = static_divisions(leg, most)
    if meshes:
        coarse, fine = meshes[-2:]
        return (coarse, static_slices(leg, coarse)), (fine, static_slices(leg, fine))
    if (unknowns := _coarsest_unknowns(leg)) > most:
        raise InputError(
            f"the coarsest section mesh of its {leg.section.shape} has {unknowns} "
            f"unknowns; at most {most} are allowed",
            part=leg.name or "leg",
        )
    along = static_slices(leg, COARSEST_WALLS)
    return (COARSEST_WALLS, along), (COARSEST_WALLS, 2 * along)


def has_meshes(leg: ConstantLeg, most: int) -> bool:
    """True if a leg has a `mesh_pair` with at most `most` unknowns per section mesh."""
    return bool(static_divisions(leg, most)) or _coarsest_unknowns(leg) <= most


def _coarsest_unknowns(leg: ConstantLeg) -> int:
    return 3 * len(face_mesh(leg, COARSEST_WALLS).nodes)
