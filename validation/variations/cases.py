"""Decisions by models over a number of the robot file, judged by the reference: cases of a run."""

from collections.abc import Mapping, Sequence
from math import isnan

from lumped.errors import InputError
from lumped.robot_file import RobotFile
from lumped.robot_file.variation import Variation
from validation.adequacy.compared import compared_models
from validation.case import Absolute, Case, Measurement, Skip
from validation.case_group import CaseGroup, Over
from validation.context import Context
from validation.exhibits import PARAMETERS
from validation.variations.curves import VariedCurves, variation_study
from validation.variations.decision import MEANING, OBJECTIVES, UNITS, Decision, Objective

# Without two designs there is nothing to choose, without three no order that says anything.
_TO_CHOOSE, _TO_ORDER = 2, 3
_BY: Over = {"objective": OBJECTIVES, "model": lambda models, objective: models[objective]}
_IN_ORDER: Over = {
    "objective": OBJECTIVES,
    "model": lambda models, objective, count: models[objective] if count >= _TO_ORDER else (),
}

_cases = CaseGroup(
    section=PARAMETERS,
    group="vary.{number}",
    figure="vary.{number}.decision",
    reference_kind="finer-model",
    citation="the same robots with solids, given 6×6 and parts; the values as typed, none between",
    effort=0.1,
)


def cases_over(robot_file: RobotFile, variations: Sequence[Variation]) -> tuple[Case, ...]:
    """Cases of every number that is varied, of the models that the robot file relies on.

    Where it relies on none, of all but the simplified one, which says nothing of the legs.
    """
    rely = robot_file.requirement.rely
    models: dict[Objective, list[str]] = {}
    for objective, names in zip(OBJECTIVES, compared_models(robot_file.mechanism), strict=True):
        relied = [name for name in names if name in rely]
        models[objective] = relied or [name for name in names if name != "simplified"]
    found: list[Case] = []
    for number, variation in enumerate(variations, start=1):
        if (count := len(variation.values)) >= _TO_CHOOSE:
            found += _cases(variation=variation, number=number, models=models, count=count)
    return tuple(found)


def varied_curves(context: Context, variation: Variation) -> Mapping[Objective, VariedCurves]:
    """All models over the values of a variation, computed once for all that show them.

    Raises Skip where one of the robots has no reference.
    """
    try:
        return variation_study(context.robot_file, variation, context.preset)
    except InputError as error:
        raise Skip("; ".join(error.faults)) from error


@_cases.case(
    "decision.{objective}.loss.{model}[{variation.key}]",
    "The {variation.key} that {model} chooses by {objective} is as good as the best",
    over=_BY,
    quantity=lambda objective: f"loss in the reference's {MEANING[objective]}",
    unit="%",
    tolerance=Absolute(1.0),
    tolerance_reason="a design within 1 % of the best is a good one",
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
    "By {objective} {model} puts the values of {variation.key} into the right order",
    over=_IN_ORDER,
    quantity="Spearman's rank correlation with the reference",
    unit="1",
    tolerance=lambda count: Absolute(18.0 / (count * (count**2 - 1))),
    tolerance_reason="one and a half exchanges of neighbours among n designs, 12/(n(n² − 1)) each",
)
def _order(context: Context, variation: Variation, objective: Objective, model: str) -> Measurement:
    decision = _decision(context, variation, objective, model)
    correlation, uncertainty = decision.correlation(model)
    if isnan(correlation):
        raise Skip(f"all values of {variation.key} are equally good by {model} or its reference")
    return Measurement(correlation, reference=1.0, reference_uncertainty=uncertainty)


def _decision(context: Context, variation: Variation, objective: Objective, model: str) -> Decision:
    found = varied_curves(context, variation)[objective].decision
    if model not in found.models:
        raise Skip(f"{model} gives no answer for some value of {variation.key}")
    return found


def _indifference(variation: Variation, places: Sequence[int]) -> tuple[str, ...]:
    if len(places) == 1:
        return ()
    values = ", ".join(f"{variation.values[place]:.6g}" for place in places)
    return (f"{values} are equally good by this model; the best of them counts.",)
