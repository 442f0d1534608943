"""Any mechanism with its models and references, ready to be judged."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial

import numpy as np

from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import on_equivalent_legs
from validation.adequacy.common.references import bracketed_frequencies
from validation.adequacy.mechanism.dynamics import (
    dynamic_ladders,
    dynamic_reference,
    model_vibration,
    simplified_vibration,
)
from validation.adequacy.mechanism.part_solids import reduction_note
from validation.adequacy.mechanism.path import (
    coordinates,
    has_given,
    left_open,
    offered,
    path_postures,
)
from validation.adequacy.mechanism.samples import samples_of
from validation.adequacy.mechanism.statics import (
    compliances,
    static_ladders,
    static_reference,
    unanswered,
)
from validation.adequacy.models import JUDGED, LEGS_AS_GIVEN, JudgedModel
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
from validation.context import Context
from validation.models.options import STATIC
from validation.models.parts import is_leg

_STATIC = "static: it has no masses, hence says nothing of frequencies"
_NO_MASS = "neither its rigid bodies nor its tool have mass: it says nothing of frequencies"
_RIGID = "its bodies and joints are rigid: the drives do not let the tool move so"


def mechanism_models(mechanism: Mechanism) -> tuple[str, ...]:
    """The models that are judged; without 6×6 both kinds of virtual joints are one."""
    parts = mechanism.parts.values()
    left_out = set() if parts else {"segments-stepped", "segments-condensed"}
    if not has_given(mechanism) and not any(is_leg(body) for body in parts):
        left_out.add("vjm-equivalent")
    return tuple(name for name in JUDGED if name not in left_out)


def mechanism_candidates(mechanism: Mechanism) -> dict[str, JudgedModel]:
    """The models that are judged by name."""
    return {name: JUDGED[name] for name in mechanism_models(mechanism)}


def mechanism_subject(context: Context) -> Subject:
    """Responses of all models of the run's mechanism and of what they are held against."""
    mechanism = context.robot_file.mechanism
    postures = path_postures(context)
    count = context.robot_file.requirement.modes
    found = {
        name: modes_of(partial(_vibration, context, postures, JUDGED[name], offered(count)))
        for name in mechanism_models(mechanism)
    }
    statics, static = _statics(context, postures)
    try:
        dynamics = dynamic_reference(context, postures, count)
    except UNSOLVED as error:
        dynamics = no_reference(error)
    dynamic = dynamic_ladders(context, postures, found, dynamics, count)
    candidates = [
        replace(
            _candidate(postures, name, found[name]),
            static_rungs=static.get(name, ()),
            dynamic_rungs=dynamic.get(name, ()),
        )
        for name in found
    ]
    return Subject(
        robot=mechanism.name,
        coordinates=coordinates(mechanism),
        poses=np.array([posture.pose for posture in postures]),
        weights=samples_of(mechanism).weights,
        candidates=candidates,
        statics=statics,
        dynamics=dynamics,
        notes=(
            *_path_note(mechanism, postures),
            *_idle_note(postures),
            *_parts_note(postures, count),
        ),
        bracket=bracketed_frequencies(dynamics, count, "in the middle of the path"),
        formulation=_on_equivalent_legs(context, postures),
    )


def _statics(
    context: Context, postures: Sequence[Posture]
) -> tuple[Reference, Mapping[str, Sequence[Rung]]]:
    """What deflections are held against, and what leads there, by model; none without solids."""
    try:
        reference = static_reference(context, postures)
    except UNSOLVED as error:
        return no_reference(error), {}
    return reference, static_ladders(context, postures)


def _on_equivalent_legs(context: Context, postures: tuple[Posture, ...]) -> Subject | None:
    """Statics of the models that put equivalent legs for given ones, against solids of those.

    None where no leg is given; nor beside parts, whose own idealisation would be in it.
    """
    mechanism = postures[0].mechanism
    if not has_given(mechanism) or mechanism.parts:
        return None
    member = on_equivalent_legs(mechanism)
    solids = [replace(posture, mechanism=member) for posture in postures]
    statics, ladders = _statics(context, solids)
    return Subject(
        robot="equivalent legs",
        coordinates=coordinates(mechanism),
        poses=np.array([posture.pose for posture in postures]),
        weights=np.zeros(0),
        candidates=[
            replace(
                _candidate(postures, name, Response()),
                static_rungs=ladders.get(name, ()),
                # Of frequencies nothing is asked here.
                silent=unanswered(postures, JUDGED[name].kind, JUDGED[name].options),
            )
            for name in mechanism_models(mechanism)
            if name not in LEGS_AS_GIVEN
        ],
        statics=statics,
        dynamics=Reference("none", ()),
    )


def _vibration(
    context: Context, postures: tuple[Posture, ...], model: JudgedModel, count: int
) -> Vibration | None:
    if model.kind in STATIC or unanswered(postures, model.kind, model.options):
        return None
    if model.kind == "simplified":
        return simplified_vibration(samples_of(postures[0].mechanism), postures, count)
    return context.get(model_vibration, postures, model.kind, model.options, count)


def _candidate(postures: tuple[Posture, ...], name: str, found: Response) -> Candidate:
    model = JUDGED[name]
    unable = unanswered(postures, model.kind, model.options)
    statics = Response()
    if not unable:
        statics = statics_of(partial(compliances, postures, model.kind, model.options))
    silent = _STATIC if model.kind in STATIC else ""
    if not silent and found.vibration is None and not found.unsolved_modes:
        silent = _NO_MASS
    return Candidate(
        model=name,
        title=model.title,
        response=together(statics, found),
        rigid=_RIGID if name == "simplified" else "",
        silent=unable or silent,
        computed_by=(f"validation.models.mechanism.answers({model.kind!r})",),
    )


def _path_note(mechanism: Mechanism, postures: tuple[Posture, ...]) -> tuple[str, ...]:
    if len(postures) == len(mechanism.poses):
        return ()
    return (f"{len(postures)} of the {len(mechanism.poses)} poses of the path were looked at",)


def _parts_note(postures: tuple[Posture, ...], judged: int) -> tuple[str, ...]:
    ends = next(iter(left_open(postures[0].mechanism).holds.values()))
    try:
        return reduction_note(postures, offered(judged), ends, judged)
    except UNSOLVED:
        return ()


def _idle_note(postures: tuple[Posture, ...]) -> tuple[str, ...]:
    idle = mobility(postures[0]).idle
    what = "mobilities do" if idle > 1 else "mobility does"
    return (f"{idle} idle {what} not move the tool; no frequency counts them",) if idle else ()
