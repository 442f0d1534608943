"""A mechanism over its path: its models against each other where theory says they are one.

Each comparison holds one piece of code against another: closed joints read off the frames, drives
against the motion of the tool, chains of virtual joints against the assembler, beams against
links, solids against beams of their own constants, reduced bodies against whole ones.
"""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from fem.beams.stepped import SteppedLeg
from fem.bodies import doubling
from fem.couplings.end_effects import restrained_compliance
from fem.reduction.craig_bampton import craig_bampton
from fem.sections.section_constants import beam_properties, section_constants
from lumped.arrays import Array
from lumped.errors import InputError
from lumped.legs import ConstantLeg, Ends, tip_compliance
from lumped.mechanism.body_model import LegMatrices
from lumped.mechanism.free_twists import free_twists, interface_position
from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.kinematics.postures import posture
from lumped.mechanism.mechanism import Posture
from lumped.models import vjm
from lumped.models.bodies import link, tip_compliances
from lumped.models.serial_chains import serial_chains
from lumped.system.assembly import System, assembly
from lumped.system.solution import modes, rounding, rounding_of_frequencies, solved
from validation.adequacy.mechanism.legs import solid_leg
from validation.adequacy.mechanism.parts import assembled
from validation.adequacy.mechanism.path import known_legs, path_postures, why_not_serial
from validation.adequacy.mechanism.statics import compliances
from validation.agreement.convergence import step_factor
from validation.case import Absolute, Measurement, Relative, Sides, Skip
from validation.case_group import CaseGroup, numbered
from validation.cases.mechanism.quantities import ASSEMBLER, MODEL_CODE, farthest_entry
from validation.context import Context
from validation.exhibits import PATH
from validation.models.legs import filled, leg_matrices, reduced_leg
from validation.models.mechanism import (
    CUTOFF,
    JUDGED_MODES,
    answers,
    bodies_of,
    constant_legs,
    highest_frequency,
    static_bodies,
)
from validation.models.options import ModelName, ModelOptions
from validation.models.part_legs import part_springs
from validation.solids.legs import FORMAL_ORDER, SHARED_SOLIDS, TipCompliances

_EULER = ModelOptions(theory="euler-bernoulli", legs="equivalent")
_TIMOSHENKO = ModelOptions(legs="equivalent")
_STATICS = "entry of the 6×6 that differs most over the path, in units of √(c_ii c_jj)"
_ONE_STATICS = (
    "Frames of prismatic members are exact in statics at their nodes, whatever the number of "
    "elements: J. S. Przemieniecki, Theory of Matrix Structural Analysis (1968), ch. 5"
)
_ROUNDING = (
    "one statics, assembled in two ways: rounding, grown by the condition of slender legs, 7e-11 "
    "and less of a hundred robots at random"
)
# What a comparison says whose uncertainties are those of rounding alone.
BEYOND_ROUNDING = (
    "double precision leaves so much open where stiffnesses differ widely or legs nearly align, "
    "and no finer model narrows it"
)
_FEW_ELEMENTS = 8
_SOLID = (doubling.condensed_leg, doubling.tip_compliance)
_OWN_BEAM = (section_constants, beam_properties, tip_compliance)
_SECOND_ORDER = 2.0

cases = CaseGroup(
    unit="1",
    reference_kind="independent-solver",
    section=PATH,
    group="mechanism.lumped",
    effort=1.0,
)


@cases.case(
    "mechanism.closure",
    "Every joint is closed in every pose",
    quantity="largest gap of a joint over the path, of the size of the mechanism",
    citation="positions of both sides, read off the bodies' frames",
    tolerance=Absolute(1e-12),
    tolerance_reason="the loops are closed until rounding is left",
    sides=Sides((posture,), (interface_position, free_twists)),
)
def _closure(context: Context) -> Measurement:
    postures = path_postures(context)
    size = context.robot_file.mechanism.size
    return Measurement(max(_gap(at) for at in postures) / size, 0.0, exact=True)


def _gap(at: Posture) -> float:
    """Largest distance (m) between both sides of a joint, along what it does not free."""
    gaps = []
    for joint in at.mechanism.joints:
        apart = interface_position(at, joint.second) - interface_position(at, joint.first)
        slides = free_twists(at, joint)[:3]
        free = slides[:, np.any(slides, axis=0)]
        basis = np.linalg.qr(free)[0]
        gaps.append(float(np.linalg.norm(apart - basis @ (basis.T @ apart))))
    return max(gaps)


