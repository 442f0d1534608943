"""One leg of the biglide by itself, root clamped: its tip's compliance by every model.

What a robot's feet and its other leg hide, the leg alone shows: torsion of open sections, say.
"""

import numpy as np

from lumped.arrays import Array
from lumped.legs import ConstantLeg, Ends, Leg, equivalent_leg, given_compliance
from lumped.models.bodies import LegSprings
from validation.adequacy.biglide.statics import SAY_ENDS
from validation.adequacy.legs import HOLD, OPEN_ENDS
from validation.adequacy.models import JUDGED
from validation.adequacy.response import Reference, Subject
from validation.adequacy.subject.posed import Open, Springs, Statics
from validation.adequacy.subject.subject import judged_statics
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
_TIP = "leg"


def leg_subject(context: Context, leg: Leg, name: str) -> Subject:
    """A leg and its models, statics alone."""
    models = {model: JUDGED[model]._replace(title=model) for model in MODELS}
    reference, candidates = judged_statics(
        leg_statics(context, leg), models, "validation.models.legs.leg_compliance"
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


def leg_statics(context: Context, leg: Leg) -> Statics:
    """What computes the deflections of the tip: where all is one leg, it is its own robot."""
    solid = isinstance(leg, ConstantLeg)

    def answer(model: ModelName, options: ModelOptions) -> Array:
        return leg_compliance(model, leg, options)[None]

    def tips(springs: LegSprings) -> Springs:
        return {_TIP: given_compliance(leg if springs == "given" else equivalent_leg(leg))}

    return Statics(
        context,
        "solid leg, root clamped" if solid else "the leg's own 6×6",
        {_TIP: leg},
        _left_open(leg),
        None,
        answer=answer,
        unanswered=lambda _model, _options: "",
        assembled=lambda found, _ends, _rung: found[_TIP][None],
        climbed=lambda springs: springs[_TIP][None],
        climbs="",
        tips=tips,
        rigid="",
        computed_by=("fem.bodies.doubling.condensed_leg" if solid else "lumped.robot_file",),
    )


def _left_open(leg: Leg) -> Open:
    if not isinstance(leg, ConstantLeg):
        return Open("", "", {"as given": {_TIP: "rigid"}})
    if leg.ends:
        return Open("", "", {leg.ends: {_TIP: leg.ends}})
    unsaid: tuple[Ends, ...] = HOLD
    return Open(OPEN_ENDS, SAY_ENDS, {hold: {_TIP: hold} for hold in unsaid})
