"""One leg of the biglide by itself, root clamped: its tip's compliance by every model.

What a robot's feet and its other leg hide, the leg alone shows: torsion of open sections, say.
"""

from collections.abc import Callable
from functools import partial

import numpy as np

from lumped.arrays import Array
from lumped.legs import Ends, GivenLeg, Leg, given_compliance
from validation.adequacy.biglide.statics import SAY_ENDS
from validation.adequacy.common.ladders import given_leg_rungs, shear_rung, static_upper_rungs
from validation.adequacy.legs import (
    HOLD,
    OPEN_ENDS,
    ROUNDING,
    finer_statics,
    held_spring,
    own_spring,
    restrained_spring,
    solid_leg,
    step_uncertainty,
    straight_spring,
)
from validation.adequacy.models import JUDGED
from validation.adequacy.response import (
    UNSOLVED,
    Alternative,
    Candidate,
    Reference,
    Response,
    Rung,
    Subject,
    no_reference,
    statics_of,
)
from validation.context import Context
from validation.models.legs import leg_compliance
from validation.models.options import ModelName, ModelOptions

MODELS = (
    "vjm",
    "vjm-equivalent",
    "segments",
    "beam",
    "segments-euler-bernoulli",
    "beam-euler-bernoulli",
)


def leg_subject(context: Context, leg: Leg, name: str) -> Subject:
    """A leg and its models, statics alone."""
    try:
        reference, rungs = _reference(context, leg), _rungs(context, leg)
    except UNSOLVED as error:
        reference, rungs = no_reference(error), ()
    candidates = []
    for model in MODELS:
        kind, _, options = JUDGED[model]
        shears = () if options.theory == "timoshenko" else (_shear(leg),)
        equivalent = rungs if model != "vjm" else [r for r in rungs if "equivalent" not in r.cause]
        candidates.append(
            Candidate(
                model=model,
                title=model,
                response=_response(kind, leg, options),
                static_rungs=(*shears, *equivalent),
                computed_by=("validation.models.legs.leg_compliance",),
            )
        )
    return Subject(
        robot=name,
        coordinates=(),
        poses=np.zeros((1, 0)),
        weights=np.zeros(0),
        candidates=candidates,
        statics=reference,
        dynamics=Reference("none", ()),
    )


def _response(model: ModelName, leg: Leg, options: ModelOptions) -> Response:
    return statics_of(lambda: leg_compliance(model, leg, options)[None])


def _holds(leg: Leg) -> dict[str, Ends]:
    if isinstance(leg, GivenLeg):
        return {"as given": "rigid"}
    return {leg.ends: leg.ends} if leg.ends else {hold: hold for hold in HOLD}


def _everywhere(leg: Leg, spring: Callable[[], Array]) -> dict[str, Response]:
    return dict.fromkeys(_holds(leg), statics_of(lambda: spring()[None], UNSOLVED))


def _reference(context: Context, leg: Leg) -> Reference:
    if isinstance(leg, GivenLeg):
        known = np.full((1, 6), ROUNDING)
        only = Alternative("as given", Response(leg.compliance[None]), static=known)
        return Reference("the leg's own 6×6", (only,), computed_by=("lumped.robot_file",))
    meshes = solid_leg(context, leg)
    alternatives = []
    for name, hold in _holds(leg).items():
        coarse, fine = (
            one.rigid if hold == "rigid" else one.free for one in (meshes.coarse, meshes.fine)
        )
        step = step_uncertainty(np.diag(coarse), np.diag(fine), meshes.ratio)
        alternatives.append(Alternative(name, Response(fine[None]), static=step[None]))
    return Reference(
        title="solid leg, root clamped",
        alternatives=alternatives,
        open="" if leg.ends else OPEN_ENDS,
        decides="" if leg.ends else SAY_ENDS,
        finer=finer_statics(context, [leg]),
        computed_by=("fem.bodies.doubling.condensed_leg",),
    )


def _shear(leg: Leg) -> Rung:
    timoshenko = partial(leg_compliance, "vjm", leg, ModelOptions(legs="equivalent"))
    return shear_rung("", _everywhere(leg, timoshenko))


def _rungs(context: Context, leg: Leg) -> tuple[Rung, ...]:
    if isinstance(leg, GivenLeg):
        straight = _everywhere(leg, partial(straight_spring, leg))
        return given_leg_rungs("", straight, _everywhere(leg, partial(given_compliance, leg)))

    def held(spring: Callable[[Context, Leg, Ends], Array]) -> dict[str, Response]:
        def solved(hold: Ends) -> Response:
            return statics_of(lambda: spring(context, leg, hold)[None], UNSOLVED)

        return {name: solved(hold) for name, hold in _holds(leg).items()}

    own = _everywhere(leg, partial(own_spring, context, leg))
    return static_upper_rungs(own, held(held_spring), held(restrained_spring))