@cases.case(
    "mechanism.idle",
    "The assembler leaves as many motions idle as the closed loops do",
    quantity="idle motions, in the pose where the two differ most",
    citation="null space of the joints' constraints on rigid bodies",
    tolerance=Absolute(0.5),
    tolerance_reason="a count is a whole number",
    model="beam",
    sides=Sides((*ASSEMBLER, *MODEL_CODE["beam"]), (mobility,)),
)
def _idle(context: Context) -> Measurement:
    postures = path_postures(context)
    mechanism = postures[0].mechanism
    beams = {
        name: filled(leg_matrices("beam", leg, own))
        for name, leg, own in constant_legs(mechanism, ModelOptions(elements=1))
    }
    prepared = assembly(mechanism, beams)
    counts = [(solved(prepared.at(at)).idle, mobility(at).idle) for at in postures]
    found, expected = max(counts, key=lambda pair: abs(pair[0] - pair[1]))
    return Measurement(float(found), float(expected), exact=True)


of_links = cases.family(
    quantity=_STATICS,
    citation=_ONE_STATICS,
    tolerance=Absolute(1e-9),
    tolerance_reason=_ROUNDING,
    figure="mechanism.deflections",
)


@of_links.case(
    "mechanism.statics.{model}[{options.theory}]",
    "Links and {model} of {options.theory} theory are one statics",
    over={"options": (_EULER, _TIMOSHENKO), "model": ("beam", "segments")},
    # Both are assembled alike: what differs is what stands for a leg.
    sides=lambda model: Sides(MODEL_CODE[model], (link,)),
)
@of_links.case(
    "mechanism.statics.{model}",
    "Virtual joints along serial chains and links are one statics",
    over={"model, options": [("vjm", ModelOptions())]},
    sides=Sides(MODEL_CODE["vjm"], (link, *ASSEMBLER)),
)
def _same_statics(context: Context, model: ModelName, options: ModelOptions) -> Measurement:
    postures = path_postures(context)
    if model == "vjm" and (branches := why_not_serial(postures)):
        raise Skip(branches)
    found, expected = (context.get(compliances, postures, one, options) for one in (model, "links"))
    of_model, of_links = (
        context.get(path_roundings, postures, one, options) for one in (model, "links")
    )
    value, reference, uncertainty = farthest_entry(found, expected, np.hypot(of_model, of_links))
    return Measurement(value, reference, value_uncertainty=uncertainty, decides=BEYOND_ROUNDING)


def path_roundings(postures: tuple[Posture, ...], model: ModelName, options: ModelOptions) -> Array:
    """What rounding leaves open of them (p×6×6, SI; 95 %, of both signs)."""
    mechanism = postures[0].mechanism
    if model == "vjm":
        springs = tip_compliances(mechanism, options.legs, options.theory, options.equivalent)
        springs |= part_springs(mechanism, options)
        return np.array([vjm.rounding(serial_chains(at, springs)[0]) for at in postures])
    prepared = assembly(mechanism, static_bodies(model, mechanism, options))
    systems = [prepared.at(posture) for posture in postures]
    return np.array([rounding(one, solved(one).displacements(one.tool.T)) for one in systems])


_of_solids = cases.family(
    quantity="largest relative difference of the six diagonal compliances over the path",
    group=SHARED_SOLIDS,
    model="solid",
    figure="mechanism.deflections",
)


@_of_solids.case(
    "mechanism.statics.solid-held",
    "Solids with rigid ends are those beams less what held faces take from them",
    over={"ends": ("rigid",)},
    citation="Saint-Venant's end effects on the same mesh of the section, exact along the legs "
    "(fem.couplings.end_effects)",
    tolerance=Absolute(1e-4),
    tolerance_reason="no cause is left: thin slices of the legs alone, 6e-5 and less",
    sides=Sides(_SOLID, (*_OWN_BEAM, restrained_compliance)),
)
@_of_solids.case(
    "mechanism.statics.solid",
    "Solids with free ends are Timoshenko beams of the sections' own constants",
    over={"ends": ("free",)},
    citation="Clapeyron's theorem on Saint-Venant's exact solution, constants of the same mesh",
    tolerance=Absolute(3e-5),
    tolerance_reason="no cause is left: the mesh alone, which both have, 6e-7 and less; a second "
    "mesh leaves up to 1.4e-5 open",
    effort=10.0,
    sides=Sides(_SOLID, _OWN_BEAM),
)
def _solid(context: Context, ends: Ends) -> Measurement:
    postures = path_postures(context)
    legs = known_legs(postures[0].mechanism)
    if not legs:
        raise Skip("no leg is a prism")
    if not all(isinstance(leg, ConstantLeg) for leg in legs.values()):
        raise Skip("legs known by a 6×6 have no section that could be meshed")
    prisms = {name: leg for name, leg in legs.items() if isinstance(leg, ConstantLeg)}
    try:
        meshes = {name: solid_leg(context, leg) for name, leg in prisms.items()}
    except InputError as error:
        raise Skip(str(error)) from error
    coarse, fine = (
        _off_beams(postures, {name: getattr(both, which) for name, both in meshes.items()}, ends)
        for which in ("coarse", "fine")
    )
    ratio = min(both.ratio for both in meshes.values())
    worst = np.unravel_index(np.argmax(np.abs(fine)), fine.shape)
    step = abs(fine[worst] - coarse[worst])
    return Measurement(
        float(abs(fine[worst])),
        0.0,
        value_uncertainty=float(step_factor(ratio, FORMAL_ORDER) * step),
    )


