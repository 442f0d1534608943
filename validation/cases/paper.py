"""The paper's statements about stiffness and frequencies, one case each.

S. Briot, A. Pashkevich, D. Chablat, "On the optimal design of parallel robots taking into account
their deformations and natural frequencies". They hold for the IFW demonstrator alone.
"""

from validation.case import Case
from validation.cases import paper_family, paper_frequencies, paper_statics


def cases() -> tuple[Case, ...]:
    """One case for each statement."""
    statements = (
        *paper_statics.STATEMENTS,
        *paper_frequencies.STATEMENTS,
        *paper_family.STATEMENTS,
    )
    return tuple(statement.case() for statement in statements)
