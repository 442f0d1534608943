"""Published benchmarks: problems whose answers stand in the literature, and exact beams.

Beams, sections and solids are each held against numbers that others computed.
"""

from validation.case import Case
from validation.cases.program.benchmarks import beams, cross, huang, sections, solids


def cases() -> tuple[Case, ...]:
    """All of them."""
    return (
        *beams.cases(),
        *cross.cases(),
        *huang.cases(),
        *sections.cases(),
        *solids.cases(),
    )
