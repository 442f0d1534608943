"""The biglide with its models and references, ready to be judged."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide, with_equivalent_legs
from lumped.legs import GivenLeg
from validation.adequacy.biglide.closure import require_closed
from validation.adequacy.biglide.dynamics import (
    dynamic_ladders,
    dynamic_reference,
    vibrations,
)
from validation.adequacy.biglide.leg import MODELS as LEG_MODELS
from validation.adequacy.biglide.leg import leg_subject
from validation.adequacy.biglide.statics import compliances, static_ladders, static_reference
from validation.adequacy.common.references import bracketed_frequencies
from validation.adequacy.matrix import Coordinate
from validation.adequacy.models import JUDGED, LEGS_AS_GIVEN, JudgedModel
from validation.adequacy.response import (
    UNSOLVED,
    Candidate,
    Reference,
    Rung,
    Subject,
    no_reference,
    statics_of,
    together,
)
from validation.context import Context
from validation.studies.paired_robot_modes import sample_weights

POSTURES = 9
_STATIC = "static: it has no masses, hence says nothing of frequencies"
_RIGID = "its legs are rigid and its drives move along y alone: it knows no such motion"
MODELS = ("simplified", *LEG_MODELS)
CANDIDATES: Mapping[str, JudgedModel] = {name: JUDGED[name] for name in MODELS} | {
    "simplified": JUDGED["simplified"]._replace(title="elastic drives, rigid legs")
}


def biglide_subject(context: Context) -> Subject:
    """Responses of all models of the run's robot and of what they are held against.

    Raises ComputationError where a posture that all models share is none of the robot.
    """
    robot = context.robot
    x = robot.stations(POSTURES)
    # Models of a posture that is none of the robot agree on nothing: that is not left undecided.
    require_closed(robot, x)
    statics, ladders = _statics(context, robot, x)
    modes = context.robot_file.requirement.modes
    found = vibrations(context, robot, POSTURES)
    try:
        dynamics = dynamic_reference(context, robot, modes, POSTURES)
    except UNSOLVED as error:
        dynamics = no_reference(error)
    rungs = dynamic_ladders(context, robot, found, dynamics, POSTURES)
    candidates = [
        Candidate(
            model=name,
            title=title,
            response=together(
                statics_of(partial(compliances, model, robot, x, options)), found[name]
            ),
            static_rungs=ladders.get(name, ()),
            dynamic_rungs=rungs.get(name, ()),
            rigid=_RIGID if model == "simplified" else "",
            silent=_STATIC if model == "vjm" else "",
            computed_by=(f"validation.models.biglide.robot_compliance({model!r})",),
        )
        for name, (model, title, options) in CANDIDATES.items()
    ]
    given = any(isinstance(leg, GivenLeg) for leg in (robot.leg1, robot.leg2))
    return Subject(
        robot=robot.name,
        coordinates=(Coordinate("x", "m"),),
        poses=x[:, None],
        weights=sample_weights(robot),
        candidates=candidates,
        statics=statics,
        dynamics=dynamics,
        bracket=bracketed_frequencies(dynamics, modes, f"at x = {robot.centre:.4g} m"),
        parts=(
            leg_subject(context, robot.leg1, "leg 1"),
            leg_subject(context, robot.leg2, "leg 2"),
        ),
        formulation=on_equivalent_legs(context, robot, x) if given else None,
    )


def _statics(
    context: Context, robot: Biglide, x: Array
) -> tuple[Reference, Mapping[str, Sequence[Rung]]]:
    """What deflections are held against, and what leads there, by model; none without solids."""
    try:
        reference = static_reference(context, robot, x)
    except UNSOLVED as error:
        return no_reference(error), {}
    return reference, static_ladders(context, robot, x)


def on_equivalent_legs(context: Context, robot: Biglide, x: Array) -> Subject:
    """Statics of the models that put equivalent legs for given ones, against solids of those."""
    member = with_equivalent_legs(robot)
    statics, ladders = _statics(context, member, x)
    return Subject(
        robot="equivalent legs",
        coordinates=(Coordinate("x", "m"),),
        poses=x[:, None],
        weights=np.zeros(0),
        candidates=[
            Candidate(
                model=name,
                title=title,
                response=statics_of(partial(compliances, model, robot, x, options)),
                static_rungs=ladders.get(name, ()),
                computed_by=(f"validation.models.biglide.robot_compliance({model!r})",),
            )
            for name, (model, title, options) in CANDIDATES.items()
            if name not in LEGS_AS_GIVEN
        ],
        statics=statics,
        dynamics=Reference("none", ()),
    )
