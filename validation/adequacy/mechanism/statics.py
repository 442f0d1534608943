"""Compliances of a robot over its path: what models are held against, and why they are off.

The reference assembles the robot from what its legs are: solids where they are prisms, the 6×6 of
the file where they are given. Causes are told apart by the virtual joint method where legs are
serial chains; it shares no code with the assembler.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TypeAlias

import numpy as np

from lumped.acceptance.quantities import UNIT_LOADS
from lumped.arrays import Array
from lumped.equivalent_leg import equivalent_leg
from lumped.legs import Ends, Leg, given_compliance
from lumped.mechanism.mechanism import Posture
from lumped.models import serial_chains
from validation.adequacy.mechanism.digits import left_by_digits
from validation.adequacy.mechanism.legs import (
    ROUNDING,
    SECTION_DIVISIONS,
    SECTION_RATIO,
    finer_statics,
    held_spring,
    own_spring,
    restrained_spring,
    shares_section,
    solid_leg,
    solid_tip,
    step_uncertainty,
    straight_spring,
)
from validation.adequacy.mechanism.parts import (
    FINER_PARTS,
    PART_STEPS,
    assembled,
    part_answers,
    refinement_share,
    solid_parts,
)
from validation.adequacy.mechanism.path import Holds, RobotOnPath, RobotReading, Springs
from validation.adequacy.response import (
    TIMOSHENKO,
    USE_SOLID,
    Alternative,
    Reference,
    Response,
    Step,
    StepTexts,
    ladders,
    statics_of,
    use,
)
from validation.agreement.displacement import sizes
from validation.agreement.responses import Statics
from validation.case import failure_reason
from validation.models.loads.displacements import (
    by_chains,
    displacements,
    displacements_by,
    masses_of,
)
from validation.models.loads.leg_masses import Inside, plausible_masses
from validation.models.loads.stability import stabilities
from validation.models.mechanism import answers
from validation.models.options import ModelName, ModelOptions, PartLegs
from validation.solids.legs import COARSEST_WALLS

# Compliance (6×6, SI, leg axes) of the tip of a leg with such ends.
Spring: TypeAlias = Callable[[Leg, Ends], Array]

# By how much the weight of solid legs moves the tool otherwise than that of beams of the same mass:
# 0.3 % of legs five times as long as high with held ends (ν = 0.3), a tenth of it with free ones.
_MASS_OF_BEAMS = 5e-3
# A displacement that a load's own softening changes by less is a linear one.
_LINEAR = 1e-3
_BY = {"vjm": "virtual joints with ", "links": "links with "}


def model_statics(postures: Sequence[Posture], model: ModelName, options: ModelOptions) -> Statics:
    """Statics of a model."""
    found = np.array([answer.compliance for answer in answers(model, postures, 0, options)])
    return Statics.of(found, displacements(model, postures, options))


def summed(postures: Sequence[Posture], springs: Springs) -> Statics:
    """Statics by virtual joints along serial chains, every leg by its tip's."""
    found = np.array([serial_chains.compliance(posture, springs) for posture in postures])
    masses = masses_of(postures[0].mechanism)
    return Statics.of(found, displacements_by(by_chains(springs), postures, masses))


