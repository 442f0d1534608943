"""Statements of the paper as cases, its figures with all models, and its errata.

The paper: S. Briot, A. Pashkevich, D. Chablat, "On the optimal design of parallel robots taking
into account their deformations and natural frequencies". Input: the robot file of the paper's
robot, the IFW demonstrator. All of this applies to that robot only. Output: verdicts on statements,
charts, findings.
"""

from validation.case import Case
from validation.paper import family, frequencies, statics
from validation.studies_and_figures import PlannedFigure


def cases() -> tuple[Case, ...]:
    """Cases on the paper's statements about stiffness and natural frequencies."""
    modules = (statics, frequencies, family)
    return tuple(case for module in modules for case in module.statements())


def figures() -> tuple[PlannedFigure, ...]:
    """The paper's Figs 3 to 13, with all models in the same axes."""
    # The plotting modules take half a second to import, and only a run needs them.
    from validation.paper.curves import family_figures, stroke_figures  # noqa: PLC0415

    return (*stroke_figures(), *family_figures())
