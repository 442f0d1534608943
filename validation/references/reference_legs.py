"""Legs as their robot's reference has them, and the springs by which causes are told apart."""

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

# Unknowns of the finest section mesh of a solid leg; the second number where the first one does not
# allow two meshes of its walls.
UNKNOWNS: dict[Preset, tuple[int, int]] = {
    "quick": (900, 2500),
    "standard": (900, 2500),
    "fine": (2000, 5000),
}
# Edges of held faces and inward corners of sections have singular stresses: no energy converges
# more slowly than with this power of the mesh size (M. L. Williams, J. Appl. Mech. 19 (1952) 526).
SLOWEST_ORDER = 4.0 / 3.0
# The same section constants serve all that is not a mesh study.
SECTION_DIVISIONS = 8
# How much finer those are than the one mesh that both solids of a leg share.
SECTION_RATIO = SECTION_DIVISIONS / COARSEST_WALLS


def slowest(ratio: float) -> MeshPolicy:
    """Policy for two meshes of legs or sections: the lowest order that there can be."""
    return MeshPolicy.of_order(ratio, SLOWEST_ORDER)


def solid_leg(context: Context, leg: ConstantLeg) -> TwoMeshes:
    """Tip compliances of a leg as a solid on two meshes, once per run and process.

    Raises InputError where even one section mesh has too many unknowns, with the larger preset that
    takes it, and for a section without a shape.
    """
    if shapeless := why_shapeless([leg]):
        raise InputError(shapeless)
    most = most_unknowns(context.meshes, leg)
    try:
        return context.get(two_meshes, leg, most)
    except InputError as error:
        if has_meshes(leg, most):
            raise
        takes = larger_preset(context.meshes, lambda one: has_meshes(leg, most_unknowns(one, leg)))
        raise InputError(f"{error}; {takes} takes it") from error


def finer_statics(context: Context, legs: Iterable[Leg]) -> str:
    """What would make solids of these legs finer: a larger preset, or nothing."""
    solids = [leg for leg in legs if isinstance(leg, ConstantLeg)]

    def finer(preset: Preset) -> bool:
        now = [mesh_pair(leg, most_unknowns(context.meshes, leg)) for leg in solids]
        return [mesh_pair(leg, most_unknowns(preset, leg)) for leg in solids] != now

    return finer_by(larger_preset(context.meshes, finer))


def shares_section(context: Context, leg: Leg) -> bool:
    """Whether both solids of a leg have one section mesh, the only one that is affordable."""
    if not isinstance(leg, ConstantLeg):
        return False
    return not context.get(static_ladder, leg, most_unknowns(context.meshes, leg))


def most_unknowns(preset: Preset, leg: ConstantLeg) -> int:
    """Unknowns of the finest section mesh: more where few do not allow two meshes."""
    first, second = UNKNOWNS[preset]
    return first if static_ladder(leg, first) else second


def solid_tip(context: Context, leg: Leg, ends: Ends, *, mesh: Literal[0, 1] = 1) -> Array:
    """6×6 tip compliance (SI, leg axes) of a solid leg on one of its meshes; a given one's own."""
    if isinstance(leg, GivenLeg):
        return given_compliance(leg)
    meshes = solid_leg(context, leg)
    return (meshes.fine if mesh else meshes.coarse)[ends]


def straight_spring(leg: Leg) -> Array:
    """The entries of a tip compliance that a straight leg of constant section has."""
    tip = given_compliance(leg)
    kept = np.eye(6)
    kept[1, 5] = kept[5, 1] = kept[2, 4] = kept[4, 2] = 1.0
    return np.asarray(tip * kept)


def own_spring(context: Context, leg: Leg, divisions: int = SECTION_DIVISIONS) -> Array:
    """Tip compliance of a leg with its section's own constants; a given leg's 6×6."""
    if isinstance(leg, GivenLeg):
        return leg.compliance
    constants = context.get(own_constants, leg, divisions)
    return tip_compliance(beam_properties(constants, leg.material), leg.length)


def held_spring(context: Context, leg: Leg, ends: Ends) -> Array:
    """The own spring; if ends are held, with the twist by non-uniform torsion."""
    spring = own_spring(context, leg)
    if isinstance(leg, ConstantLeg) and ends == "rigid":
        constants = context.get(own_constants, leg)
        beam = beam_properties(constants, leg.material)
        # Motion of the tip's centroid as the tip turns about its shear centre.
        turned = np.array([0.0, beam.centre_z, -beam.centre_y, 1.0, 0.0, 0.0])
        held = held_torsion_compliance(constants, leg.material, leg.length)
        spring = spring + (held - leg.length / beam.GJ) * np.outer(turned, turned)
    return spring


def restrained_spring(context: Context, leg: Leg, ends: Ends) -> Array:
    """The own spring, less all that rigid faces take where ends are held."""
    spring = own_spring(context, leg)
    if isinstance(leg, ConstantLeg) and ends == "rigid":
        spring = spring + solid_leg(context, leg).restrained
    return spring


def own_elements(
    leg: Leg, ends: Ends | None, elements: int, divisions: int = SECTION_DIVISIONS
) -> LegMatrices:
    """A leg in beam elements of its section's own constants; with warping where `ends` hold it."""
    constant = equivalent_leg(leg)
    constants, material = own_constants(constant, divisions), constant.material
    if ends is None:
        return beam_leg(beam_properties(constants, material), constant.length, elements)
    return warping_beam_leg(constants, material, constant.length, elements, ends)


def own_constants(leg: ConstantLeg, divisions: int = SECTION_DIVISIONS) -> SectionConstants:
    """Constants of a leg's section from finite elements, without thin-wall assumptions."""
    with naming(leg.name):
        return leg_constants(leg, divisions)
