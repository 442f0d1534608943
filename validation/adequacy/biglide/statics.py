"""Compliances of the biglide over its stroke: models, ladders of causes, and the reference.

The reference assembles the robot from what its legs are: solids where they are prisms, the 6×6 of
the file where they are given. Ladders climb by the virtual joint method, which shares no code with
that.
"""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide, postures
from lumped.legs import ConstantLeg, Ends, GivenLeg, Leg, given_compliance
from lumped.models import vjm
from lumped.system.assembly import assembly
from lumped.system.sweep import swept
from validation.adequacy.biglide.closure import require_closed
from validation.adequacy.common.ladders import (
    given_leg_rungs,
    shear_rung,
    static_rungs,
    static_upper_rungs,
)
from validation.adequacy.legs import (
    HOLD,
    OPEN_ENDS,
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
from validation.context import Context
from validation.models.biglide import robot_compliance
from validation.models.options import ModelName, ModelOptions
from validation.solids.legs import COARSEST_WALLS
from validation.solids.robots import static_leg

_BY = "virtual joints with "
SAY_ENDS = 'say how the legs\' end faces are held: ends = "rigid" or "free" in [leg1], [leg2]'


def compliances(model: ModelName, robot: Biglide, x: Array, options: ModelOptions) -> Array:
    """What a model answers at `x` (p×6×6, SI); where it knows x and y alone, it is rigid."""
    found = np.zeros((len(x), 6, 6))
    for at, station in enumerate(x.tolist()):
        known = robot_compliance(model, robot, station, options)
        found[at, : len(known), : len(known)] = known
    return found


def holds(robot: Biglide) -> dict[str, tuple[Ends, Ends]]:
    """Ends of leg 1 and leg 2 by the name of the alternative: what is said, and what is not."""
    said = [_said(leg) for leg in (robot.leg1, robot.leg2)]
    if all(ends is not None for ends in said):
        return {"ends as said": (said[0] or "rigid", said[1] or "rigid")}
    return {f"ends {hold}": (said[0] or hold, said[1] or hold) for hold in HOLD}


def _said(leg: Leg) -> Ends | None:
    # The 6×6 of a given leg has its ends in it.
    return "rigid" if isinstance(leg, GivenLeg) else leg.ends


def static_reference(context: Context, robot: Biglide, x: Array) -> Reference:
    """Solid or given legs, assembled.

    Raises InputError where sections are too fine to mesh, ComputationError where a posture that all
    models share is none of the robot.
    """
    require_closed(robot, x)
    legs = robot.leg1, robot.leg2
    solids = [isinstance(leg, ConstantLeg) for leg in legs]
    ratio = min(
        (solid_leg(context, leg).ratio for leg in legs if isinstance(leg, ConstantLeg)), default=1.0
    )
    section_uncertainty = _section_uncertainty(context, robot, x)
    alternatives = []
    for name, ends in holds(robot).items():
        held = list(zip(legs, ends, strict=True))
        found = [
            assembled_legs(robot, x, [solid_tip(context, *one, fine=fine) for one in held])
            for fine in (False, True)
        ]
        diagonals = [np.diagonal(one, axis1=1, axis2=2) for one in found]
        uncertainty = (
            step_uncertainty(diagonals[0], diagonals[1], ratio)
            if any(solids)
            else np.full(diagonals[1].shape, ROUNDING)
        )
        uncertainty = uncertainty + section_uncertainty
        alternatives.append(Alternative(name, Response(compliance=found[1]), static=uncertainty))
    return Reference(
        title=_TITLES[solids[0], solids[1]],
        alternatives=alternatives,
        open=OPEN_ENDS if len(alternatives) > 1 else "",
        decides=SAY_ENDS if len(alternatives) > 1 else "",
        finer=finer_statics(context, legs),
        computed_by=(
            "fem.bodies.doubling.condensed_leg" if any(solids) else "lumped.legs.given_compliance",
            "lumped.system.sweep.swept",
        ),
    )


_TITLES = {
    (True, True): "robot assembled from solid legs",
    (False, False): "robot assembled from the legs' own 6×6",
    (True, False): "robot assembled from leg 1 as a solid and leg 2 by its own 6×6",
    (False, True): "robot assembled from leg 1 by its own 6×6 and leg 2 as a solid",
}


def _section_uncertainty(context: Context, robot: Biglide, x: Array) -> Array:
    """What section meshes leave open (p×6, relative) where both solids of a leg share one.

    By virtual joints with constants of that mesh and of one twice as fine; else zero.
    """
    legs = robot.leg1, robot.leg2
    shared = [shares_section(context, leg) for leg in legs]
    if not any(shared):
        return np.zeros((len(x), 6))

    def joints(divisions: int) -> Array:
        springs = [
            own_spring(context, leg, divisions if one else SECTION_DIVISIONS)
            for leg, one in zip(legs, shared, strict=True)
        ]
        found = [vjm.compliance(robot, at, (springs[0], springs[1])) for at in x.tolist()]
        return np.diagonal(np.array(found), axis1=1, axis2=2)

    return step_uncertainty(joints(COARSEST_WALLS), joints(SECTION_DIVISIONS), SECTION_RATIO)


def assembled_legs(robot: Biglide, x: Array, tips: Sequence[Array]) -> Array:
    """Compliances (p×6×6) by the assembler, both legs by the compliances of their `tips` (6×6)."""
    legs = (
        static_leg(leg, tip, "reference")
        for leg, tip in zip((robot.leg1, robot.leg2), tips, strict=True)
    )
    places = postures(robot, x)
    prepared = assembly(places[0].mechanism, dict(zip(("leg1", "leg2"), legs, strict=True)))
    return swept(prepared, places, 0).compliances


def static_ladders(context: Context, robot: Biglide, x: Array) -> dict[str, tuple[Rung, ...]]:
    """Rungs for statics by name of the model, each ladder from the model upwards."""
    names = tuple(holds(robot))
    legs = robot.leg1, robot.leg2

    def joints(spring: Callable[[Leg, Ends], Array], ends: tuple[Ends, Ends]) -> Array:
        first, second = (spring(leg, hold) for leg, hold in zip(legs, ends, strict=True))
        return np.array([vjm.compliance(robot, at, (first, second)) for at in x.tolist()])

    def held(spring: Callable[[Leg, Ends], Array]) -> Mapping[str, Response]:
        return {
            name: statics_of(partial(joints, spring, ends), UNSOLVED)
            for name, ends in holds(robot).items()
        }

    def everywhere(spring: Callable[[Leg], Array]) -> Mapping[str, Response]:
        one = partial(joints, lambda leg, _: spring(leg), HOLD)
        return dict.fromkeys(names, statics_of(one, UNSOLVED))

    given = any(isinstance(leg, GivenLeg) for leg in legs)
    upper: tuple[Rung, ...] = ()
    if not all(isinstance(leg, GivenLeg) for leg in legs):
        upper = static_upper_rungs(
            everywhere(partial(own_spring, context)),
            held(partial(held_spring, context)),
            held(partial(restrained_spring, context)),
        )
    as_given = everywhere(given_compliance)
    section = given_leg_rungs(_BY, everywhere(straight_spring), as_given) if given else ()
    timoshenko = partial(compliances, "vjm", robot, x, ModelOptions(legs="equivalent"))
    shear = shear_rung(_BY, dict.fromkeys(names, statics_of(timoshenko)))
    drives = Rung(
        "drives only: legs and feet rigid",
        f"{_BY}the legs as given",
        as_given,
        "use vjm",
    )
    return static_rungs(drives, shear, section, upper)
