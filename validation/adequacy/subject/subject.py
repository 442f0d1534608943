"""Any robot with its models and references, ready to be judged."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from validation.adequacy.models import LEGS_AS_GIVEN, JudgedModel
from validation.adequacy.response import (
    UNSOLVED,
    Candidate,
    Reference,
    Response,
    Rung,
    Subject,
    Vibration,
    modes_of,
    no_reference,
    statics_of,
    together,
)
from validation.adequacy.subject.dynamics import (
    bracketed_frequencies,
    dynamic_ladders,
    dynamic_reference,
)
from validation.adequacy.subject.posed import Posed, Statics
from validation.adequacy.subject.statics import static_ladders, static_reference
from validation.models.options import STATIC

_STATIC = "static: it has no masses, hence says nothing of frequencies"
_NO_MASS = "neither its rigid bodies nor its tool have mass: it says nothing of frequencies"


def subject_of(robot: Posed) -> Subject:
    """Responses of all models of a robot and of what they are held against."""
    dynamics = robot.dynamics
    found = {name: modes_of(partial(_modes, robot, one)) for name, one in robot.models.items()}
    statics, candidates = judged_statics(robot.statics, robot.models, robot.computed_by)
    try:
        reference = dynamic_reference(dynamics)
    except UNSOLVED as error:
        reference = no_reference(error)
    rungs = dynamic_ladders(dynamics, found, reference)
    return Subject(
        robot=robot.name,
        coordinates=robot.coordinates,
        poses=robot.poses,
        weights=dynamics.weights,
        candidates=[
            replace(
                one,
                response=together(one.response, found[one.model]),
                dynamic_rungs=rungs.get(one.model, ()),
                rigid=robot.rigid if one.model == "simplified" else "",
                silent=one.silent or _silent(robot.models[one.model], found[one.model]),
            )
            for one in candidates
        ],
        statics=statics,
        dynamics=reference,
        notes=robot.notes,
        bracket=bracketed_frequencies(reference, dynamics.judged, robot.middle),
        formulation=on_equivalent_legs(robot, robot.equivalent) if robot.equivalent else None,
    )


def on_equivalent_legs(robot: Posed, statics: Statics) -> Subject:
    """Statics of the models that put equivalent legs for given ones, against solids of those."""
    models = {name: one for name, one in robot.models.items() if name not in LEGS_AS_GIVEN}
    reference, candidates = judged_statics(statics, models, robot.computed_by)
    return Subject(
        robot="equivalent legs",
        coordinates=robot.coordinates,
        poses=robot.poses,
        weights=np.zeros(0),
        candidates=candidates,
        statics=reference,
        dynamics=Reference("none", ()),
    )


def judged_statics(
    statics: Statics, models: Mapping[str, JudgedModel], computed_by: str
) -> tuple[Reference, Sequence[Candidate]]:
    """What deflections are held against, none without solids, and the models with their ladders.

    `computed_by` names the function that the models are computed by.
    """
    rungs: Mapping[str, tuple[Rung, ...]] = {}
    try:
        reference, rungs = static_reference(statics), static_ladders(statics)
    except UNSOLVED as error:
        reference = no_reference(error)
    candidates = []
    for name, (kind, title, options) in models.items():
        unable = statics.unanswered(kind, options)
        answered = Response() if unable else statics_of(partial(statics.answer, kind, options))
        candidates.append(
            Candidate(
                model=name,
                title=title,
                response=answered,
                static_rungs=rungs.get(name, ()),
                silent=unable,
                computed_by=(f"{computed_by}({kind!r})",),
            )
        )
    return reference, candidates


def _modes(robot: Posed, model: JudgedModel) -> Vibration | None:
    if model.kind in STATIC or robot.statics.unanswered(model.kind, model.options):
        return None
    return robot.dynamics.answer(model.kind, model.options)


def _silent(model: JudgedModel, found: Response) -> str:
    if model.kind in STATIC:
        return _STATIC
    return "" if found.vibration or found.unsolved_modes else _NO_MASS
