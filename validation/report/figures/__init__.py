"""The figures of a run: curves of all models in the same axes, pictures of the robot, studies.

Curves and pictures are computed in the run like cases (`PlannedFigure`); plots of studies and
budgets are drawn when the page is made, from what the cases brought.
"""

from collections.abc import Sequence

from lumped.robot_file import RobotFile
from lumped.robot_file.variation import Variation
from validation.exhibits import PlannedFigure


def figures_of(robot_file: RobotFile) -> tuple[PlannedFigure, ...]:
    """The figures of a robot, in the order of the report."""
    return _of_mechanism() if robot_file.is_mechanism else _of_biglide()


def figures_of_program() -> tuple[PlannedFigure, ...]:
    """The figures of what verifies the program."""
    from validation.report.figures.curves import refinement  # noqa: PLC0415

    return refinement.figures()


def figures_of_variations(variations: Sequence[Variation]) -> tuple[PlannedFigure, ...]:
    """The figures of the numbers of the robot file that a run varies."""
    from validation.report.figures.mechanism.variations import figures_over  # noqa: PLC0415

    return figures_over(variations)


def _of_mechanism() -> tuple[PlannedFigure, ...]:
    from validation.report.figures.mechanism import (  # noqa: PLC0415
        curves,
        energies,
        pairs,
        pictures,
    )

    groups = (
        pictures.portraits,
        curves.figures,
        pictures.figures,
        pairs.figures,
        energies.figures,
    )
    return tuple(figure for group in groups for figure in group())


def _of_biglide() -> tuple[PlannedFigure, ...]:
    # The figures share results with the cases, whose package lists cases and figures together.
    from validation.report.figures.curves import energies  # noqa: PLC0415
    from validation.report.figures.mechanism import curves  # noqa: PLC0415
    from validation.report.figures.pictures import legs, robot  # noqa: PLC0415

    groups = (
        robot.portraits,
        curves.figures,
        energies.figures,
        energies.figures_of_solids,
        robot.figures,
        legs.of_leg1,
        legs.of_leg2,
    )
    return tuple(figure for group in groups for figure in group())
