"""The paper's statements, one case each, and what its figures say of robots with longer legs.

S. Briot, A. Pashkevich, D. Chablat, "On the optimal design of parallel robots taking into account
their deformations and natural frequencies". They hold for the IFW demonstrator alone.
"""

from validation.case import Case
from validation.paper import decision, family, frequencies, statics


def cases() -> tuple[Case, ...]:
    """One case for each statement about stiffness and frequencies."""
    tables = (statics, frequencies, family, decision)
    return tuple(statement.case() for table in tables for statement in table.STATEMENTS)
