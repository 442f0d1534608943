"""Compliances of the biglide over its stroke: models, the assembler, and virtual joints."""

from dataclasses import replace
from functools import partial

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide, mechanism, postures
from lumped.legs import ConstantLeg
from lumped.models import vjm
from lumped.models.bodies import tip_compliances
from validation.adequacy.biglide.closure import require_closed
from validation.adequacy.mechanism import path
from validation.adequacy.mechanism.digits import left_by_digits
from validation.adequacy.mechanism.statics import assembled, assembled_title
from validation.adequacy.subject.posed import Open, Springs, Statics
from validation.context import Context
from validation.models.biglide import robot_compliance
from validation.models.options import ModelName, ModelOptions

SAY_ENDS = 'say how the legs\' end faces are held: ends = "rigid" or "free" in [leg1], [leg2]'


def biglide_statics(context: Context, robot: Biglide, x: Array) -> Statics:
    """What computes deflections with B at `x` (m, p values).

    Raises ComputationError where a posture that all models share is none of the robot: models of
    such a one agree on nothing, which is not left undecided.
    """
    require_closed(robot, x)
    places = postures(robot, x)
    legs = {"leg1": robot.leg1, "leg2": robot.leg2}
    solid = any(isinstance(leg, ConstantLeg) for leg in legs.values())

    def climbed(springs: Springs) -> Array:
        both = springs["leg1"], springs["leg2"]
        return np.array([vjm.compliance(robot, at, both) for at in x.tolist()])

    return Statics(
        context,
        assembled_title("robot", legs),
        legs,
        left_open(robot),
        None,
        answer=partial(compliances, robot, x),
        unanswered=lambda _model, _options: "",
        assembled=lambda tips, _ends, _rung: assembled(places, tips),
        climbed=climbed,
        climbs="vjm",
        tips=partial(tip_compliances, places[0].mechanism),
        rigid="legs and feet rigid",
        computed_by=(
            "fem.bodies.doubling.condensed_leg" if solid else "lumped.legs.given_compliance",
            "lumped.system.solution.compliance",
        ),
        digits=partial(context.get, left_by_digits, context.robot_file.text, tuple(places)),
    )


def left_open(robot: Biglide) -> Open:
    """How the legs are held: what is said, and what is not."""
    found = path.left_open(mechanism(robot))
    return replace(found, says=SAY_ENDS if found.says else "")


def compliances(robot: Biglide, x: Array, model: ModelName, options: ModelOptions) -> Array:
    """What a model answers at `x` (p×6×6, SI); where it knows x and y alone, it is rigid."""
    found = np.zeros((len(x), 6, 6))
    for at, station in enumerate(x.tolist()):
        known = robot_compliance(model, robot, station, options)
        found[at, : len(known), : len(known)] = known
    return found
