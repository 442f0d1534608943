"""Cases on design decisions by models, for values of one number of the robot file.

Input: curves of all models and of the reference over a varied parameter. Output: two verdicts for
each model. Rule: a model decides well if the value that it chooses is within 1 % of the best by the
reference, and if its ranking of the values has a rank correlation of nearly 1 with that of the
reference.
"""

from collections.abc import Mapping, Sequence
from math import isnan

from lumped.errors import InputError
from lumped.robot_file import RobotFile
from lumped.robot_file.variation import Variation
from validation.adequacy.posture_errors import compared_models
from validation.case import Absolute, Case, Measurement, Skip
from validation.case_group import CaseGroup, Over
from validation.context import Context
from validation.studies_and_figures import PARAMETERS
from validation.variations.curves import VariedCurves, variation_study
from validation.variations.decision import MEANING, OBJECTIVES, UNITS, Decision, Objective

# Smallest number of designs for a choice, and for a rank correlation.
_FEWEST_TO_CHOOSE, _FEWEST_TO_RANK = 2, 3
_OVER_CHOICES: Over = {
    "objective": OBJECTIVES,
    "model": lambda models, objective: models[objective],
}
_OVER_RANKINGS: Over = {
    "objective": OBJECTIVES,
    "model": lambda models, objective, count: models[objective] if count >= _FEWEST_TO_RANK else (),
}

_cases = CaseGroup(
    section=PARAMETERS,
    group="vary.{number}",
    figure="vary.{number}.decision",
    reference_kind="finer-model",
    citation="the same robots by their reference (solid legs, 6×6 compliance of the file, CAD "
    "parts), at the values of --vary only",
    effort=0.1,
)


def cases_over(robot_file: RobotFile, variations: Sequence[Variation]) -> tuple[Case, ...]:
    """Cases for each varied parameter and each model on which the robot file relies.

    If it relies on none, the cases are for all models except the simplified one, which does not
    depend on the legs.
    """
    rely = robot_file.requirement.rely
    models: dict[Objective, list[str]] = {}
    for objective, names in zip(OBJECTIVES, compared_models(robot_file.mechanism), strict=True):
        relied = [name for name in names if name in rely]
        models[objective] = relied or [name for name in names if name != "simplified"]
    cases: list[Case] = []
    for number, variation in enumerate(variations, start=1):
        if (count := len(variation.values)) >= _FEWEST_TO_CHOOSE:
            cases += _cases(variation=variation, number=number, models=models, count=count)
    return tuple(cases)


def varied_curves(context: Context, variation: Variation) -> Mapping[Objective, VariedCurves]:
    """Curves of all models over a variation, computed once for all cases and figures.

    Raises Skip if one of the robots has no reference.
    """
    try:
        return variation_study(context.robot_file, variation, context.preset)
    except InputError as error:
        raise Skip("; ".join(error.faults)) from error


@_cases.case(
    "decision.{objective}.loss.{model}[{variation.key}]",
    "The {variation.key} that {model} chooses by {objective} is as good as the best",
    over=_OVER_CHOICES,
    kind="decision",
    model=lambda model: model,
    label=lambda variation, objective: f"choice of {variation.key} by {objective}",
    quantity=lambda objective: f"loss in {MEANING[objective]}, by the reference",
    unit="%",
    tolerance=Absolute(1.0),
    tolerance_reason="a design within 1 % of the best is good",
)
def _loss(context: Context, variation: Variation, objective: Objective, model: str) -> Measurement:
    decision = _decision(context, variation, objective, model)
    choice = decision.choice(model)
    best, unit = decision.reference[decision.best], UNITS[objective]
    return Measurement(
        100.0 * choice.loss,
        reference=0.0,
        reference_uncertainty=100.0 * decision.loss_uncertainty(choice.design),
        notes=(
            f"{model} chooses {variation.values[choice.design]:.6g}, the reference "
            f"{variation.values[decision.best]:.6g} ({best:.4g} {unit}).",
            *_indifference(variation, choice.equally_good),
        ),
    )


@_cases.case(
    "decision.{objective}.order.{model}[{variation.key}]",
    "By {objective}, {model} ranks the values of {variation.key} in the right order",
    over=_OVER_RANKINGS,
    quantity="Spearman's rank correlation with the reference",
    unit="1",
    tolerance=lambda count: Absolute(18.0 / (count * (count**2 - 1))),
    tolerance_reason="one and a half exchanges of neighbours among n designs, 12/(n(n² − 1)) each",
)
def _order(context: Context, variation: Variation, objective: Objective, model: str) -> Measurement:
    decision = _decision(context, variation, objective, model)
    correlation, uncertainty = decision.correlation(model)
    if isnan(correlation):
        raise Skip(
            f"{model} or its reference rates all values of {variation.key} as equal, so that their "
            "order cannot be compared"
        )
    return Measurement(correlation, reference=1.0, reference_uncertainty=uncertainty)


def _decision(context: Context, variation: Variation, objective: Objective, model: str) -> Decision:
    decision = varied_curves(context, variation)[objective].decision
    if model not in decision.models:
        raise Skip(f"{model} has no solution for some value of {variation.key}")
    return decision


def _indifference(variation: Variation, designs: Sequence[int]) -> tuple[str, ...]:
    if len(designs) == 1:
        return ()
    values = ", ".join(f"{variation.values[design]:.6g}" for design in designs)
    return (f"This model rates {values} as equal; the one that the reference rates best counts.",)
