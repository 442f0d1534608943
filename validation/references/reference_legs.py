"""Solid legs of a robot's reference, and tip compliances of the models between beam and solid.

Input: a leg and the preset of the run. Output: its 6×6 compliance at the tip with the root clamped
(SI, leg axes) as a solid on two meshes, and by a sequence of beams with computed section constants:
with free warping, with restrained warping at the ends, and with restrained warping and contraction
at the ends. The preset limits the unknowns of a section mesh.
"""

from collections.abc import Iterable
from math import ceil
from typing import Literal, get_args

import numpy as np

from fem.beams.beam import beam_leg, warping_beam_leg
from fem.beams.line_beam import line_beam
from fem.sections.inertial_distortion import distortion_flexibility
from fem.sections.nonuniform_torsion import held_torsion_compliance
from lumped.arrays import Array
from lumped.beam_properties import tip_compliance
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError, naming
from lumped.legs import ConstantLeg, GivenLeg, Leg, LineLeg, SectionedLeg, given_compliance
from lumped.line_sections import LineSections
from lumped.mechanism.body_model import LegMatrices
from lumped.memo import memo
from lumped.model_choices import Ends
from lumped.sections import Composite, Laminate, Rectangle
from meshes.loft import leg_sections, solid_section
from meshes.section.section_mesh import SectionMesh, section_mesh
from validation.context import Context, Preset
from validation.models.leg_models import clamped_solid
from validation.references.reference import finer_by
from validation.solids.leg_meshes import (
    COARSEST_WALLS,
    DIVISIONS,
    WALL_DIVISIONS,
    has_meshes,
    line_order,
    mesh_pair,
    section_of,
    static_divisions,
)
from validation.solids.solid_legs import TwoMeshes, computed_properties, computed_rod, two_meshes
from validation.solids.solid_size import larger_preset, too_large, why_shapeless
from validation.uncertainty.half_widths import MeshPolicy

# Largest number of unknowns in the section mesh of a solid leg. The second number applies if the
# first does not allow two meshes of the section's walls.
UNKNOWNS: dict[Preset, tuple[int, int]] = {
    "quick": (900, 2500),
    "standard": (900, 2500),
    "fine": (2000, 5000),
}
# Slowest possible convergence of prisms, tapers and arcs: stresses are singular at edges of rigid
# end faces and at inward corners of sections. No energy converges more slowly than with this power
# of the element size (M. L. Williams, J. Appl. Mech. 19 (1952) 526).
SLOWEST_ORDER = 4.0 / 3.0
# Elements across a wall or side for the section constants of all computations other than mesh
# studies.
SECTION_DIVISIONS = 8
# Element size of the mesh for section constants over that of the solids' section mesh. Below one,
# since half-widths are needed on the solids' mesh, which is the coarser one.
SECTION_RATIO = COARSEST_WALLS / SECTION_DIVISIONS


def slowest(ratio: float, legs: Iterable[SectionedLeg] = ()) -> MeshPolicy:
    """Mesh policy for two meshes of `legs` with this `ratio` of element sizes.

    The order is `SLOWEST_ORDER`, or the lower one at corners of the legs' lines.
    """
    orders = [line_order(leg) for leg in legs]
    return MeshPolicy.of_order(ratio, min([SLOWEST_ORDER, *orders]))


def solid_leg(context: Context, leg: SectionedLeg) -> TwoMeshes:
    """Tip compliances of a leg as a solid on two meshes, computed once per run and process.

    Raises InputError if the section has no outline, if even the coarsest section mesh exceeds the
    limit of unknowns, or if the preset does not allow the fine solid of a leg of varying section.
    If the limit or the preset is the reason, the message names the larger preset that allows the
    meshes.
    """
    if shapeless := why_shapeless([leg]):
        raise InputError(shapeless)
    if isinstance(leg, LineLeg):
        divisions = line_divisions(context.meshes, leg)
        if divisions[1] > _usual_divisions(context.meshes, leg)[1]:
            require_line_solid(context.meshes, leg)
        return context.get(line_meshes, leg, *divisions)
    limit = most_unknowns(context.meshes, leg)
    try:
        return context.get(two_meshes, leg, limit)
    except InputError as error:
        if has_meshes(leg, limit):
            raise
        larger = larger_preset(
            context.meshes, lambda preset: has_meshes(leg, most_unknowns(preset, leg))
        )
        raise InputError(f"{error}; {larger} allows this mesh") from error


