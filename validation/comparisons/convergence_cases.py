"""Cases and figure on the convergence with element count, for each distinct leg and the robot.

Input: a robot file. Output: for each leg and formulation three verdicts: the order for many
elements equals the formal one; the error with 20 elements is below 1 %, as the paper states, or
below the limit that table [agree] sets; each half-width of the uncertainty is at least as large as
the error.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from lumped.acceptance.requirement import AgreementLimits
from lumped.legs import NoBeamTheoryError
from lumped.mechanism.mechanism import Mechanism
from lumped.models.bodies import legs_of
from lumped.robot_file import RobotFile
from meshes.part.slices import NotPrismaticError
from validation.case import Absolute, Elsewhere, Measurement, Relation, Skip
from validation.case_group import CaseGroup
from validation.comparisons.convergence_chart import convergence_chart
from validation.comparisons.convergence_study import ConvergenceStudy
from validation.comparisons.discretisations import PARAMETERS
from validation.comparisons.element_convergence import QUANTITIES
from validation.comparisons.requested import convergence, leg_names
from validation.context import Context
from validation.drawing.chart import Chart
from validation.drawing.figures import FigureGroup
from validation.models.options import RefinedModel
from validation.models.stepped_parts import PIECES
from validation.references.robot_on_path import distinct_legs
from validation.studies_and_figures import CONVERGENCE

GROUP = "convergence"
FIGURE = "robot.element-convergence"
# Formulations with verdicts, each with the accepted deviation of an observed order from the formal
# one. Few element counts show the fourth order: lower ones are too coarse, and at higher ones the
# error is round-off. The paper's literal layout is plotted beside them without a verdict.
ORDER_TOLERANCE: Mapping[RefinedModel, float] = {"segments": 0.05, "beam": 0.1}
JUDGED = tuple(ORDER_TOLERANCE)
# Smallest element count whose half-width is judged. Lower ones are outside the asymptotic range.
_FINE = 5


def subjects(mechanism: Mechanism) -> tuple[str, ...]:
    """Names of the distinct legs, then "" for the whole robot. () for a robot without legs."""
    names = leg_names(mechanism)
    representatives = distinct_legs(mechanism)
    distinct = [name for name in names if name in representatives or name in mechanism.parts]
    return (*distinct, "") if names else ()


def study_of(context: Context, body: str) -> ConvergenceStudy:
    """Convergence study of a leg, or of the whole robot if `body` is "".

    Raises Skip, with the reason, if beam theory does not apply to a leg or a CAD part has no
    prismatic sections. Any other exception is an error of the program and is passed on.
    """
    study = context.get(_study, context.robot_file, body)
    if isinstance(study, str):
        raise Skip(study)
    return study


def _study(robot_file: RobotFile, body: str) -> ConvergenceStudy | str:
    """Convergence study, or a text with the reason why beams do not apply.

    The study is by Timoshenko's theory. For a leg that is not a CAD part it also has series by the
    theory of Euler and Bernoulli.
    """
    try:
        study = convergence(robot_file, body=body or None)
        if body not in legs_of(robot_file.mechanism):
            return study
        without_shear = convergence(robot_file, body=body, theory="euler-bernoulli")
    except (NoBeamTheoryError, NotPrismaticError) as error:
        return f"no beam elements for {body or 'the robot'}: {error}"
    return replace(study, series=(*study.series, *without_shear.series))


cases = CaseGroup(
    over={
        "body, subject_name, about": lambda bodies: [
            (body, body or "robot", "leg" if body else "robot") for body in bodies
        ],
        "model": JUDGED,
    },
    section=CONVERGENCE,
    group=GROUP,
    kind="convergence",
    reference_kind="closed-form",
    subject=lambda about: about,
    figure=FIGURE,
    unit="1",
    effort=0.4,
)


@cases.case(
    "{subject_name}.converged[{model}-order]",
    "{subject_name}: frequencies by {model} converge with their formal order",
    quantity="order in 1/n of f1, and of f2 to f4, for many elements",
    label="{model}: order",
    citation="formal order of the formulation; exact cantilever (Huang 1961) or limit of the beams",
    tolerance=lambda model: Absolute(ORDER_TOLERANCE[model]),
    tolerance_reason="three element counts above round-off determine an order to a few hundredths",
)
def _order(context: Context, body: str, model: RefinedModel) -> Measurement:
    series = study_of(context, body).of(model)
    frequencies = [k for k, name in enumerate(QUANTITIES) if name not in "xyz"]
    ordered = [k for k in frequencies if not np.isnan(series.orders[k])]
    if not ordered:
        behaviours = ", ".join(f"{QUANTITIES[k]} {series.behaviour(k)}" for k in frequencies)
        raise Skip(f"no frequency shows an order of convergence: {behaviours}")
    (order, half_width), *others = (series.asymptotic_order(k) for k in ordered)
    return Measurement(
        order,
        series.formal_order,
        value_uncertainty=half_width,
        notes=(f"the value is the order of {QUANTITIES[ordered[0]]}",),
        elsewhere=tuple(
            Elsewhere(QUANTITIES[k], order, series.formal_order, half_width)
            for k, (order, half_width) in zip(ordered[1:], others, strict=True)
        ),
        decides="with more elements the errors are round-off, and with fewer the order varies",
    )


@cases.case(
    "{subject_name}.converged[{model}-{limits.elements}]",
    lambda subject_name, model, limits: (
        f"{subject_name}: error of {model} with {limits.elements} elements or more is at "
        f"most {100.0 * limits.convergence:g} %"
    ),
    quantity="largest relative error of f1 to f4, x, y, z with {limits.elements} elements or more",
    label="error with {limits.elements} elements",
    citation=(
        "Briot, Pashkevich and Chablat: less than 1 % with 20 elements per leg; another "
        "limit can be set in [agree] of the robot file"
    ),
    relation=Relation.AT_MOST,
    tolerance=lambda limits: Absolute(1e-2 * limits.convergence),
    tolerance_reason="a hundredth of the limit",
    elements=lambda limits: limits.elements,
)
def _stated_error(
    context: Context, body: str, model: RefinedModel, limits: AgreementLimits
) -> Measurement:
    series = study_of(context, body).of(model)
    if limits.elements not in series.counts:
        raise Skip(
            f"agree.elements = {limits.elements}: must be a multiple of {PIECES}, the "
            "number of pieces of a stepped CAD part"
        )
    errors = series.largest_errors[series.counts.index(limits.elements)]
    worst = int(np.argmax(errors))
    return Measurement(
        float(errors[worst]),
        limits.convergence,
        value_uncertainty=float(series.limit_half_widths[worst]),
        notes=(f"the largest value is that of {QUANTITIES[worst]}",),
    )


@cases.case(
    "{subject_name}.converged[{model}-half-width]",
    "{subject_name}: uncertainty intervals of {model} contain the limit of convergence",
    quantity="largest error over half-width of f1 to f4, x, y, z, from 5 elements on",
    label="{model}: error over half-width",
    citation="exact cantilever (Huang 1961) or limit of the beam elements",
    relation=Relation.AT_MOST,
    tolerance=Absolute(1e-9),
    tolerance_reason="the half-width includes round-off and the uncertainty of the limit",
)
def _half_width(context: Context, body: str, model: RefinedModel) -> Measurement:
    series = study_of(context, body).of(model)
    # The first count has no coarser one and therefore no half-width.
    asymptotic_rows = [row for row, count in enumerate(series.counts) if row and count >= _FINE]
    shares = np.abs(series.errors[asymptotic_rows]) / series.half_widths[asymptotic_rows]
    worst = int(np.argmax(shares.max(axis=0)))
    return Measurement(
        float(shares.max()),
        1.0,
        exact=True,
        notes=(f"the largest value is that of {QUANTITIES[worst]}",),
    )


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
    drawn = [
        name
        for name in _ROWS
        if not all(s.exact[study.column(name)] for study in studies for s in study.series)
    ]
    panels = [study.panel(name) for name in drawn for study in studies]
    limits = context.robot_file.agreement
    chart = convergence_chart(panels, PARAMETERS["elements"].axis, limits, columns=len(studies))
    captioned = chart.captioned(*_caption(studies, len(bodies) - 1 - len(legs)))
    records = [record for body in bodies for record in study_of(context, body).studies()]
    return replace(captioned, studies=records)


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
