"""Any mechanism with its models and references, ready to be judged."""

from dataclasses import replace

import numpy as np

from lumped.mechanism.kinematics.mobility import mobility
from lumped.mechanism.mechanism import Mechanism, Posture
from lumped.models.bodies import on_equivalent_legs
from validation.adequacy.mechanism.dynamics import mechanism_dynamics
from validation.adequacy.mechanism.part_solids import reduction_note
from validation.adequacy.mechanism.path import (
    coordinates,
    has_given,
    left_open,
    offered,
    path_postures,
)
from validation.adequacy.mechanism.statics import mechanism_statics
from validation.adequacy.models import JUDGED, JudgedModel
from validation.adequacy.response import UNSOLVED
from validation.adequacy.subject.posed import Posed, Statics
from validation.context import Context
from validation.models.parts import is_leg


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


def posed_mechanism(context: Context) -> Posed:
    """The run's mechanism on its path, with its models."""
    mechanism, postures = context.robot_file.mechanism, path_postures(context)
    count = context.robot_file.requirement.modes
    return Posed(
        name=mechanism.name,
        coordinates=coordinates(mechanism),
        poses=np.array([posture.pose for posture in postures]),
        models=mechanism_candidates(mechanism),
        statics=mechanism_statics(context, postures),
        dynamics=mechanism_dynamics(context, postures, count),
        equivalent=_equivalent(context, postures),
        rigid="its bodies and joints are rigid: the drives do not let the tool move so",
        middle="in the middle of the path",
        computed_by="validation.models.mechanism.answers",
        notes=(
            *_path_note(mechanism, postures),
            *_idle_note(postures),
            *_parts_note(postures, count),
        ),
    )


def _equivalent(context: Context, postures: tuple[Posture, ...]) -> Statics | None:
    """None where no leg is given; nor beside parts, whose own idealisation would be in it."""
    mechanism = postures[0].mechanism
    if not has_given(mechanism) or mechanism.parts:
        return None
    member = on_equivalent_legs(mechanism)
    statics = mechanism_statics(context, [replace(one, mechanism=member) for one in postures])
    # Both sides have these legs, feet and tool, whatever the robot's are.
    return replace(statics, digits=None)


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
