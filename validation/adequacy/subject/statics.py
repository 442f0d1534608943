"""Compliances of a robot or of a leg: what models are held against, and the ladders of causes.

The reference assembles the robot from what its legs are: solids where they are prisms, the 6×6 of
the file where they are given. Ladders climb by the virtual joint method where legs are serial
chains; it shares no code with the assembler.
"""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from lumped.acceptance.requirement import STATIC_QUANTITIES
from lumped.arrays import Array
from lumped.legs import Ends, GivenLeg, Leg, given_compliance
from validation.adequacy.legs import (
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
from validation.adequacy.response import (
    UNSOLVED,
    Alternative,
    Reference,
    Response,
    Rung,
    statics_of,
)
from validation.adequacy.subject.parts import FINER_PARTS, part_rungs, refinement_share
from validation.adequacy.subject.posed import Holds, Springs, Statics
from validation.agreement.displacement import sizes
from validation.context import Context
from validation.models.options import ModelOptions, PartLegs
from validation.parts.meshes import FINEST
from validation.solids.legs import COARSEST_WALLS

_BY = {"vjm": "virtual joints with ", "links": "links with ", "": ""}


def static_reference(robot: Statics) -> Reference:
    """Solid or given legs, assembled; raises InputError where sections are too fine to mesh."""
    context, legs = robot.context, robot.legs
    ratio = min((solid_leg(context, leg).ratio for leg in robot.prisms), default=1.0)

    def answer(ends: Holds, *, fine: bool = True, rung: int = FINEST) -> Array:
        tips = {body: solid_tip(context, leg, ends[body], fine=fine) for body, leg in legs.items()}
        return robot.assembled(tips, ends, rung)

    stiff = next(iter(robot.open.holds.values()))
    further = _section_uncertainty(robot) + refinement_share(
        robot.parts, lambda rung: answer(stiff, rung=rung), sizes
    )
    digits = robot.digits() if robot.digits else None
    alternatives = []
    for name, ends in robot.open.holds.items():
        fine = answer(ends)
        step = np.full((len(fine), len(STATIC_QUANTITIES)), ROUNDING)
        if robot.prisms:
            step = step_uncertainty(sizes(answer(ends, fine=False) - fine, fine), ratio)
        response = Response(compliance=fine)
        alternatives.append(Alternative(name, response, static=step + further, digits=digits))
    return Reference(
        title=robot.title,
        alternatives=alternatives,
        open=robot.open.what,
        decides=robot.open.says,
        finer=FINER_PARTS if robot.parts else finer_statics(context, legs.values()),
        computed_by=robot.computed_by,
    )


def _section_uncertainty(robot: Statics) -> Array | float:
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
        return robot.climbed(springs)

    fine = own(SECTION_DIVISIONS)
    return step_uncertainty(sizes(own(COARSEST_WALLS) - fine, fine), SECTION_RATIO)


def static_ladders(robot: Statics) -> dict[str, tuple[Rung, ...]]:
    """Rungs by name of the model, each ladder from the model upwards, one cause each."""
    legs, holds, by = robot.legs, robot.open.holds, _BY[robot.climbs]

    def joined(springs: Callable[[], Springs]) -> Response:
        return statics_of(lambda: robot.climbed(springs()), UNSOLVED)

    def everywhere(springs: Callable[[], Springs]) -> dict[str, Response]:
        return dict.fromkeys(holds, joined(springs))

    def each(spring: Callable[[Leg], Array]) -> dict[str, Response]:
        return everywhere(lambda: {body: spring(leg) for body, leg in legs.items()})

    def held(spring: Callable[[Context, Leg, Ends], Array]) -> dict[str, Response]:
        def springs(ends: Holds) -> Springs:
            return {body: spring(robot.context, leg, ends[body]) for body, leg in legs.items()}

        return {name: joined(partial(springs, ends)) for name, ends in holds.items()}

    def idealised(parts: PartLegs) -> Response:
        return statics_of(partial(robot.answer, "beam", ModelOptions(parts=parts)), UNSOLVED)

    as_given = everywhere(partial(robot.tips, "given"))
    # From legs of constant section to the 6×6 that they were made of, then from parts as such legs,
    section = _of_given_legs(by, each(_straight), as_given) if robot.given else ()
    idealisation = part_rungs(robot.parts, holds, idealised)
    # and from there to solids.
    upper: tuple[Rung, ...] = ()
    if robot.prisms:
        own = each(partial(own_spring, robot.context))
        upper = _to_solids(own, held(held_spring), held(restrained_spring))
    constant = (*section, *idealisation, *upper)
    shear = Rung(
        "shear deformation left out",
        f"{by}Timoshenko's cantilever",
        dict.fromkeys(holds, idealised("equivalent"))
        if robot.parts
        else everywhere(partial(robot.tips, "equivalent")),
        "use Timoshenko",
    )
    drives = Rung(
        f"drives only: {robot.rigid}",
        f"{by}the legs as given",
        as_given,
        f"use {robot.climbs}",
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


def _straight(leg: Leg) -> Array:
    return straight_spring(leg) if isinstance(leg, GivenLeg) else given_compliance(leg)


def _of_given_legs(
    by: str, straight: Mapping[str, Response], as_given: Mapping[str, Response]
) -> tuple[Rung, ...]:
    return (
        Rung(
            "equivalent leg: another diagonal than the 6×6",
            f"{by}the straight leg's entries of the 6×6",
            straight,
        ),
        Rung(
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
) -> tuple[Rung, ...]:
    """From textbook constants to solids with rigid end faces."""
    return (
        Rung(
            "textbook section constants",
            "fem.sections.section_constants, tip of the cantilever",
            own,
            "take the section's constants from finite elements",
        ),
        Rung(
            "warping held at the ends",
            "Reissner's torsion with held ends, the section's own Γ",
            warping,
            "add the warping stiffness",
        ),
        Rung(
            "contraction and warping by shear held at the ends",
            "fem.couplings.end_effects, exact along the leg",
            contraction,
            "add what rigid end faces take",
        ),
    )