def static_reference(robot: RobotOnPath) -> Reference:
    """Solid or given legs, assembled; raises InputError where sections are too fine to mesh."""
    context, parts = robot.context, robot.mechanism.parts
    ratio = min((solid_leg(context, leg).ratio for leg in robot.prisms), default=1.0)
    further = _section_uncertainty(robot) + refinement_share(
        robot.mechanism,
        lambda level: _of_solids(robot, replace(robot.first_reading, part_mesh=level)),
        lambda one, other, fine: sizes(one - other, fine),
    )
    digits = None
    if robot.text:
        digits = context.get(left_by_digits, robot.text, robot.postures)
    linear = _left_by_linearity(robot)
    alternatives = []
    for name, ends in robot.holding.alternatives.items():
        reading = RobotReading(ends)
        fine = _of_solids(robot, reading)
        # Every axis, any force, every load.
        poses, loads, _ = fine.load_displacements.shape
        step = np.full((poses, len(UNIT_LOADS) + loads), ROUNDING)
        if robot.prisms:
            coarse = _of_solids(robot, replace(reading, mesh=0))
            step = step_uncertainty(sizes(coarse - fine, fine), ratio)
            on_mass = [load.acts_on_mass for load in robot.mechanism.loads]
            step[:, len(UNIT_LOADS) :] += _MASS_OF_BEAMS * np.array(on_mass)
        response = Response(fine)
        masses = _left_by_masses(robot, reading, fine)
        alternatives.append(
            Alternative(
                name,
                response,
                static=step + further,
                digits=digits,
                masses=masses,
                linear=linear,
            )
        )
    own = "fem.bodies.doubling.condensed_leg" if robot.prisms else "lumped.legs.given_compliance"
    return Reference(
        title=_title(robot),
        alternatives=alternatives,
        open=robot.holding.unsaid,
        decides=robot.holding.decides,
        masses=robot.say_masses,
        finer=FINER_PARTS if parts else finer_statics(context, robot.legs.values()),
        remedy=None if robot.given else USE_SOLID,
        computed_by=(
            *((own,) if robot.legs else ()),
            *(("validation.models.parts.reduced",) if parts else ()),
            "lumped.system.solution.compliance",
        ),
    )


def _of_solids(robot: RobotOnPath, reading: RobotReading) -> Statics:
    """Statics with solid legs and parts."""
    tips = {
        body: solid_tip(robot.context, leg, reading.ends[body], mesh=reading.mesh)
        for body, leg in robot.legs.items()
    }
    parts = solid_parts(robot.postures, robot.offered, reading.ends, reading.part_mesh)
    return assembled(robot.postures, tips, parts, reading.masses)


def _left_by_masses(robot: RobotOnPath, reading: RobotReading, own: Statics) -> Array | None:
    """What plausible places of the mass of legs known by their 6×6 leave open (p×(7+l), relative).

    The displacement under a load is linear in where the mass is: between these it is any.
    """
    if not robot.given or not any(load.acts_on_mass for load in robot.mechanism.loads):
        return None
    others = plausible_masses(robot.given.values())
    found = (_of_solids(robot, replace(reading, inside=Inside(masses))) for masses in others)
    return np.asarray(np.max([sizes(one - own, own) for one in found], axis=0))


def _left_by_linearity(robot: RobotOnPath) -> Array | None:
    """What loads change of the stiffness that they meet (p×(7+l), relative), where that counts.

    All of it where the robot has buckled, and if the stability cannot be computed.
    """
    if not robot.mechanism.loads:
        return None
    try:
        found = robot.context.get(stabilities, "links", robot.postures)
    except Exception as error:  # noqa: BLE001  loses no model: it leaves their errors open
        failure_reason("stability under loads", error)
        left = np.ones((len(robot.postures), len(robot.mechanism.loads)))
    else:
        farther = np.array([[abs(one.farther) if one else 0.0 for one in row] for row in found])
        left = np.nan_to_num(farther, nan=1.0)
    left[left < _LINEAR] = 0.0
    return np.pad(left, ((0, 0), (len(UNIT_LOADS), 0)))


def _section_uncertainty(robot: RobotOnPath) -> Array | float:
    """What section meshes leave open (p×7, relative) where both solids of a leg share one.

    By constants of that mesh and of one twice as fine; else zero.
    """
    shared = {name for name, leg in robot.legs.items() if shares_section(robot.context, leg)}
    if not shared:
        return 0.0

    def own(divisions: int) -> Statics:
        springs = {
            name: own_spring(robot.context, leg, divisions if name in shared else SECTION_DIVISIONS)
            for name, leg in robot.legs.items()
        }
        return _climbed(robot, springs)

    fine = own(SECTION_DIVISIONS)
    return step_uncertainty(sizes(own(COARSEST_WALLS) - fine, fine), SECTION_RATIO)


def _climbed(robot: RobotOnPath, springs: Springs) -> Statics:
    """Statics of legs as springs, by virtual joints where legs are serial chains."""
    return (summed if robot.climbs == "vjm" else assembled)(robot.postures, springs)


