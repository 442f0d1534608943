"""The chapter "Cross-validation" of a report, computed in this process."""

from contextlib import suppress

from validation.case import Case, Skip
from validation.catalogue import catalogue
from validation.comparisons.convergence_cases import study_of, subjects
from validation.context import Context
from validation.cross_validation import CrossValidation
from validation.results.outcome import Outcome
from validation.session.runner import execute


def cross_validation(context: Context) -> CrossValidation:
    """All formulations of the same legs, compared as a run with this preset compares them.

    A comparison that is skipped or fails is an outcome with its reason. A leg whose elements do
    not apply has no convergence study. Raises ComputationError, InputError if a study fails.
    """
    comparisons = [
        Outcome(task, execute(task, context))
        for task in catalogue(context.robot_file)
        if isinstance(task, Case) and task.kind == "agreement" and context.preset in task.presets
    ]
    studies = {}
    for body in subjects(context.robot_file.mechanism):
        with suppress(Skip):
            studies[body] = study_of(context, body)
    return CrossValidation(context.robot_file.name, tuple(comparisons), studies)
