"""A model of one's own in the matrix of verdicts: legs by the diagonal of their 6×6 compliance.

A `Model` has a function that returns its statics for a robot under one reading of its file. It is
judged like the models of flexproof: with causes, half-widths and the limits of the robot file.
"""

from dataclasses import replace

import numpy as np

from lumped.legs import given_compliance
from lumped.mechanism.kinematics.postures import reference_posture
from lumped.robot_file import load_robot
from validation.adequacy.judgement import verdict_matrix
from validation.adequacy.robot_verdicts import static_subject
from validation.context import Context
from validation.references.model_ladder import GIVEN
from validation.references.reference import Step
from validation.references.reference_parts import assembled
from validation.references.responses import Model
from validation.references.robot_on_path import Reading, RobotOnPath, robot_at
from validation.responses.statics_and_modes import Statics


def without_couplings(robot: RobotOnPath, _: Reading) -> Statics:
    """Statics of the robot with legs that have no coupling between forces and other motions."""
    springs = {name: np.diag(np.diag(given_compliance(leg))) for name, leg in robot.legs.items()}
    return assembled(robot.postures, springs)


ifw = load_robot("ifw")
robot = robot_at(Context(ifw, "quick"), [reference_posture(ifw.mechanism)])
diagonal = Model("diagonal", "legs by the diagonal of their 6×6", statics=without_couplings)
to_reference = Step("couplings of the 6×6 neglected", "links with the specified 6×6", GIVEN)
subject = static_subject(robot, [diagonal])
matrix = verdict_matrix(
    replace(subject, static_steps={"diagonal": [to_reference]}), ifw.requirement
)
turning = matrix.entry("diagonal", "phi_z")
assert turning.verdict == "inadequate"
assert np.isclose(turning.error, 0.4264, atol=1e-4)
assert [cause.cause for cause in turning.causes] == ["couplings of the 6×6 neglected"]
