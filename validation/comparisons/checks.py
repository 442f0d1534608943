"""Checks of agreement and convergence of a robot, as pytest and the Python interface run them.

Input: a robot file. Output: a list of named checks, each with a function that returns its verdict
and a text. Rule: the limits are those of table [agree] of the robot file. `agrees[beam-solid-f1]`
compares beams and solids of the whole robot, `agrees[leg1-beam-solid-f1]` those of one leg;
`converged[segments-f1-20]` and `converged[leg1-segments-f1-20]` contain the element count.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from lumped.acceptance.requirement import AgreementLimits
from lumped.robot_file import RobotFile
from validation.case import Case, Skip
from validation.comparisons import leg_beam_vs_solid, line_leg_vs_solid, robot_beam_vs_solid
from validation.comparisons.agreement_rows import agreement_row
from validation.comparisons.convergence_cases import JUDGED, study_of, subjects
from validation.comparisons.convergence_study import ConvergenceStudy
from validation.comparisons.element_convergence import QUANTITIES
from validation.comparisons.requested import leg_names
from validation.context import Context
from validation.drawing.text import percent, quantity_name
from validation.models.options import RefinedModel
from validation.references.robot_on_path import prismatic_legs
from validation.run.outcome import Outcome, Verdict, judge


@dataclass(frozen=True)
class Checked:
    """Verdict of a check, with its numbers as text, one on each line."""

    verdict: Verdict
    text: str


@dataclass(frozen=True)
class Check:
    """A named check. `compute` raises Skip, with the reason, if nothing can be compared."""

    name: str
    compute: Callable[[Context], Checked]


def agreement_cases(robot_file: RobotFile) -> tuple[Case, ...]:
    """Comparisons of all formulations with solids: of the robot, then of each distinct leg."""
    mechanism, limits = robot_file.mechanism, robot_file.agreement
    of_robot = robot_beam_vs_solid.cases(limits=limits) if leg_names(mechanism) else ()
    return (
        *of_robot,
        *leg_beam_vs_solid.cases(legs=prismatic_legs(mechanism), limits=limits),
        *line_leg_vs_solid.cases(mechanism=mechanism, limits=limits),
    )


def checks(robot_file: RobotFile) -> tuple[Check, ...]:
    """All checks of a robot: agreement with solids, then convergence with the element count."""
    limits = robot_file.agreement
    agreement = [
        Check(
            f"agrees[{_within(case.body)}{case.model}-solid-{quantity_name(case.label)}]",
            partial(_agrees, case),
        )
        for case in agreement_cases(robot_file)
    ]
    convergence = [
        Check(
            f"converged[{_within(body)}{model}-{quantity}-{limits.elements}]",
            partial(_converged, body, model, quantity),
        )
        for body in sorted(subjects(robot_file.mechanism), key=bool)
        for model in JUDGED
        for quantity in QUANTITIES
    ]
    return (*agreement, *convergence)


def _within(body: str) -> str:
    return f"{body}-" if body else ""


def _agrees(case: Case, context: Context) -> Checked:
    outcome = judge(case, case.measure(context), 0.0)
    return Checked(outcome.verdict, agreement_text(outcome))


def agreement_text(outcome: Outcome) -> str:
    """Text of a comparison: values, difference, named causes, half-width and limit."""
    row = agreement_row(outcome)
    causes = ", ".join(f"{cause} {percent(share)}" for cause, share in row.causes.items())
    return _block(
        f"{row.body}, {row.quantity}, {row.model} compared with solid FE: {row.verdict}",
        value=f"{row.value:.6g} {row.unit}",
        reference=f"{row.reference:.6g} {row.unit}",
        difference=percent(row.difference),
        explained=causes or "nothing",
        unexplained=(
            f"{percent(row.unexplained)} (tolerance {percent(row.tolerance, signed=False)})"
        ),
        **{"half-width": percent(row.half_width, signed=False)},
    )


def _converged(body: str, model: RefinedModel, quantity: str, context: Context) -> Checked:
    return convergence_check(study_of(context, body), model, quantity, context.robot_file.agreement)


def convergence_check(
    study: ConvergenceStudy, model: RefinedModel, quantity: str, limits: AgreementLimits
) -> Checked:
    """Check of the discretisation errors of a model in one quantity.

    The errors must be within the limit at the element count of `limits` and at all higher counts.
    Raises Skip if that element count was not computed. For example, the count of a stepped leg must
    be a multiple of the number of its pieces.
    """
    series, column = study.of(model), study.column(quantity)
    if limits.elements not in series.counts:
        listed = ", ".join(map(str, series.counts))
        raise Skip(
            f"agree.elements = {limits.elements}: not among the computed numbers of elements; "
            f"must be one of {listed}"
        )
    fine = series.counts.index(limits.elements)
    row = fine + int(np.argmax(np.abs(series.errors[fine:, column])))
    error, half_width = series.errors[row, column], series.limit_half_widths[column]
    verdict: Verdict = "undecided"
    if abs(error) + half_width <= limits.convergence:
        verdict = "agree"
    elif not abs(error) - half_width <= limits.convergence:
        verdict = "disagree"
    unit = study.units[column]
    text = _block(
        f"{study.subject or 'robot'}, {quantity} by {model} with {limits.elements} elements or "
        f"more: {verdict}",
        value=f"{series.values[row, column]:.6g} {unit} with {series.counts[row]} elements",
        reference=f"{series.limits[column]:.6g} {unit}, {study.reference}",
        difference=f"{percent(error)} (allowed {percent(limits.convergence, signed=False)})",
        explained="not applicable, both sides have the same legs",
        **{"half-width": f"{percent(half_width, signed=False)} of the reference"},
    )
    return Checked(verdict, text)


def _block(heading: str, **lines: str) -> str:
    rows = [f"  {name:<12} {text}" for name, text in lines.items()]
    return "\n".join([heading, *rows]).replace("\N{NO-BREAK SPACE}", " ")
