"""The figures of a run: curves of all models in the same axes, pictures of the robot, studies.

Curves and pictures are computed in the run like cases (`PlannedFigure`); plots of studies and
budgets are drawn when the page is made, from what the cases brought.
"""

from collections.abc import Sequence

from lumped.robot_file.variation import Variation
from validation.exhibits import PlannedFigure


def figures_of_robot() -> tuple[PlannedFigure, ...]:
    """The figures of a robot, in the order of the report."""
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


def figures_of_variations(variations: Sequence[Variation]) -> tuple[PlannedFigure, ...]:
    """The figures of the numbers of the robot file that a run varies."""
    from validation.report.figures.mechanism.variations import figures_over  # noqa: PLC0415

    return figures_over(variations)
