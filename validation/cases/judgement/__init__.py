"""Guards of the last mile, which every comparison shares: judging, uncertainties, units, tables.

What judges the models would judge its own mistakes too: these guards fail where a claim breaks.
"""

from validation.case import Case
from validation.cases.judgement import orders, pages, rules


def cases() -> tuple[Case, ...]:
    """Those that no robot's data enter; `quantities` has the biglide's."""
    return (*rules.cases(), *orders.cases(), *pages.cases())
