"""Decisions by lumped models, judged by solid legs: the best length of the legs and its price."""

from collections.abc import Callable, Sequence
from math import hypot, inf, nan

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide, scaled
from lumped.legs import equivalent_leg, tip_compliance
from lumped.models import vjm
from validation.case import Absolute, Allowance, Measurement, Relation, Relative
from validation.case_group import CaseGroup
from validation.context import Context
from validation.exhibits import LENGTHS, Study
from validation.solids.robots import two_meshes
from validation.studies.quantities import deflections_of
from validation.sweeps.decision import MEANING, OBJECTIVES, UNITS, Decision, Objective
from validation.sweeps.plans import COARSE, RIGID, stroke_stations
from validation.sweeps.studies import DECIDED, GROUP, PAPER, PLANS, decision_of

FOLLOWED: dict[Objective, tuple[str, ...]] = {
    "deflection": ("VJM", "segments", "beam"),
    "frequency": ("segments", "beam"),
}
# Of the section meshes that show what rigid faces take from torsion.
_SECTION_UNKNOWNS = 600
# The refined lumped model of the paper for each objective.
REFINED: dict[Objective, str] = {"deflection": "VJM", "frequency": "segments"}

cases = CaseGroup(
    presets=DECIDED, section=LENGTHS, group=GROUP, effort=0.1, figure="decision.objectives"
)
# The paper's conclusion, with solid legs as the judge. How well the lumped models decide is a
# finding about its legs (ν = 0, slenderness 2 to 5): thin walls or open sections, for which
# textbook constants are 10 % off, may well choose otherwise.
paper_cases = cases.like(reference_kind="finer-model", unit="%")
_OBJECTIVES = tuple((objective, MEANING[objective]) for objective in OBJECTIVES)


@paper_cases.case(
    "decision.{objective}.cost[{by}]",
    "The α that {by} chooses by {objective} is as good as the solid's own",
    over={"objective, meaning": _OBJECTIVES, "by": lambda objective: FOLLOWED[objective]},
    quantity="loss in the solid's {meaning}",
    citation="the best α of the robot with solid legs, rigid end faces, same search",
    tolerance=Absolute(1.0),
    tolerance_reason="a design within 1 % of the best is a good one",
    effort=1.0,
)
def _cost(context: Context, by: str, objective: Objective) -> Measurement:
    decision = decision_of(context)
    choice, own = decision.choices[by, objective], decision.choices[RIGID, objective]
    cost = 100.0 * decision.cost(by, objective, RIGID)
    return Measurement(
        cost,
        reference=0.0,
        value_uncertainty=_mesh_effect(context, decision, choice.best, objective),
        # Of a loss, which compares two designs that were looked at. What lies between the designs
        # is beyond both searches alike and no error of either.
        reference_uncertainty=100.0
        * _sampling_effect(decision, (choice.best, own.best), objective),
        notes=(
            f"{by} chooses α = {choice.best:.4g}, the solid {own.best:.4g} "
            f"({own.value:.4g} {UNITS[objective]}); between the designs of its search the solid "
            f"may gain another {100.0 * decision.resolution(objective, RIGID):.2g} %.",
            *_impossible(decision),
        ),
        studies=(objective_study(decision, objective),),
    )


def _sampling_effect(
    decision: Decision, alphas: tuple[float, float], objective: Objective
) -> float:
    """Relative error of a loss by the number of postures; none where both designs are one."""
    if alphas[0] == alphas[1]:
        return 0.0
    return hypot(*(decision.sampling(alpha, objective, RIGID) for alpha in alphas))


def _mesh_effect(context: Context, decision: Decision, alpha: float, objective: Objective) -> float:
    """What the meshes leave open (%) of the loss at α."""
    return _judged_coarsely(
        context, decision, lambda judge: 100.0 * decision.cost_at(alpha, objective, judge)
    )


def _judged_coarsely(context: Context, decision: Decision, number: Callable[[str], float]) -> float:
    """What the judging solids' mesh leaves open of a number, by the step from their coarser one."""
    if COARSE not in decision.values:
        return inf
    return PLANS[context.preset].refinement * abs(number(RIGID) - number(COARSE))


