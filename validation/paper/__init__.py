"""The paper: its statements, one case each, its figures with all models, and its errata.

S. Briot, A. Pashkevich, D. Chablat, "On the optimal design of parallel robots taking into account
their deformations and natural frequencies". They hold for the IFW demonstrator alone.
"""

from validation.case import Case
from validation.exhibits import PlannedFigure
from validation.paper import family, frequencies, statics


def cases() -> tuple[Case, ...]:
    """One case for each statement about stiffness and frequencies."""
    tables = (statics, frequencies, family)
    return tuple(case for table in tables for case in table.statements())


def figures() -> tuple[PlannedFigure, ...]:
    """Figures 3 to 13 with all models in the same axes."""
    # What draws takes half a second to import: only a run needs it.
    from validation.paper.curves import over_family, over_stroke  # noqa: PLC0415

    return (*over_stroke(), *over_family())