def finer_statics(context: Context, legs: Iterable[Leg]) -> str:
    """Instruction to use a larger preset with finer solids of `legs`; a remark if there is none."""
    solids = [leg for leg in legs if isinstance(leg, ConstantLeg)]
    lines = [leg for leg in legs if isinstance(leg, LineLeg)]

    def meshes(preset: Preset) -> list[object]:
        return [
            *(mesh_pair(leg, most_unknowns(preset, leg)) for leg in solids),
            *(line_divisions(preset, leg) for leg in lines),
        ]

    def finer(preset: Preset) -> bool:
        return meshes(preset) != meshes(context.meshes)

    return finer_by(larger_preset(context.meshes, finer))


def shares_section(context: Context, leg: Leg) -> bool:
    """True if the coarse and the fine solid of a prism have the same section mesh.

    This is so if a finer section mesh would be too large. False for legs that are not prisms.
    """
    if not isinstance(leg, ConstantLeg):
        return False
    return not context.get(static_divisions, leg, most_unknowns(context.meshes, leg))


def most_unknowns(preset: Preset, leg: ConstantLeg) -> int:
    """Largest number of unknowns that a preset allows in a leg's section mesh.

    It is the first of the two numbers in `UNKNOWNS`, or the second if the first does not allow two
    section meshes.
    """
    first, second = UNKNOWNS[preset]
    return first if static_divisions(leg, first) else second


def line_divisions(preset: Preset, leg: LineLeg) -> tuple[int, int]:
    """Divisions across the section of the coarse and the fine mesh of a leg of varying section.

    The doubling method (`fem.bodies.doubling`), which needs equal slices along the leg, cannot be
    used for a leg of varying section. Polygons that are not divided into blocks, and walls thinner
    than about 1/30 of the section, have the same section mesh for one to four divisions. For these,
    the divisions of the fine mesh are increased from those of the preset until its section mesh
    differs, and the coarse mesh has half as many, rounded up. The ratio of divisions is then at
    most that of element sizes, so that half-widths do not become too small.
    """
    coarse, fine = _usual_divisions(preset, leg)
    section = section_of(leg)

    def differs(divisions: int) -> bool:
        coarse_mesh, mesh = section_mesh(section, coarse), section_mesh(section, divisions)
        return len(mesh.nodes) != len(coarse_mesh.nodes)

    if not section.has_outline or differs(2 * coarse):
        return coarse, fine
    fine = next(filter(differs, range(fine, 2 * fine)), 2 * fine)
    return ceil(fine / 2), fine


def _usual_divisions(preset: Preset, leg: LineLeg) -> tuple[int, int]:
    """Divisions of the coarse and the fine mesh, whether or not the section meshes differ."""
    if isinstance(section_of(leg), Rectangle):
        return DIVISIONS[preset] - 1, DIVISIONS[preset]
    return COARSEST_WALLS // 2, max(COARSEST_WALLS, WALL_DIVISIONS[preset])


def distortion_change(leg: SectionedLeg, divisions: int) -> Array:
    """Change (3×3, s²) of a leg's `distortion_flexibility` from its solid's section mesh.

    It is the change to the mesh for section constants, with `SECTION_DIVISIONS`; `divisions` are
    those of the solid's section mesh. Of a leg of varying section it is the largest change at its
    stations. Zero for rectangles, whose coarse and fine solids have different section meshes, and
    for sections of several materials or fibre layers, which have no such theory.
    """
    if isinstance(section_of(leg), Rectangle | Composite | Laminate):
        return np.zeros((3, 3))
    changes = [
        distortion_flexibility(fine, leg.material) - distortion_flexibility(coarse, leg.material)
        for coarse, fine in zip(
            *(_station_meshes(leg, number) for number in (divisions, SECTION_DIVISIONS)),
            strict=True,
        )
    ]
    return max(changes, key=np.trace)


def _station_meshes(leg: SectionedLeg, divisions: int) -> list[SectionMesh]:
    """Section meshes of a leg's solid at all stations of the leg, or the one of a prism."""
    if isinstance(leg, ConstantLeg):
        return [section_mesh(leg.section, divisions)]
    return [solid_section(leg, section, divisions) for section in leg_sections(leg)]


def require_line_solid(preset: Preset, leg: LineLeg) -> None:
    """Raise InputError if a preset does not allow the fine solid of a leg of varying section.

    The message contains the reason, and the larger preset that allows the solid.
    """

    def reason(candidate: Preset) -> str:
        return too_large([leg], line_divisions(candidate, leg)[1:], candidate)

    if refusal := reason(preset):
        larger = larger_preset(preset, lambda candidate: not reason(candidate))
        raise InputError(f"{refusal}; {larger} allows this solid")