@paper_cases.case(
    "decision.{objective}.rank[{by}]",
    "By {objective} {by} puts the designs into the solid's order",
    over={"objective": OBJECTIVES, "by": lambda objective: FOLLOWED[objective]},
    quantity="Spearman's rank correlation over the grid of α",
    unit="1",
    citation="robot with solid legs, rigid end faces",
    tolerance=Absolute(0.06),
    tolerance_reason="one exchange of neighbours among six designs, 12/n(n² − 1)",
)
def _rank(context: Context, by: str, objective: Objective) -> Measurement:
    decision = decision_of(context)
    tau = decision.kendall(by, objective, RIGID)
    return Measurement(
        decision.spearman(by, objective, RIGID),
        reference=1.0,
        value_uncertainty=_judged_coarsely(
            context, decision, lambda judge: decision.spearman(by, objective, judge)
        ),
        notes=(f"Kendall's τ = {tau:.3f} over {len(decision.alphas)} designs.",),
        studies=(objective_study(decision, objective),),
    )


@paper_cases.case(
    "decision.{objective}.price",
    lambda objective: (
        f"What the simplified model's α costs by {objective}: {REFINED[objective]} and solid agree"
    ),
    over={"objective, meaning": _OBJECTIVES},
    quantity="{meaning}, at the simplified model's α in per cent of the best",
    citation="the same ratio in terms of the robot with solid legs",
    tolerance=Relative(0.02),
    tolerance_reason="1 % for each of the two values of the ratio",
)
def _price(context: Context, objective: Objective) -> Measurement:
    decision = decision_of(context)

    def in_per_cent_of_best(judge: str) -> float:
        loss = decision.cost("simplified", objective, judge)
        return 100.0 * (1.0 + loss if objective == "deflection" else 1.0 - loss)

    return Measurement(
        in_per_cent_of_best(REFINED[objective]),
        in_per_cent_of_best(RIGID),
        reference_uncertainty=_judged_coarsely(context, decision, in_per_cent_of_best),
        allowances=(_restraint(context, decision),) if objective == "deflection" else (),
        notes=(_indifference(decision, objective), *_impossible(decision)),
    )


def _restraint(context: Context, decision: Decision) -> Allowance:
    chosen, best = (decision.choices[label, "deflection"].best for label in ("simplified", "VJM"))
    postures = PLANS[context.preset].brief.postures
    (free, held), (free_best, held_best) = (
        context.get(largest_deflections, context.robot, alpha, postures) for alpha in (chosen, best)
    )
    return Allowance(
        cause="end faces kept plane and rigid: torsional warping restrained",
        amount=100.0 * (free / free_best - held / held_best),
        source="virtual joints with c44 of prisms of held end faces (fem.couplings.end_effects)",
    )


def largest_deflections(robot: Biglide, alpha: float, postures: int) -> tuple[float, float]:
    """Largest deflection (µm) of member α over its stroke by virtual joints.

    With the legs' own compliances, and with c44 of legs whose end faces are held (theory).
    """
    member = scaled(robot, alpha)
    legs = [equivalent_leg(leg) for leg in (member.leg1, member.leg2)]
    own = [tip_compliance(leg.timoshenko, leg.length) for leg in legs]
    held = [springs.copy() for springs in own]
    for springs, leg in zip(held, legs, strict=True):
        springs[3, 3] = two_meshes(leg, _SECTION_UNKNOWNS).fine.held[3, 3]
    x = stroke_stations(member, postures)

    def largest(pair: Sequence[Array]) -> float:
        found = deflections_of(
            np.array([vjm.compliance(member, at, (pair[0], pair[1])) for at in x])
        )
        return float(max(found.largest_planar, found.along_z.max()))

    return largest(own), largest(held)


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


@paper_cases.case(
    "paper.decision.longest",
    "The simplified model has nothing against the longest legs",
    quantity="largest α among its best by deflection",
    unit="1",
    reference_kind="paper-statement",
    citation=PAPER,
    tolerance=Absolute(0.1),
    tolerance_reason="a tenth of the paper's range of α",
)
def _longest(context: Context) -> Measurement:
    decision = decision_of(context)
    shortest, longest = decision.choices["simplified", "deflection"].indifferent
    solid = decision.choices[RIGID, "deflection"].best
    return Measurement(
        longest,
        reference=decision.alphas[-1],
        exact=True,
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
