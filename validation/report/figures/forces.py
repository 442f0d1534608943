"""Figures of forces and stresses over the path, one for each load of the robot file, by beams.

Input: a mechanism. Output: planned figures.
"""

from dataclasses import replace
from functools import partial

from lumped.mechanism.mechanism import Mechanism
from validation.case import Skip
from validation.context import Context
from validation.drawing.chart import Chart
from validation.drawing.figures import FigureGroup
from validation.forces.analysis import forces_in
from validation.kinematics.poses import postures_on_path
from validation.models.options import ModelOptions
from validation.references.robot_on_path import robot_at
from validation.studies_and_figures import PATH, PlannedFigure

# Parts condensed on their interfaces are exact in statics, whatever their number of interfaces.
_OPTIONS = ModelOptions(parts="condensed")


def figures(mechanism: Mechanism) -> tuple[PlannedFigure, ...]:
    """Planned figures of forces and stresses, one for each load of the robot file."""
    group = FigureGroup(PATH, "")
    for load in mechanism.loads:
        identity = f"mechanism.forces.{load.name}", f"Forces and stresses: {load.name}"
        group.figure(*identity, effort=1.0)(partial(_forces, load=load.name))
    return group()


def _forces(context: Context, load: str) -> Chart:
    mechanism = context.robot_file.mechanism
    loads = tuple(item for item in mechanism.loads if item.name == load)
    postures = postures_on_path(replace(mechanism, loads=loads), mechanism.poses)
    result = forces_in(robot_at(context, postures), "beam", _OPTIONS, part_meshes=False)
    if all(pose.loads[load] is None for pose in result.poses):
        raise Skip("the mechanism cannot move as the load requires")
    return result.chart(load)
