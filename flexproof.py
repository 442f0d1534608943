"""Public functions of flexproof in Python, their results, and the errors that they raise.

import flexproof as fp

fp.converge("ifw", "segments", body="leg1").plot()
"""

from lumped.errors import ComputationError, InputError
from validation.api import (
    Adequacy,
    Run,
    adequacy,
    converge,
    cross_validate,
    load,
    run,
    solve,
)
from validation.comparisons.convergence_study import ConvergenceStudy
from validation.cross_validation import CrossValidation
from validation.solve.answer import Solution
from validation.tables import ResultTable

__all__ = [
    "Adequacy",
    "ComputationError",
    "ConvergenceStudy",
    "CrossValidation",
    "InputError",
    "ResultTable",
    "Run",
    "Solution",
    "adequacy",
    "converge",
    "cross_validate",
    "load",
    "run",
    "solve",
]
