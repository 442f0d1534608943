"""Guards of the last mile, which every comparison shares: judging, uncertainties, units, tables.

What judges the models would judge its own mistakes too: these guards fail where a claim breaks.
"""

from validation.cases.program.judgement import orders, pages, quantities, rules
from validation.cases.program.judgement.claims import cases

__all__ = ["cases", "orders", "pages", "quantities", "rules"]
