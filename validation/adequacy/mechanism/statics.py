"""Compliances of a robot over its path: what models are held against, and why they are off.

The reference assembles the robot from what its legs are: solids where they are prisms, the 6×6 of
the file where they are given. Causes are told apart by the virtual joint method where legs are
serial chains; it shares no code with the assembler.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TypeAlias

import numpy as np

from lumped.acceptance.requirement import STATIC_QUANTITIES
from lumped.arrays import Array
from lumped.legs import Ends, Leg, equivalent_leg, given_compliance
from lumped.mechanism.mechanism import Posture
from lumped.models import serial_chains
from lumped.models.links import links
from lumped.system.assembly import assembly
from lumped.system.solution import compliance, solved
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
    Bodies,
    condensed_parts,
    part_steps,
    refinement_share,
    solid_parts,
)
from validation.adequacy.mechanism.path import Holds, RobotOnPath, Springs
from validation.adequacy.response import (
    UNSOLVED,
    Alternative,
    Reference,
    Response,
    Step,
    statics_of,
)
from validation.agreement.displacement import sizes
from validation.models.mechanism import answers
from validation.models.options import ModelName, ModelOptions, PartLegs
from validation.parts.meshes import FINEST
from validation.solids.legs import COARSEST_WALLS

# Compliance (6×6, SI, leg axes) of the tip of a leg with such ends.
Spring: TypeAlias = Callable[[Leg, Ends], Array]

_RIGID = "bodies and joints rigid"
_BY = {"vjm": "virtual joints with ", "links": "links with "}


def compliances(postures: Sequence[Posture], model: ModelName, options: ModelOptions) -> Array:
    """What a model of the mechanism answers to unit wrenches at the loaded point (p×6×6, SI)."""
    return np.array([answer.compliance for answer in answers(model, postures, 0, options)])


def assembled(postures: Sequence[Posture], springs: Springs, parts: Bodies | None = None) -> Array:
    """Compliances (p×6×6) by the assembler, every leg by its tip's compliance (6×6).

    `parts`: models of those bodies that are CAD parts; condensed on their interfaces without.
    """
    mechanism = postures[0].mechanism
    of_parts = condensed_parts(mechanism) if parts is None else parts
    prepared = assembly(mechanism, {**links(mechanism, springs), **of_parts})
    return np.array([compliance(solved(prepared.at(posture))) for posture in postures])


def summed(postures: Sequence[Posture], springs: Springs) -> Array:
    """The same by virtual joints along serial chains."""
    return np.array([serial_chains.compliance(posture, springs) for posture in postures])


def static_reference(robot: RobotOnPath) -> Reference:
    """Solid or given legs, assembled; raises InputError where sections are too fine to mesh."""
    context, parts = robot.context, robot.mechanism.parts
    ratio = min((solid_leg(context, leg).ratio for leg in robot.prisms), default=1.0)
    further = _section_uncertainty(robot) + refinement_share(
        robot.mechanism, lambda level: _of_solids(robot, robot.holding.first, level=level), sizes
    )
    digits = None
    if robot.text:
        digits = context.get(left_by_digits, robot.text, robot.postures)
    alternatives = []
    for name, ends in robot.holding.alternatives.items():
        fine = _of_solids(robot, ends)
        step = np.full((len(fine), len(STATIC_QUANTITIES)), ROUNDING)
        if robot.prisms:
            coarse = _of_solids(robot, ends, fine=False)
            step = step_uncertainty(sizes(coarse - fine, fine), ratio)
        response = Response(compliance=fine)
        alternatives.append(Alternative(name, response, static=step + further, digits=digits))
    own = "fem.bodies.doubling.condensed_leg" if robot.prisms else "lumped.legs.given_compliance"
    return Reference(
        title=_title(robot),
        alternatives=alternatives,
        open=robot.holding.unsaid,
        decides=robot.holding.decides,
        finer=FINER_PARTS if parts else finer_statics(context, robot.legs.values()),
        computed_by=(
            *((own,) if robot.legs else ()),
            *(("validation.models.parts.reduced",) if parts else ()),
            "lumped.system.solution.compliance",
        ),
    )


def _of_solids(robot: RobotOnPath, ends: Holds, *, fine: bool = True, level: int = FINEST) -> Array:
    """Compliances (p×6×6) with solid legs on one of two meshes, parts on one of three."""
    tips = {
        body: solid_tip(robot.context, leg, ends[body], fine=fine)
        for body, leg in robot.legs.items()
    }
    parts = solid_parts(robot.postures, robot.offered, ends, level)
    return assembled(robot.postures, tips, parts)


def _section_uncertainty(robot: RobotOnPath) -> Array | float:
    """What section meshes leave open (p×7, relative) where both solids of a leg share one.

    By constants of that mesh and of one twice as fine; else zero.
    """
    shared = {name for name, leg in robot.legs.items() if shares_section(robot.context, leg)}
    if not shared:
        return 0.0

    def own(divisions: int) -> Array:
        springs = {
            name: own_spring(robot.context, leg, divisions if name in shared else SECTION_DIVISIONS)
            for name, leg in robot.legs.items()
        }
        return _climbed(robot, springs)

    fine = own(SECTION_DIVISIONS)
    return step_uncertainty(sizes(own(COARSEST_WALLS) - fine, fine), SECTION_RATIO)


def _climbed(robot: RobotOnPath, springs: Springs) -> Array:
    """Compliances (p×6×6) of legs as springs, by virtual joints where legs are serial chains."""
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
    context, by = robot.context, _BY[robot.climbs]
    alternatives = robot.holding.alternatives

    def climbed(spring: Spring, ends: Holds) -> Response:
        def solve() -> Array:
            springs = {body: spring(leg, ends[body]) for body, leg in robot.legs.items()}
            return _climbed(robot, springs)

        return statics_of(solve, UNSOLVED)

    def alike(spring: Callable[[Leg], Array]) -> dict[str, Response]:
        return dict.fromkeys(alternatives, climbed(lambda leg, _: spring(leg), robot.holding.first))

    def held(spring: Spring) -> dict[str, Response]:
        return {name: climbed(spring, ends) for name, ends in alternatives.items()}

    def idealised(parts: PartLegs) -> Response:
        options = ModelOptions(parts=parts)
        return statics_of(partial(compliances, robot.postures, "beam", options), UNSOLVED)

    as_given = alike(given_compliance)
    # From legs of constant section to the 6×6 that they were made of, then from parts as such legs,
    section: tuple[Step, ...] = ()
    if robot.given:
        section = _of_given_legs(by, alike(straight_spring), as_given)
    idealisation = part_steps(robot.mechanism, alternatives, idealised)
    # and from there to solids.
    upper: tuple[Step, ...] = ()
    if robot.prisms:
        upper = _to_solids(
            alike(partial(own_spring, context)),
            held(partial(held_spring, context)),
            held(partial(restrained_spring, context)),
        )
    constant = (*section, *idealisation, *upper)
    shear = Step(
        "shear deformation left out",
        f"{by}Timoshenko's cantilever",
        dict.fromkeys(alternatives, idealised("equivalent"))
        if robot.mechanism.parts
        else alike(lambda leg: given_compliance(equivalent_leg(leg))),
        "use Timoshenko",
    )
    drives = Step(
        f"drives only: {_RIGID}", f"{by}the legs as given", as_given, f"use {robot.climbs}"
    )
    return {
        "simplified": (drives, *upper),
        "vjm": upper,
        "links": upper,
        "vjm-equivalent": constant,
        "segments": constant,
        "segments-stepped": (*idealisation[1:], *upper),
        "segments-condensed": upper,
        "beam": constant,
        "segments-euler-bernoulli": (shear, *constant),
        "beam-euler-bernoulli": (shear, *constant),
    }


def _of_given_legs(
    by: str, straight: Mapping[str, Response], as_given: Mapping[str, Response]
) -> tuple[Step, ...]:
    return (
        Step(
            "equivalent leg: another diagonal than the 6×6",
            f"{by}the straight leg's entries of the 6×6",
            straight,
        ),
        Step(
            "equivalent leg: couplings of the 6×6 left out",
            f"{by}the 6×6 as given",
            as_given,
            "take the 6×6 with its couplings",
        ),
    )


def _to_solids(
    own: Mapping[str, Response],
    warping: Mapping[str, Response],
    contraction: Mapping[str, Response],
) -> tuple[Step, ...]:
    """From textbook constants to solids with rigid end faces."""
    return (
        Step(
            "textbook section constants",
            "fem.sections.section_constants, tip of the cantilever",
            own,
            "take the section's constants from finite elements",
        ),
        Step(
            "warping held at the ends",
            "Reissner's torsion with held ends, the section's own Γ",
            warping,
            "add the warping stiffness",
        ),
        Step(
            "contraction and warping by shear held at the ends",
            "fem.couplings.end_effects, exact along the leg",
            contraction,
            "add what rigid end faces take",
        ),
    )
