"""Decisions by lumped models, judged by solid legs: the best length of the legs and its price."""

from collections.abc import Callable
from math import inf, nan

from validation.case import Absolute, Measurement, Relation
from validation.case_group import CaseGroup
from validation.context import Context
from validation.exhibits import LENGTHS, Study
from validation.sweeps.decision import MEANING, OBJECTIVES, UNITS, Decision, Objective
from validation.sweeps.plans import COARSE, RIGID
from validation.sweeps.studies import DECIDED, GROUP, PLANS, decision_of

cases = CaseGroup(
    presets=DECIDED, section=LENGTHS, group=GROUP, effort=0.1, figure="decision.objectives"
)
_OBJECTIVES = tuple((objective, MEANING[objective]) for objective in OBJECTIVES)


def _judged_coarsely(context: Context, decision: Decision, number: Callable[[str], float]) -> float:
    """What the judging solids' mesh leaves open of a number, by the step from their coarser one."""
    if COARSE not in decision.values:
        return inf
    return PLANS[context.preset].refinement * abs(number(RIGID) - number(COARSE))


@cases.case(
    "decision.{objective}.search",
    "No model's α by {objective} is better in the solid's terms than the solid's own",
    over={"objective, meaning": _OBJECTIVES},
    quantity="smallest loss in the solid's {meaning} of all choices",
    unit="%",
    reference_kind="closed-form",
    citation="a minimum: nothing that was looked at lies below it",
    tolerance=Absolute(1.0),
    tolerance_reason="the models halve about optima of their own and may come upon an α that the "
    "solid's search passed by: a design within 1 % of the best is a good one",
    relation=Relation.AT_LEAST,
)
def _smallest_loss(context: Context, objective: Objective) -> Measurement:
    decision = decision_of(context)
    labels = [label for label, of in decision.choices if of == objective]
    costs = tuple(100.0 * decision.cost(label, objective, RIGID) for label in labels)
    # A model to which all designs are one, or a single design, has no order to correlate.
    has_order = [len(set(decision.curve(label, objective))) > 1 for label in labels]
    return Measurement(
        min(costs),
        reference=0.0,
        value_uncertainty=_judged_coarsely(
            context,
            decision,
            lambda judge: min(100.0 * decision.cost(label, objective, judge) for label in labels),
        ),
        notes=(_indifference(decision, objective), *_impossible(decision)),
        table={
            "model": tuple(labels),
            "best α": tuple(decision.choices[label, objective].best for label in labels),
            f"its own value ({UNITS[objective]})": tuple(
                decision.choices[label, objective].value for label in labels
            ),
            "loss in the solid's terms (%)": costs,
            "Spearman's ρ": tuple(
                decision.spearman(label, objective, RIGID) if ordered else nan
                for label, ordered in zip(labels, has_order, strict=True)
            ),
            "Kendall's τ": tuple(
                decision.kendall(label, objective, RIGID) if ordered else nan
                for label, ordered in zip(labels, has_order, strict=True)
            ),
        },
        studies=(objective_study(decision, objective),),
    )


def _indifference(decision: Decision, objective: Objective) -> str:
    choice = decision.choices["simplified", objective]
    shortest, longest = choice.indifferent
    at_longest = 100.0 * decision.cost_at(longest, objective, RIGID)
    return (
        f"To the simplified model all α from {shortest:.4g} to {longest:.4g} are equally good; "
        f"the shortest of them, α = {choice.best:.4g}, is held in its favour. The longest, "
        f"α = {longest:.4g}, costs {at_longest:.3g} % in the solid's terms."
    )


def objective_study(decision: Decision, objective: Objective) -> Study:
    """The objective of all models over the grid of α."""
    labels = [label for label, of in decision.choices if of == objective]
    return Study(
        id=f"decision.{objective}",
        kind="sweep",
        title=f"{MEANING[objective]}, all models",
        x_label="relative leg length α",
        y_label=MEANING[objective],
        unit=UNITS[objective],
        x=decision.alphas,
        series={label: tuple(decision.curve(label, objective)) for label in labels},
        notes=_impossible(decision),
    )


def _impossible(decision: Decision) -> tuple[str, ...]:
    return tuple(f"Impossible: {fault}." for fault in decision.impossible)
