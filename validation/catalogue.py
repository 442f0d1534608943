"""List of all cases, assessments and figures that a run can compute for a robot.

Input: a robot file and the variations of a request. Output: tasks. Rule: the robot decides which
tasks apply; the paper's statements belong to the paper's robot only.
"""

from collections.abc import Sequence

from lumped.robot_file import RobotFile
from lumped.robot_file.variation import Variation
from validation import paper
from validation.adequacy.robot_verdicts import robot_adequacy
from validation.cases import cases
from validation.comparisons import (
    convergence_cases,
    mesh_cases,
    part_models_vs_solid,
)
from validation.comparisons.checks import agreement_cases
from validation.maps.figure import figures as maps
from validation.maps.workspace import directions
from validation.measured.matrix import measured_matrix
from validation.paper.robot import is_paper_robot
from validation.references.robot_on_path import prismatic_legs
from validation.report.figures import curves, loads_and_responses, modes, pictures
from validation.run.outcome import Task
from validation.solids.solid_legs import SHARED_SOLIDS
from validation.variations.cases import cases_over
from validation.verdicts import ADEQUACY, MEASURED, Assessment

_ADEQUACY = Assessment(
    id=ADEQUACY,
    title="Adequacy of each model for each quantity",
    compute=robot_adequacy,
    group=SHARED_SOLIDS,
    effort=5.0,
)

_MEASURED = Assessment(
    id=MEASURED,
    title="Models compared with measured values",
    compute=measured_matrix,
    effort=2.0,
)


def catalogue(robot_file: RobotFile, variations: Sequence[Variation] = ()) -> Sequence[Task]:
    """All cases, assessments and figures for a robot, and those of its variations."""
    mechanism, limits = robot_file.mechanism, robot_file.agreement
    return (
        *(paper.cases() if is_paper_robot(robot_file) else ()),
        *agreement_cases(robot_file),
        *part_models_vs_solid.cases(
            parts=part_models_vs_solid.parts_as_legs(mechanism), limits=limits
        ),
        *mesh_cases.cases(legs=prismatic_legs(mechanism)),
        *convergence_cases.cases(bodies=convergence_cases.subjects(mechanism), limits=limits),
        *cases(mechanism, robot_file.requirement.modes),
        *([_MEASURED] if robot_file.measured else []),
        _ADEQUACY,
        *pictures.portraits(),
        *convergence_cases.figures(),
        *curves.figures(),
        *(maps() if directions(mechanism) else ()),
        *pictures.figures(),
        *modes.figures(),
        *loads_and_responses.figures(robot_file),
        *(paper.figures() if is_paper_robot(robot_file) else ()),
        *(cases_over(robot_file, variations) if variations else ()),
        *curves.figures_over(variations),
    )
