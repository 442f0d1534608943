"""Public functions of flexproof in Python, their results, and the errors that they raise.

import flexproof as fp

fp.converge("ifw", "segments", body="leg1").plot()
"""

from lumped.errors import ComputationError, InputError
from validation.api import (
    adequacy,
    compare_measured,
    converge,
    cross_validate,
    draw,
    export,
    forces,
    identify,
    identify_free,
    load,
    run,
    solve,
    vary,
    workspace,
)
from validation.comparisons.convergence_study import ConvergenceStudy
from validation.cross_validation import CrossValidation
from validation.forces.record import Forces
from validation.maps.figure import WorkspaceMaps
from validation.parts.free_modes import FreePart
from validation.parts.identify import Identified
from validation.python.judged import Adequacy, MeasuredComparison
from validation.python.runs_and_designs import Designs, Run
from validation.solve.answer import Solution
from validation.tables import ResultTable

__all__ = [
    "Adequacy",
    "ComputationError",
    "ConvergenceStudy",
    "CrossValidation",
    "Designs",
    "Forces",
    "FreePart",
    "Identified",
    "InputError",
    "MeasuredComparison",
    "ResultTable",
    "Run",
    "Solution",
    "WorkspaceMaps",
    "adequacy",
    "compare_measured",
    "converge",
    "cross_validate",
    "draw",
    "export",
    "forces",
    "identify",
    "identify_free",
    "load",
    "run",
    "solve",
    "vary",
    "workspace",
]
