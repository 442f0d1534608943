"""Legs of a robot's reference, and springs of intermediate models that separate causes."""

from collections.abc import Iterable
from typing import Literal

import numpy as np

from fem.beams.beam import beam_leg, warping_beam_leg
from fem.sections.nonuniform_torsion import held_torsion_compliance
from fem.sections.section_constants import SectionConstants, beam_properties
from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.errors import InputError, naming
from lumped.legs import ConstantLeg, Ends, GivenLeg, Leg, given_compliance, tip_compliance
from lumped.mechanism.body_model import LegMatrices
from validation.context import Context, Preset
from validation.references.reference import finer_by
from validation.solids.solid_legs import (
    COARSEST_WALLS,
    TwoMeshes,
    has_meshes,
    leg_constants,
    mesh_pair,
    static_ladder,
    two_meshes,
)
from validation.solids.solid_size import larger_preset, why_shapeless
from validation.uncertainty.mesh_half_widths import MeshPolicy

# Most unknowns of the section mesh of a solid leg. The second number applies if the first one does
# not allow two meshes of its walls.
UNKNOWNS: dict[Preset, tuple[int, int]] = {
    "quick": (900, 2500),
    "standard": (900, 2500),
    "fine": (2000, 5000),
}
# Edges of held faces and inward corners of sections have singular stresses: no energy converges
# more slowly than with this power of the mesh size (M. L. Williams, J. Appl. Mech. 19 (1952) 526).
SLOWEST_ORDER = 4.0 / 3.0
# Divisions for the section constants of all computations other than mesh studies.
SECTION_DIVISIONS = 8
# Size of their elements over that of a mesh that solids have: below one, since the half-width is
# that of the solids, which are on the coarser mesh.
SECTION_RATIO = COARSEST_WALLS / SECTION_DIVISIONS


def slowest(ratio: float) -> MeshPolicy:
    """Policy for two meshes of legs or sections, with the lowest possible order."""
    return MeshPolicy.of_order(ratio, SLOWEST_ORDER)


def solid_leg(context: Context, leg: ConstantLeg) -> TwoMeshes:
    """Tip compliances of a leg as a solid on two meshes, once per run and process.

    Raises InputError if even one section mesh has too many unknowns, with the larger preset that
    allows it, and for a section without a shape.
    """
    if shapeless := why_shapeless([leg]):
        raise InputError(shapeless)
    limit = most_unknowns(context.meshes, leg)
    try:
        return context.get(two_meshes, leg, limit)
    except InputError as error:
        if has_meshes(leg, limit):
            raise
        takes = larger_preset(
            context.meshes, lambda preset: has_meshes(leg, most_unknowns(preset, leg))
        )
        raise InputError(f"{error}; {takes} takes it") from error


def finer_statics(context: Context, legs: Iterable[Leg]) -> str:
    """Instruction for finer solids of these legs: a larger preset, or none."""
    solids = [leg for leg in legs if isinstance(leg, ConstantLeg)]

    def finer(preset: Preset) -> bool:
        present = [mesh_pair(leg, most_unknowns(context.meshes, leg)) for leg in solids]
        return [mesh_pair(leg, most_unknowns(preset, leg)) for leg in solids] != present

    return finer_by(larger_preset(context.meshes, finer))


def shares_section(context: Context, leg: Leg) -> bool:
    """True if both solids of a leg share one section mesh, the only affordable one."""
    if not isinstance(leg, ConstantLeg):
        return False
    return not context.get(static_ladder, leg, most_unknowns(context.meshes, leg))


def most_unknowns(preset: Preset, leg: ConstantLeg) -> int:
    """Most unknowns of a section mesh: more if few do not allow two meshes."""
    first, second = UNKNOWNS[preset]
    return first if static_ladder(leg, first) else second


def solid_tip(context: Context, leg: Leg, ends: Ends, *, mesh: Literal[0, 1] = 1) -> Array:
    """6×6 tip compliance (SI, leg axes) of a solid leg on a mesh, or of a leg given by its 6×6."""
    if isinstance(leg, GivenLeg):
        return given_compliance(leg)
    meshes = solid_leg(context, leg)
    return (meshes.fine if mesh else meshes.coarse)[ends]


def straight_spring(leg: Leg) -> Array:
    """Tip compliance with only the entries that a straight leg of constant section has."""
    tip = given_compliance(leg)
    mask = np.eye(6)
    mask[1, 5] = mask[5, 1] = mask[2, 4] = mask[4, 2] = 1.0
    return np.asarray(tip * mask)


def own_spring(context: Context, leg: Leg, divisions: int = SECTION_DIVISIONS) -> Array:
    """Tip compliance of a leg with its section's own constants; a given leg's 6×6."""
    if isinstance(leg, GivenLeg):
        return leg.compliance
    constants = context.get(own_constants, leg, divisions)
    return tip_compliance(beam_properties(constants, leg.material), leg.length)


def held_spring(context: Context, leg: Leg, ends: Ends) -> Array:
    """Spring of own section constants, with non-uniform torsion if the ends are held."""
    spring = own_spring(context, leg)
    if isinstance(leg, ConstantLeg) and ends == "rigid":
        constants = context.get(own_constants, leg)
        beam = beam_properties(constants, leg.material)
        # Motion of the tip's centroid as the tip turns about its shear centre.
        motion = np.array([0.0, beam.centre_z, -beam.centre_y, 1.0, 0.0, 0.0])
        twist = held_torsion_compliance(constants, leg.material, leg.length)
        spring = spring + (twist - leg.length / beam.GJ) * np.outer(motion, motion)
    return spring


def restrained_spring(context: Context, leg: Leg, ends: Ends) -> Array:
    """Spring of own section constants, less the compliance lost by rigid faces of held ends."""
    spring = own_spring(context, leg)
    if isinstance(leg, ConstantLeg) and ends == "rigid":
        spring = spring + solid_leg(context, leg).restrained
    return spring


def own_elements(
    leg: Leg, ends: Ends | None, elements: int, divisions: int = SECTION_DIVISIONS
) -> LegMatrices:
    """Beam elements of a leg with its section's own constants, with warping if `ends` are given."""
    constant = equivalent_leg(leg)
    constants, material = own_constants(constant, divisions), constant.material
    if ends is None:
        return beam_leg(beam_properties(constants, material), constant.length, elements)
    return warping_beam_leg(constants, material, constant.length, elements, ends)


def own_constants(leg: ConstantLeg, divisions: int = SECTION_DIVISIONS) -> SectionConstants:
    """Constants of a leg's section from finite elements, without thin-wall assumptions."""
    with naming(leg.name):
        return leg_constants(leg, divisions)