def line_meshes(leg: LineLeg, coarse: int, fine: int) -> TwoMeshes:
    """Tip compliances of a leg of varying section as a solid on a coarse and a fine mesh.

    The change due to rigid end faces is taken from the fine solid, since no theory gives it for
    tapered legs.
    """
    tips = [
        {ends: clamped_solid(leg, divisions, ends).compliance for ends in get_args(Ends)}
        for divisions in (coarse, fine)
    ]
    restrained = tips[1]["rigid"] - tips[1]["free"]
    return TwoMeshes(tips[0], tips[1], restrained, fine / coarse)


def solid_tip(context: Context, leg: Leg, ends: Ends, *, mesh: Literal[0, 1] = 1) -> Array:
    """6×6 tip compliance (SI, leg axes) of a solid leg on the coarse (0) or fine (1) mesh.

    If the leg is given by its compliance, the result is that matrix.
    """
    if isinstance(leg, GivenLeg):
        return given_compliance(leg)
    meshes = solid_leg(context, leg)
    return (meshes.fine if mesh else meshes.coarse)[ends]


def straight_spring(leg: Leg) -> Array:
    """6×6 tip compliance (SI, leg axes) reduced to the entries that a straight prismatic leg has.

    The entries are the diagonal and the couplings of deflection and rotation in both bending
    planes.
    """
    tip = given_compliance(leg)
    mask = np.eye(6)
    mask[1, 5] = mask[5, 1] = mask[2, 4] = mask[4, 2] = 1.0
    return np.asarray(tip * mask)


def computed_spring(context: Context, leg: Leg, divisions: int = SECTION_DIVISIONS) -> Array:
    """6×6 tip compliance (SI, leg axes) of a beam with computed section constants.

    If the leg is given by its compliance, the result is that matrix.
    """
    if isinstance(leg, GivenLeg):
        return leg.compliance
    if isinstance(leg, LineLeg):
        return context.get(computed_sections, leg, divisions).tip_compliance
    return tip_compliance(context.get(computed_properties, leg, divisions), leg.length)


def warping_spring(context: Context, leg: Leg, ends: Ends) -> Array:
    """6×6 tip compliance (SI, leg axes) of a beam with computed constants and restrained warping.

    If the ends are rigid, their warping is restrained and torsion is non-uniform. If the ends are
    free, or if the walls have helical fibres, torsion is that of Saint-Venant.
    """
    spring = computed_spring(context, leg)
    if isinstance(leg, ConstantLeg) and ends == "rigid":
        beam = context.get(computed_properties, leg, SECTION_DIVISIONS)
        if beam.is_helical:
            return spring
        # Motion of the tip's centroid if the tip turns by 1 rad about its shear centre.
        motion = np.array([0.0, beam.centre_z, -beam.centre_y, 1.0, 0.0, 0.0])
        rod = context.get(computed_rod, leg, SECTION_DIVISIONS)
        change = held_torsion_compliance(rod, leg.length) - leg.length / (rod.twist - rod.shear)
        spring = spring + change * np.outer(motion, motion)
    return spring


def restrained_spring(context: Context, leg: Leg, ends: Ends) -> Array:
    """6×6 tip compliance (SI, leg axes) of a beam, reduced by the effect of rigid end faces.

    The effect is due to hindered contraction and shear warping at both ends. It is zero if the ends
    are free.
    """
    spring = computed_spring(context, leg)
    if not isinstance(leg, GivenLeg) and ends == "rigid":
        spring = spring + solid_leg(context, leg).restrained
    return spring


def computed_elements(
    leg: Leg, ends: Ends | None, elements: int, divisions: int = SECTION_DIVISIONS
) -> LegMatrices:
    """Stiffness and mass of a leg of beam elements with computed section constants.

    If `ends` is None, warping is free. Otherwise, warping of a prism is an additional degree of
    freedom, which is fixed at rigid ends. Legs of varying section are always free to warp.
    """
    if isinstance(leg, LineLeg):
        return line_beam(computed_sections(leg, divisions), elements)
    constant = equivalent_leg(leg)
    properties = computed_properties(constant, divisions)
    if ends is None:
        return beam_leg(properties, constant.length, elements)
    rod = computed_rod(constant, divisions)
    return warping_beam_leg(properties, rod, constant.length, elements, ends)


@memo(16)
def computed_sections(leg: LineLeg, divisions: int = SECTION_DIVISIONS) -> LineSections:
    """Sections along a leg of varying section, with constants computed by finite elements."""
    with naming(leg.name):
        return leg.sections_by(lambda prism: computed_properties(prism, divisions))
