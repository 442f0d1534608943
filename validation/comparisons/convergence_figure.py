"""Figure "Convergence with element count" of a run, for the legs and the whole robot.

Input: convergence studies of the robot and its legs. Output: a chart with caption and data.
"""

from collections.abc import Sequence
from dataclasses import replace

from validation.case import Skip
from validation.comparisons.convergence_cases import FIGURE, GROUP, study_of, subjects
from validation.comparisons.convergence_chart import ErrorPanel, convergence_chart
from validation.comparisons.convergence_study import ConvergenceStudy
from validation.comparisons.discretisations import PARAMETERS
from validation.context import Context
from validation.drawing.chart import Chart
from validation.drawing.figures import FigureGroup
from validation.studies_and_figures import CONVERGENCE

# Number of legs that are drawn beside the robot. All legs are judged and are in the data.
_MOST_LEGS = 2
_ROWS = ("f1", "f4", "z")

figures = FigureGroup(CONVERGENCE, GROUP)


@figures.figure(FIGURE, "Convergence with element count", effort=1.5)
def element_convergence(context: Context) -> Chart:
    """Chart with a column for each of the first `_MOST_LEGS` legs and one for the robot.

    The rows are quantities. A quantity is omitted if all formulations give its exact value.
    """
    bodies = subjects(context.robot_file.mechanism)
    if not bodies:
        raise Skip("the robot has no leg that can be divided into elements")
    legs, robot = bodies[:-1][:_MOST_LEGS], bodies[-1]
    studies = [study_of(context, body) for body in (*legs, robot)]
    drawn = [name for name in _ROWS if any(_has_errors(study, name) for study in studies)]
    panels: list[ErrorPanel] = [study.panel(name) for name in drawn for study in studies]
    limits = context.robot_file.agreement
    chart = convergence_chart(panels, PARAMETERS["elements"].axis, limits, columns=len(studies))
    captioned = chart.captioned(*_caption(studies, len(bodies) - 1 - len(legs)))
    records = [record for body in bodies for record in study_of(context, body).studies()]
    return replace(captioned, studies=records)


def _has_errors(study: ConvergenceStudy, quantity: str) -> bool:
    """True unless all formulations give the exact value of a quantity for every element count."""
    column = study.column(quantity)
    return not all(series.exact[column] for series in study.series)


def _caption(studies: Sequence[ConvergenceStudy], undrawn_legs: int) -> list[str]:
    elements = studies[0].agreement.elements
    subjects: dict[str, list[str]] = {}
    for study in studies:
        name = f"{study.subject} (root clamped)" if study.subject else "robot"
        subjects.setdefault(study.reference, []).append(name)
    references = "; ".join(f"{', '.join(names)}: {text}" for text, names in subjects.items())
    sentences = [
        (
            "Size of the relative error of each formulation over the number of elements per "
            f"leg. Reference: {references}. At the end of each curve: its observed order. At "
            f"{elements} elements: its error. Dashed: largest allowed error. Dotted: number of "
            "elements from which on the error must not exceed the allowed one. A formulation "
            "passes if its curve right of the dotted line is below the dashed line. Deflections "
            "that are exact for every number of elements are not drawn."
        ),
    ]
    if any(
        series.discretisation.theory == "euler-bernoulli"
        for study in studies
        for series in study.series
    ):
        sentences.append(
            "Euler–Bernoulli elements are drawn only if their errors differ visibly from "
            "those of Timoshenko elements."
        )
    sentences.append(
        f"Error of f1 with {elements} elements and, in brackets, the smallest numbers of "
        "elements for errors below 1 %, 0.1 % and 0.01 %:"
    )
    for study in studies:
        by_label = {
            series.discretisation.label: study.short_summary(series, 0) for series in study.series
        }
        summaries = [
            f"{series.discretisation.label} {by_label[series.discretisation.label]}"
            for series in study.series
            if series.discretisation.theory == "timoshenko"
            or by_label[series.discretisation.label]
            != by_label.get(series.discretisation.formulation)
        ]
        sentences.append(f"{study.subject or 'robot'}: {'; '.join(summaries)}.")
    if undrawn_legs:
        sentences.append(f"{undrawn_legs} more legs are compared but not drawn.")
    return sentences