def _off_beams(
    postures: Sequence[Posture], legs: Mapping[str, TipCompliances], ends: Ends
) -> Array:
    """Relative difference of the diagonal compliances (p×6) by solids from beams of such ends."""
    solids, beams = (
        np.diagonal(assembled(postures, springs), axis1=1, axis2=2)
        for springs in (
            {name: one.free if ends == "free" else one.rigid for name, one in legs.items()},
            {name: one.own if ends == "free" else one.held for name, one in legs.items()},
        )
    )
    return np.asarray(solids / beams - 1.0)


@cases.case(
    "mechanism.frequency.segments[{mode}]",
    "Frequency {mode} in segments is that of beams, middle of the path",
    over={"index, mode": numbered(JUDGED_MODES)},
    quantity="natural frequency {mode}",
    unit="Hz",
    citation="Timoshenko beam elements of the same constants, fourth order",
    tolerance=Relative(0.01),
    tolerance_reason="springs between rigid segments are second order in 1/n: what doubling their "
    "number changes is the uncertainty",
    model="segments",
    sides=Sides(MODEL_CODE["segments"], MODEL_CODE["beam"]),
    effort=0.1,
    figure="mechanism.frequencies",
)
def _frequency(context: Context, index: int) -> Measurement:
    postures = path_postures(context)
    middle = (postures[len(postures) // 2],)
    coarse, fine, beam = (
        float(one.frequencies[index])
        for model, elements in _REFINED
        for one in context.get(
            answers, model, middle, JUDGED_MODES, ModelOptions(elements=elements)
        )
    )
    uncertainty = step_factor(2.0, _SECOND_ORDER) * abs(fine - coarse)
    return Measurement(fine, beam, value_uncertainty=uncertainty)


_REFINED: tuple[tuple[ModelName, int], ...] = (("segments", 20), ("segments", 40), ("beam", 20))


@cases.case(
    "mechanism.reduction",
    "Bodies reduced by Craig and Bampton have the frequencies of the whole mechanism",
    quantity=f"largest relative difference of the first {JUDGED_MODES} frequencies, middle of the "
    "path",
    citation="the same beams without reduction, dense",
    tolerance=Absolute(5e-6),
    tolerance_reason="modes of the bodies up to four times the highest frequency leave 3e-8 of "
    "built-in robots, 2e-6 where legs are as thick as they are long",
    model="beam",
    sides=Sides((craig_bampton,), MODEL_CODE["beam"]),
)
def _reduction(context: Context) -> Measurement:
    postures = path_postures(context)
    middle = postures[len(postures) // 2]
    options = ModelOptions(elements=_FEW_ELEMENTS)
    whole = bodies_of(middle.mechanism, options, partial(leg_matrices, "beam"))
    highest = highest_frequency([middle], JUDGED_MODES, options)

    def reduce(leg: ConstantLeg | SteppedLeg, own: ModelOptions) -> LegMatrices:
        return reduced_leg("beam", leg, own, highest, CUTOFF["beam"] * highest)

    reduced = bodies_of(middle.mechanism, options, reduce)
    found, expected = (
        _with_rounding(assembly(middle.mechanism, bodies).at(middle)) for bodies in (reduced, whole)
    )
    apart = found[0] / expected[0] - 1.0
    mode = int(np.argmax(np.abs(apart)))
    return Measurement(
        float(abs(apart[mode])),
        0.0,
        value_uncertainty=float(found[1][mode] / expected[0][mode]),
        reference_uncertainty=float(expected[1][mode] / expected[0][mode]),
        decides=BEYOND_ROUNDING,
        notes=(f"mode {mode + 1}",),
    )


def _with_rounding(system: System) -> tuple[Array, Array]:
    """The first frequencies (Hz), and what rounding leaves open of them."""
    shapes = modes(solved(system), JUDGED_MODES)
    return shapes.frequencies, rounding_of_frequencies(system, shapes)
