"""Guards of the last mile, which every comparison shares: judging, uncertainties, units, tables.

What judges the models would judge its own mistakes too: these guards fail where a claim breaks.
"""

from validation.case import Case
from validation.cases.program.judgement import orders, pages, quantities, rules


def cases() -> tuple[Case, ...]:
    """All of them."""
    return (*rules.cases(), *orders.cases(), *pages.cases(), *quantities.cases())
