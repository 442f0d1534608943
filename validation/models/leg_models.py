"""Matrices, tip compliance and natural frequencies of one leg by each model.

Input: a leg (prism, stepped leg or 6×6 compliance) and the options of the model. Output: stiffness
and mass matrices in leg axes, 6×6 tip compliance, or frequencies in Hz. Legs of equal shape share
one stored result.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from typing import NamedTuple, TypeVar

import numpy as np

from fem.beams.beam import beam_leg
from fem.beams.line_beam import line_beam
from fem.beams.stepped import Piece, SteppedLeg, stepped_leg
from fem.bodies import solid
from fem.bodies.rooted import RootedBody
from fem.reduction.craig_bampton import craig_bampton
from fem.reduction.free_modes import free_modes
from fem.reduction.superelement import HeldLeg, held_leg, static_superelement
from lumped.arrays import Array, dense
from lumped.beam_properties import BeamProperties
from lumped.equivalent_leg import equivalent_leg, sectioned_leg
from lumped.errors import InputError
from lumped.legs import (
    ConstantLeg,
    Leg,
    LineLeg,
    SectionedLeg,
    given_compliance,
)
from lumped.mechanism.body_model import BodyModel, LegMatrices
from lumped.memo import memo
from lumped.model_choices import Ends
from lumped.models.bodies import (
    clamped_modes,
    free_frequencies,
    legs_of,
    tip_compliance_of,
)
from lumped.models.segments import (
    SegmentChain,
    line_segment_chain,
    segment_chain,
    segment_leg,
    static_leg,
    with_printed_tip_joint,
)
from validation.context import Context
from validation.models.options import DEFAULT_OPTIONS, STATIC, ModelName, ModelOptions
from validation.responses.mode_pairing import centreline_samples
from validation.responses.statics_and_modes import PathModes
from validation.solids.solid_legs import held_solid

# Number of sections at which mode shapes of a single solid leg are sampled.
_STATIONS = 24
Model = TypeVar("Model", bound=BodyModel)


# Number of stored results: enough for all legs of the family of robots with longer legs. Each takes
# a hundred kilobytes.
@memo(256)
def leg_matrices(
    model: ModelName, leg: SectionedLeg | SteppedLeg, options: ModelOptions = DEFAULT_OPTIONS
) -> LegMatrices:
    """Stiffness and mass matrix of one unsupported leg by a model of `ELEMENTS`.

    In a stepped leg, all pieces together have `options.elements` elements. Raises InputError for
    any other model.
    """
    if model not in ELEMENTS:
        allowed = " or ".join(f'"{name}"' for name in ELEMENTS)
        raise InputError(
            f"model {model}: has no leg matrices that are valid for all frequencies; "
            f"must be {allowed}"
        )
    if isinstance(leg, SteppedLeg):
        return stepped_leg(leg, partial(_piece, model, options, len(leg.pieces)))
    return ELEMENTS[model].leg(leg, options)


def _piece(model: ModelName, options: ModelOptions, count: int, piece: Piece) -> LegMatrices:
    properties = piece.properties
    if options.theory == "euler-bernoulli":
        properties = properties.as_euler_bernoulli()
    elements = max(1, round(options.elements / count))
    return ELEMENTS[model].piece(properties, piece.length, replace(options, elements=elements))


def _segment_leg(leg: SectionedLeg, options: ModelOptions) -> LegMatrices:
    return segment_leg(leg_chain(leg, options))


def _segment_piece(properties: BeamProperties, length: float, options: ModelOptions) -> LegMatrices:
    return segment_leg(segment_chain(properties, length, options.elements, options.layout))


def _beam_leg(leg: SectionedLeg, options: ModelOptions) -> LegMatrices:
    if isinstance(leg, LineLeg):
        return line_beam(leg.sections(options.theory), options.elements)
    return beam_leg(leg.properties(options.theory), leg.length, options.elements)


def _beam_piece(properties: BeamProperties, length: float, options: ModelOptions) -> LegMatrices:
    return beam_leg(properties, length, options.elements)


class ElementMatrices(NamedTuple):
    """Functions that return stiffness and mass matrix of an unsupported leg by one model.

    Both divide the leg into `options.elements`. `leg`: from a leg with a section, and its options.
    `piece`: from section properties and a length (m), for a prismatic piece of a stepped leg.
    """

    leg: Callable[[SectionedLeg, ModelOptions], LegMatrices]
    piece: Callable[[BeamProperties, float, ModelOptions], LegMatrices]


# Matrices of each model of `OF_ELEMENTS`.
ELEMENTS: Mapping[ModelName, ElementMatrices] = {
    "segments": ElementMatrices(_segment_leg, _segment_piece),
    "beam": ElementMatrices(_beam_leg, _beam_piece),
}


def filled(model: Model) -> Model:
    """Copy of a model with dense instead of sparse matrices, for reduced models.

    Their matrices are small and have hardly any zeros.
    """
    parts = {kind: dense(part) for kind, part in model.parts.items()}
    return replace(model, stiffness=dense(model.stiffness), mass=dense(model.mass), parts=parts)


def leg_chain(leg: SectionedLeg, options: ModelOptions) -> SegmentChain:
    """Chain of rigid segments joined by springs.

    If `options.release` is "printed", the last spring includes the joint at the tip.
    """
    if isinstance(leg, LineLeg):
        chain = line_segment_chain(leg.sections(options.theory), options.elements, options.layout)
    else:
        properties = leg.properties(options.theory)
        chain = segment_chain(properties, leg.length, options.elements, options.layout)
    return with_printed_tip_joint(chain) if options.release == "printed" else chain


@memo(64)
def condensed_leg(
    model: ModelName, leg: SectionedLeg | SteppedLeg, options: ModelOptions
) -> LegMatrices:
    """Leg by `segments`, `beam` or `solid`, condensed to the twists of its ends.

    The result is exact in statics.
    """
    if model == "segments" and not isinstance(leg, SteppedLeg):
        return static_leg(leg_chain(leg, options))
    return static_superelement(leg_with_held_ends(model, leg, options)).matrices


@memo(32)
def reduced_leg(
    model: ModelName,
    leg: SectionedLeg | SteppedLeg,
    options: ModelOptions,
    highest: float,
    cutoff: float,
) -> LegMatrices:
    """Leg reduced to the twists of its ends and its modes with fixed ends below `cutoff` (Hz).

    It is accurate for frequencies of the robot up to `highest` (Hz). The end faces of a solid are
    rigid or free, by `options.ends`.
    """
    return craig_bampton(leg_with_held_ends(model, leg, options), highest, cutoff).matrices


def leg_with_held_ends(
    model: ModelName, leg: SectionedLeg | SteppedLeg, options: ModelOptions
) -> HeldLeg:
    """Leg by `segments`, `beam` or `solid`, prepared for a reduction to the twists of its ends."""
    if model == "solid" and not isinstance(leg, SteppedLeg):
        return _held_solid(leg, options.divisions, options.ends)
    return held_leg(leg_matrices(model, leg, options))


# Factorised matrices of two solid legs fit into the memory of small machines. The key contains only
# the options that affect solids, so that statics and modes share a factor.
@memo(2)
def _held_solid(leg: SectionedLeg, divisions: int, ends: Ends) -> HeldLeg:
    return held_solid(leg, divisions, ends)


@memo(4)
def clamped_solid(leg: SectionedLeg, divisions: int, ends: Ends) -> RootedBody:
    """Leg as a solid with its root clamped, factorised once for statics and modes.

    `divisions` is the number of elements across the section.
    """
    return solid.clamped_leg(solid.solid_leg(leg, solid.solid_mesh(leg, divisions)), ends)


def leg_compliance(model: ModelName, leg: Leg, options: ModelOptions = DEFAULT_OPTIONS) -> Array:
    """6×6 tip compliance (SI, leg axes) of one leg with its root clamped.

    Raises InputError for `simplified`, whose legs are rigid.
    """
    if model == "simplified":
        raise InputError(
            "--leg: not for model simplified, whose legs are rigid; choose another --model"
        )
    if model in STATIC:
        if options.legs == "equivalent":
            leg = equivalent_leg(leg, options.equivalent)
        return given_compliance(leg, options.theory)
    sectioned = sectioned_leg(leg, options.equivalent)
    if model == "solid":
        return clamped_solid(sectioned, options.divisions, options.ends).compliance
    return tip_compliance_of(leg_matrices(model, sectioned, options))


def leg_frequencies(
    model: ModelName,
    leg: Leg,
    count: int,
    options: ModelOptions = DEFAULT_OPTIONS,
    *,
    free: bool = False,
) -> Array:
    """First natural frequencies (Hz, ascending) of one leg. Arguments as in `leg_modes`."""
    return np.asarray(leg_modes(model, leg, count, options, free=free).frequencies[0])


def leg_modes(
    model: ModelName, leg: Leg, count: int, options: ModelOptions, *, free: bool
) -> PathModes:
    """First natural modes of one leg with its root clamped or, if `free`, without supports.

    `count` is the number of modes. The six rigid-body motions of an unsupported leg are omitted.
    Mode shapes of solids are sampled as twists of sections; other models have no samples. For free
    solids, Sylvester's law of inertia proves that neither a mode nor a rigid-body motion is
    missing. Raises InputError for `simplified` (rigid legs), `vjm` and `links` (static), and
    ComputationError if a free leg does not have six rigid-body motions.
    """
    if model == "simplified" or model in STATIC:
        raise InputError(
            f"--modes: model {model} of one leg is static and has no frequencies; leave --modes out"
        )
    sectioned = sectioned_leg(leg, options.equivalent)
    if model != "solid":
        matrices = leg_matrices(model, sectioned, options)
        if free:
            return PathModes.unsampled(free_frequencies(matrices, count)[None])
        return PathModes.unsampled(clamped_modes(matrices, count).frequencies[None])
    rooted = clamped_solid(sectioned, options.divisions, "free" if free else options.ends)
    modes = free_modes(rooted, count) if free else rooted.modes(count)
    mesh = solid.solid_mesh(sectioned, options.divisions)
    stations, lengths = centreline_samples(mesh.length, _STATIONS)
    samples = solid.section_twists(mesh, stations) @ modes.shapes
    # Modes on two meshes have nearly the same shapes. Any weights of the rotations therefore pair
    # them.
    arm = mesh.length / _STATIONS
    weights = np.outer(lengths, np.repeat([1.0, arm**2], 3)).ravel()
    return PathModes(modes.frequencies[None], samples[None], weights, np.ones((1, count)))


def constant_leg_of(context: Context, body: str) -> ConstantLeg:
    """Leg `body` of the run's robot as a prism of constant section.

    A leg specified by its 6×6 compliance is replaced by its equivalent prism.
    """
    return context.get(equivalent_leg, legs_of(context.robot_file.mechanism)[body])
