"""The paper's statements, one case each, and what its figures say of robots with longer legs.

S. Briot, A. Pashkevich, D. Chablat, "On the optimal design of parallel robots taking into account
their deformations and natural frequencies". They hold for the IFW demonstrator alone.
"""

from validation.case import Case
from validation.cases.paper import family, frequencies, statics


def cases() -> tuple[Case, ...]:
    """One case for each statement about stiffness and frequencies."""
    said = (*statics.STATEMENTS, *frequencies.STATEMENTS, *family.STATEMENTS)
    return tuple(statement.case() for statement in said)
