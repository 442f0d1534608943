"""The adequacy of a robot's models, whatever its robot file describes."""

from lumped.robot_file import RobotFile
from validation.adequacy.judgement import judged
from validation.adequacy.matrix import Matrix
from validation.adequacy.mechanism.subject import mechanism_models, posed_mechanism
from validation.adequacy.response import Subject
from validation.adequacy.subject.subject import subject_of
from validation.context import Context


def judged_models(robot_file: RobotFile) -> tuple[str, ...]:
    """The models that a robot's matrix has, in its order."""
    return mechanism_models(robot_file.mechanism)


def robot_subject(context: Context) -> Subject:
    """The run's robot with its models and references. Raises Skip where there is no reference."""
    return subject_of(posed_mechanism(context))


def robot_adequacy(context: Context) -> Matrix:
    """The matrix of the run's robot. Raises Skip where no reference can be computed."""
    return judged(robot_subject(context), context.robot_file.requirement)
