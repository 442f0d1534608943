"""The adequacy of a robot's models, and of the models of each of its legs by itself, root clamped.

What feet, joints and other legs hide, the leg alone shows: torsion of open sections, say.
"""

from dataclasses import replace

import numpy as np

from lumped.mechanism.body import Given, Prism
from lumped.mechanism.joint import Joint, Side
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.mechanism.mechanism import GROUND, Mechanism, Tool
from lumped.mechanism.placing import leg_on, rigid_on
from lumped.robot_file import RobotFile
from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Matrix
from validation.adequacy.mechanism.path import distinct_legs
from validation.adequacy.mechanism.statics import mechanism_statics
from validation.adequacy.mechanism.subject import mechanism_models, posed_mechanism
from validation.adequacy.models import JUDGED
from validation.adequacy.response import Reference, Subject
from validation.adequacy.subject.subject import judged_statics, subject_of
from validation.context import Context

_ROOT, _TIP = "root", "tip"
# Rigid legs say nothing of a leg alone, and links are virtual joints there.
_LEFT_OUT = ("simplified", "links", "segments-stepped", "segments-condensed")


def judged_models(robot_file: RobotFile) -> tuple[str, ...]:
    """The models that a robot's matrix has, in its order."""
    return mechanism_models(robot_file.mechanism)


def robot_subject(context: Context) -> Subject:
    """The run's robot with its models and references. Raises Skip where there is no reference."""
    robot = subject_of(posed_mechanism(context))
    return replace(robot, parts=legs_alone(context, context.robot_file.mechanism))


def robot_adequacy(context: Context) -> Matrix:
    """The matrix of the run's robot. Raises Skip where no reference can be computed."""
    return judged(robot_subject(context), context.robot_file.requirement)


def legs_alone(context: Context, mechanism: Mechanism) -> tuple[Subject, ...]:
    """The legs of a mechanism and their models, statics alone; of alike ones the first."""
    shapes = {name: mechanism.bodies[name].shape for name in distinct_legs(mechanism)}
    return tuple(
        leg_subject(context, name, shape)
        for name, shape in shapes.items()
        if isinstance(shape, Prism | Given)
    )


def leg_alone(name: str, shape: Prism | Given) -> Mechanism:
    """A leg in its own axes, its first interface fixed to the ground, the tool at its second."""
    points = {_ROOT: np.zeros(3), _TIP: np.array([shape.length, 0.0, 0.0])}
    placed = [
        rigid_on(GROUND, [_ROOT], points, origin=np.zeros(3)),
        leg_on(name, shape, (_ROOT, _TIP), points),
    ]
    clamp = Joint("clamp", "fixed", Side(GROUND, _ROOT), Side(name, _ROOT), np.zeros((0, 3)))
    return Mechanism(
        name=name,
        bodies={one.name: one for one, _ in placed},
        joints=(clamp,),
        tool=Tool(name, _TIP),
        reference={one.name: frame for one, frame in placed},
        poses=np.zeros((1, 0)),
    )


def leg_subject(context: Context, name: str, shape: Prism | Given) -> Subject:
    """One leg and its models."""
    alone = leg_alone(name, shape)
    statics = mechanism_statics(context, [reference_posture(alone)])
    left_out = set(_LEFT_OUT) if statics.given else {*_LEFT_OUT, "vjm-equivalent"}
    models = {name: one for name, one in JUDGED.items() if name not in left_out}
    title = "the leg's own 6×6" if statics.given else "solid leg, root clamped"
    reference, candidates = judged_statics(
        replace(statics, title=title), models, "validation.models.mechanism.answers"
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