def _title(robot: RobotOnPath) -> str:
    """What models are held against."""
    names = ", ".join(robot.given)
    if robot.mechanism.parts:
        solid = " and solid legs" if robot.prisms else ""
        own = f", {names} by their own 6×6" if names else ""
        return f"mechanism assembled from its parts as solids{solid}{own}"
    if not robot.legs:
        return "mechanism of rigid bodies, assembled"
    if not robot.prisms:
        return "mechanism assembled from the legs' own 6×6"
    own = f" and {names} by their own 6×6" if names else ""
    return f"mechanism assembled from solid legs{own}"


def static_ladders(robot: RobotOnPath) -> dict[str, tuple[Step, ...]]:
    """Steps by name of the model, each ladder from the model upwards, one cause each."""
    context, mechanism = robot.context, robot.mechanism

    def climbed(spring: Spring) -> dict[str, Response]:
        def solve(ends: Holds) -> Statics:
            return _climbed(robot, {body: spring(leg, ends[body]) for body, leg in legs})

        return {
            name: Response(statics_of(partial(solve, ends)))
            for name, ends in robot.holding.alternatives.items()
        }

    def idealised(parts: PartLegs) -> Response:
        options = ModelOptions(parts=parts)
        return Response(statics_of(partial(model_statics, robot.postures, "beam", options)))

    def alike(found: Response) -> dict[str, Response]:
        return dict.fromkeys(robot.holding.alternatives, found)

    legs = robot.legs.items()
    as_given = climbed(lambda leg, _: given_compliance(leg))
    answered = {"drives": as_given}
    answered["shear"] = (
        alike(idealised("equivalent"))
        if mechanism.parts
        else climbed(lambda leg, _: given_compliance(equivalent_leg(leg)))
    )
    if robot.given:
        answered["diagonal"] = climbed(lambda leg, _: straight_spring(leg))
        answered["couplings"] = as_given
    for kind, found in part_answers(mechanism, idealised).items():
        answered[kind] = alike(found)
    if robot.prisms:
        answered["own"] = climbed(lambda leg, _: own_spring(context, leg))
        answered["warping"] = climbed(partial(held_spring, context))
        answered["contraction"] = climbed(partial(restrained_spring, context))
    return ladders(_LADDERS, STATIC_STEPS, answered, by=_BY[robot.climbs], climbs=robot.climbs)


STATIC_STEPS: Mapping[str, StepTexts] = {
    "drives": StepTexts(
        "elastic drives only, bodies and joints rigid",
        "{by}the legs as given",
        use("{climbs}"),
    ),
    "shear": StepTexts(
        "shear deformation neglected",
        "{by}Timoshenko's cantilever",
        TIMOSHENKO,
    ),
    # From legs of constant section to the 6×6 that they were made of, then from parts as such legs,
    "diagonal": StepTexts(
        "equivalent leg with another diagonal than the 6×6",
        "{by}the straight leg's entries of the 6×6",
    ),
    "couplings": StepTexts(
        "equivalent leg without the couplings of the 6×6",
        "{by}the 6×6 as given",
        use("{climbs}", " with the 6×6 as given: --legs given", "--legs"),
    ),
    **PART_STEPS,
    # and from textbook constants to solids with rigid end faces.
    "own": StepTexts(
        "textbook section constants",
        "fem.sections.section_constants, tip of the cantilever",
    ),
    "warping": StepTexts(
        "warping held at the ends",
        "Reissner's torsion with held ends, the section's own Γ",
    ),
    "contraction": StepTexts(
        "contraction and shear warping held at the ends",
        "fem.couplings.end_effects, exact along the leg",
    ),
}
_TO_SOLIDS = ("own", "warping", "contraction")
_FROM_CONSTANT = ("diagonal", "couplings", *PART_STEPS, *_TO_SOLIDS)
_LADDERS: Mapping[str, Sequence[str]] = {
    "simplified": ("drives", *_TO_SOLIDS),
    "vjm": _TO_SOLIDS,
    "links": _TO_SOLIDS,
    "vjm-equivalent": _FROM_CONSTANT,
    "segments": _FROM_CONSTANT,
    "segments-stepped": ("condensed", *_TO_SOLIDS),
    "segments-condensed": _TO_SOLIDS,
    "beam": _FROM_CONSTANT,
    "segments-euler-bernoulli": ("shear", *_FROM_CONSTANT),
    "beam-euler-bernoulli": ("shear", *_FROM_CONSTANT),
}
