"""Decisions by lumped models, judged by solid legs: the best length of the legs and its price."""

from functools import partial
from math import hypot

from validation.case import Absolute, Case, Measurement
from validation.cases.sweep_results import GROUP, PAPER, SECTION, decision_of
from validation.context import Context
from validation.decision import OBJECTIVES, UNITS, Decision, Objective
from validation.exhibits import Study
from validation.sweeps.plans import COARSE, RIGID

MEANING: dict[Objective, str] = {
    "deflection": "largest deflection over the stroke under 1000 N along x, y or z",
    "frequency": "smallest first frequency over the stroke",
}
FOLLOWED: dict[Objective, tuple[str, ...]] = {
    "deflection": ("VJM", "segments", "beam"),
    "frequency": ("segments", "beam"),
}
# The refined lumped model of the paper for each objective.
REFINED: dict[Objective, str] = {"deflection": "VJM", "frequency": "segments"}


def cases() -> tuple[Case, ...]:
    """Costs and ranks of the decisions by lumped models."""
    return (*_costs(), *_ranks(), *_prices())


def paper_cases() -> tuple[Case, ...]:
    """The paper's conclusion, with solid legs as the judge; for the paper's robot alone."""
    return (
        Case(
            id="paper.decision.longest",
            title="The simplified model has nothing against the longest legs",
            quantity="largest α among its best by deflection",
            unit="1",
            reference_kind="paper-statement",
            citation=PAPER,
            tolerance=Absolute(0.1),
            tolerance_reason="a tenth of the paper's range of α",
            compute=_longest,
            section=SECTION,
            group=GROUP,
            effort=0.1,
        ),
    )


def _costs() -> list[Case]:
    return [
        Case(
            id=f"decision.{objective}.cost[{label}]",
            title=f"The α that {label} chooses by {objective} is as good as the solid's own",
            quantity=f"loss in the solid's {MEANING[objective]}",
            unit="%",
            reference_kind="finer-model",
            citation="the best α of the robot with solid legs, rigid end faces, same search",
            tolerance=Absolute(1.0),
            tolerance_reason="a design within 1 % of the best is a good one",
            compute=partial(_cost, label=label, objective=objective),
            section=SECTION,
            group=GROUP,
            effort=1.0,
        )
        for objective in OBJECTIVES
        for label in FOLLOWED[objective]
    ]


def _ranks() -> list[Case]:
    return [
        Case(
            id=f"decision.{objective}.rank[{label}]",
            title=f"By {objective} {label} puts the designs into the solid's order",
            quantity="Spearman's rank correlation over the grid of α",
            unit="1",
            reference_kind="finer-model",
            citation="robot with solid legs, rigid end faces",
            tolerance=Absolute(0.06),
            tolerance_reason="one exchange of neighbours among six designs, 12/n(n² − 1)",
            compute=partial(_rank, label=label, objective=objective),
            section=SECTION,
            group=GROUP,
            effort=0.1,
        )
        for objective in OBJECTIVES
        for label in FOLLOWED[objective]
    ]


def _prices() -> list[Case]:
    return [
        Case(
            id=f"decision.{objective}.price",
            title=f"What the simplified model's α costs by {objective}: {REFINED[objective]} and "
            "solid agree",
            quantity=f"loss in {MEANING[objective]}",
            unit="%",
            reference_kind="finer-model",
            citation="the same loss in terms of the robot with solid legs",
            tolerance=Absolute(2.0),
            tolerance_reason="1 % for each of the two values that a loss compares",
            compute=partial(_price, objective=objective),
            section=SECTION,
            group=GROUP,
            effort=0.1,
        )
        for objective in OBJECTIVES
    ]


def _cost(context: Context, label: str, objective: Objective) -> Measurement:
    decision = decision_of(context)
    choice, own = decision.choices[label, objective], decision.choices[RIGID, objective]
    cost = 100.0 * decision.cost(label, objective, RIGID)
    return Measurement(
        cost,
        reference=0.0,
        value_uncertainty=_mesh_effect(decision, choice.best, objective),
        reference_uncertainty=100.0
        * hypot(
            decision.resolution(objective, RIGID),
            decision.sampling(own.best, objective, RIGID),
        ),
        notes=(
            f"{label} chooses α = {choice.best:.4g}, the solid {own.best:.4g} "
            f"({own.value:.4g} {UNITS[objective]}).",
            *_impossible(decision),
        ),
        studies=(objective_study(decision, objective),),
    )


def _mesh_effect(decision: Decision, alpha: float, objective: Objective) -> float | None:
    """Change (%) of the loss at α from the coarser mesh of the solids to the finer one."""
    if COARSE not in decision.values:
        return None
    fine, coarse = (decision.cost_at(alpha, objective, judge) for judge in (RIGID, COARSE))
    return 100.0 * abs(fine - coarse)


def _rank(context: Context, label: str, objective: Objective) -> Measurement:
    decision = decision_of(context)
    tau = decision.kendall(label, objective, RIGID)
    return Measurement(
        decision.spearman(label, objective, RIGID),
        reference=1.0,
        notes=(f"Kendall's τ = {tau:.3f} over {len(decision.alphas)} designs.",),
        studies=(objective_study(decision, objective),),
    )


def _price(context: Context, objective: Objective) -> Measurement:
    decision = decision_of(context)
    choice = decision.choices["simplified", objective]
    labels = [label for label, of in decision.choices if of == objective]
    shortest, longest = choice.indifferent
    at_longest = 100.0 * decision.cost_at(longest, objective, RIGID)
    costs = tuple(100.0 * decision.cost(label, objective, RIGID) for label in labels)
    return Measurement(
        100.0 * decision.cost("simplified", objective, REFINED[objective]),
        100.0 * decision.cost("simplified", objective, RIGID),
        notes=(
            f"To the simplified model all α from {shortest:.4g} to {longest:.4g} are equally good; "
            f"the shortest of them, α = {choice.best:.4g}, is held in its favour. The longest, "
            f"α = {longest:.4g}, costs {at_longest:.3g} % in the solid's terms.",
            *_impossible(decision),
        ),
        table={
            "model": tuple(labels),
            "best α": tuple(decision.choices[label, objective].best for label in labels),
            f"its own value ({UNITS[objective]})": tuple(
                decision.choices[label, objective].value for label in labels
            ),
            "loss in the solid's terms (%)": costs,
            "Spearman's ρ": tuple(decision.spearman(label, objective, RIGID) for label in labels),
            "Kendall's τ": tuple(decision.kendall(label, objective, RIGID) for label in labels),
        },
        studies=(objective_study(decision, objective),),
    )


def _longest(context: Context) -> Measurement:
    decision = decision_of(context)
    shortest, longest = decision.choices["simplified", "deflection"].indifferent
    solid = decision.choices[RIGID, "deflection"].best
    return Measurement(
        longest,
        reference=decision.alphas[-1],
        notes=(f"Equally good from α = {shortest:.4g} on; the solid's best is α = {solid:.4g}.",),
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
