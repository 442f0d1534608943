"""The biglide with its models and references, ready to be judged."""

from collections.abc import Mapping
from dataclasses import replace

from lumped.biglide import with_equivalent_legs
from validation.adequacy.biglide.dynamics import biglide_dynamics
from validation.adequacy.biglide.leg import MODELS as LEG_MODELS
from validation.adequacy.biglide.leg import leg_subject
from validation.adequacy.biglide.statics import biglide_statics
from validation.adequacy.matrix import Coordinate
from validation.adequacy.models import JUDGED, JudgedModel
from validation.adequacy.subject.posed import Posed
from validation.context import Context

POSTURES = 9
CANDIDATES: Mapping[str, JudgedModel] = {
    "simplified": JUDGED["simplified"]._replace(title="elastic drives, rigid legs"),
    **{name: JUDGED[name] for name in LEG_MODELS},
}


def posed_biglide(context: Context) -> Posed:
    """The run's robot over its stroke, with its models and its legs alone.

    Raises ComputationError where a posture that all models share is none of the robot.
    """
    robot = context.robot
    x = robot.stations(POSTURES)
    statics = biglide_statics(context, robot, x)
    return Posed(
        name=robot.name,
        coordinates=(Coordinate("x", "m"),),
        poses=x[:, None],
        models=CANDIDATES,
        statics=statics,
        dynamics=biglide_dynamics(context, robot, context.robot_file.requirement.modes, POSTURES),
        equivalent=replace(biglide_statics(context, with_equivalent_legs(robot), x), digits=None)
        if statics.given
        else None,
        rigid="its legs are rigid and its drives move along y alone: it knows no such motion",
        middle=f"at x = {robot.centre:.4g} m",
        computed_by="validation.models.biglide.robot_compliance",
        parts=(
            leg_subject(context, robot.leg1, "leg 1"),
            leg_subject(context, robot.leg2, "leg 2"),
        ),
    )
