"""Verdicts by a table written by hand, and of measurements at random by the rule written again."""

from collections.abc import Mapping
from dataclasses import replace
from math import inf, nan, sqrt

import numpy as np

from validation.case import Absolute, Allowance, Case, Measurement, Relation, Relative, Tolerance
from validation.cases.program.judgement.claims import claims, same
from validation.context import Context
from validation.results.outcome import Verdict, judge, perturbed
from validation.sweeps.decision import kendall, spearman

_RANDOM = 300
_RULE = "README, what the verdict means: E less the allowances within the tolerance, and so its "
_RULE += "uncertainty"


def probe(tolerance: Tolerance, relation: Relation = Relation.EQUAL) -> Case:
    """A case with nothing to compute."""
    return Case(
        id="probe",
        title="a probe",
        quantity="deflection",
        unit="µm",
        reference_kind="closed-form",
        citation="made up",
        tolerance=tolerance,
        tolerance_reason="made up",
        compute=_nothing,
        relation=relation,
    )


def _nothing(_context: Context) -> Measurement:
    return Measurement(0.0, 0.0, exact=True)


# By columns: relation, value, reference, allowance, three uncertainties, verdict; the
# tolerance is 1 % of the reference, 2 and 4 being references.
_TABLE: tuple[tuple[str, float, float, float, tuple[float | None, ...], Verdict], ...] = (
    ("=", 2.019, 2.0, 0.0, (None, None, None), "agree"),
    ("=", 1.981, 2.0, 0.0, (None, None, None), "agree"),
    ("=", 2.021, 2.0, 0.0, (None, None, None), "disagree"),
    ("=", 1.979, 2.0, 0.0, (None, None, None), "disagree"),
    ("=", 4.039, 4.0, 0.0, (None, None, None), "agree"),
    ("=", 4.041, 4.0, 0.0, (None, None, None), "disagree"),
    ("=", -4.039, -4.0, 0.0, (None, None, None), "agree"),
    ("=", 2.1, 2.0, 0.1, (None, None, None), "agree"),
    ("=", 1.9, 2.0, -0.1, (None, None, None), "agree"),
    ("=", 2.1, 2.0, -0.1, (None, None, None), "disagree"),
    ("=", 2.0, 2.0, 0.1, (None, None, None), "disagree"),
    ("=", 2.1, 2.0, 0.05, (None, None, None), "disagree"),
    ("<", 1.0, 2.0, 0.0, (None, None, None), "agree"),
    ("<", 2.019, 2.0, 0.0, (None, None, None), "agree"),
    ("<", 2.021, 2.0, 0.0, (None, None, None), "disagree"),
    (">", 3.0, 2.0, 0.0, (None, None, None), "agree"),
    (">", 1.981, 2.0, 0.0, (None, None, None), "agree"),
    (">", 1.979, 2.0, 0.0, (None, None, None), "disagree"),
    ("=", 2.001, 2.0, 0.0, (0.019, None, None), "agree"),
    ("=", 2.001, 2.0, 0.0, (0.021, None, None), "undecided"),
    ("=", 2.001, 2.0, 0.0, (None, 0.021, None), "undecided"),
    ("=", 2.001, 2.0, 0.0, (0.015, 0.015, None), "undecided"),
    ("=", 2.001, 2.0, 0.0, (0.013, 0.013, None), "agree"),
    ("=", 2.001, 2.0, 0.0, (0.9, 0.9, 0.01), "agree"),
    ("=", 2.001, 2.0, 0.0, (0.001, 0.001, 0.021), "undecided"),
    ("=", 2.03, 2.0, 0.0, (0.019, None, None), "disagree"),
    ("=", 2.03, 2.0, 0.0, (0.025, None, None), "undecided"),
    ("=", 2.06, 2.0, 0.0, (0.025, None, None), "disagree"),
    ("=", nan, 2.0, 0.0, (None, None, None), "disagree"),
    ("<", -inf, 2.0, 0.0, (None, None, None), "disagree"),
)
_SIGNS = {"=": Relation.EQUAL, "<": Relation.AT_MOST, ">": Relation.AT_LEAST}


@claims("rules", "Verdicts are those of a table written by hand", _RULE)
def _by_hand(_context: Context) -> Mapping[str, bool]:
    found = {}
    for sign, value, reference, allowed, (u, v, w), wanted in _TABLE:
        measured = Measurement(
            value,
            reference,
            u,
            v,
            w,
            (Allowance("made up", allowed),),
            exact=(u, v, w) == (None, None, None),
        )
        outcome = judge(probe(Relative(0.01), _SIGNS[sign]), measured, 0.0)
        found[f"{value} {sign} {reference}, {allowed} allowed, {u} {v} {w}: {wanted}"] = (
            outcome.verdict == wanted
        )
    measured = Measurement(3.0, 2.0, 0.3, 0.4, None, (Allowance("a", 0.6), Allowance("b", -0.1)))
    amount = judge(probe(Absolute(0.6)), measured, 0.0)
    return found | {
        "3 − 2 = 1": same(measured.difference, 1.0),
        "1 − 0.6 + 0.1 = 0.5": same(measured.unexplained, 0.5),
        "√(0.3² + 0.4²) = 0.5": same(measured.numerical_uncertainty, 0.5),
        "the judged difference's own uncertainty": same(
            replace(measured, judged_uncertainty=0.2).numerical_uncertainty, 0.2
        ),
        "nothing discretised": Measurement(3.0, 2.0, exact=True).numerical_uncertainty is None,
        "0.5 of 0.6 µm": same(amount.share, 0.5 / 0.6),
        "0.6 µm of 2 µm": same(amount.tolerance, 0.6),
        "1 % of −2 µm": same(Relative(0.01).at(-2.0), 0.02),
        "a sound case turns": perturbed(amount, 3.0) == "disagree",
        "a sound case stays": perturbed(amount, 0.0) == "agree",
        "a lower reference is worse for what is above": Relation.EQUAL.adverse(0.5) == -1.0,
        "a higher one for what is below": Relation.EQUAL.adverse(-0.5) == 1.0,
        "a lower bound is worse for what must be at most": Relation.AT_MOST.adverse(-1.0) == -1.0,
        "a higher one for what must be at least": Relation.AT_LEAST.adverse(1.0) == 1.0,
    }


@claims("rules-random", "Verdicts on measurements at random are those of the rule", _RULE)
def _at_random(_context: Context) -> Mapping[str, bool]:
    rng = np.random.default_rng(12)
    found = {}
    for number in range(_RANDOM):
        reference, share = float(rng.uniform(0.5, 5.0)), float(10.0 ** rng.uniform(-4.0, -1.0))
        limit = share * reference
        parts = rng.uniform(-0.2, 0.2, 2) * reference
        left = float(rng.uniform(-2.5, 2.5) * limit)
        own, other = (rng.uniform(0.0, 0.9, 2) * limit).tolist()
        relation = list(Relation)[number % 3]
        measured = Measurement(
            value=reference + float(parts.sum()) + left,
            reference=reference,
            value_uncertainty=own,
            reference_uncertainty=other,
            allowances=tuple(Allowance("made up", float(part)) for part in parts),
        )
        wrong = {"equal": abs(left), "at most": left, "at least": -left}[relation.value]
        spread = sqrt(own * own + other * other)
        if spread > limit and wrong - limit <= spread:
            wanted = "undecided"
        else:
            wanted = "agree" if wrong <= limit else "disagree"
        outcome = judge(probe(Relative(share), relation), measured, 0.0)
        # Differences of numbers of the size of the reference lose digits.
        found[f"measurement {number}"] = (
            outcome.verdict == wanted
            and same(outcome.tolerance, limit)
            and abs(outcome.share - wrong / limit) < 1e-9
            # Beyond the tolerance on the adverse side, whatever the uncertainty below twice that.
            and (wanted != "agree" or perturbed(outcome, 4.5) == "disagree")
            and relation.excess(left - relation.adverse(left)) > relation.excess(left)
        )
        nothing = Measurement(nan, reference, value_uncertainty=own)
        never = judge(probe(Relative(share), relation), nothing, 0.0).verdict
        found[f"not a number {number}"] = never == "disagree"
    return found


@claims(
    "ranks",
    "Ranks of designs are those counted by hand",
    "C. Spearman, Am. J. Psychol. 15 (1904) 72; M. G. Kendall, Biometrika 30 (1938) 81",
)
def _ranks(_context: Context) -> Mapping[str, bool]:
    one = (1.0, 2.0, 3.0, 4.0, 5.0)
    # ρ = 1 − 6 Σd²/n(n² − 1), τ = (pairs alike − unlike)/10: two neighbours exchanged twice.
    other = (2.0, 1.0, 3.0, 5.0, 4.0)
    return {
        "ρ of two exchanges is 0.8": same(spearman(one, other), 0.8),
        "τ of two exchanges is 0.6": same(kendall(one, other), 0.6),
        "ρ of the reverse is −1": same(spearman(one, one[::-1]), -1.0),
        "τ of the reverse is −1": same(kendall(one, one[::-1]), -1.0),
    }


@claims(
    "ranks-random",
    "Ranks of designs at random are those of their definitions",
    "the same, computed from ranks and from pairs",
)
def _ranks_at_random(_context: Context) -> Mapping[str, bool]:
    rng = np.random.default_rng(13)
    found = {}
    for number in range(10):
        one, other = rng.standard_normal((2, 9))
        ranks = [np.argsort(np.argsort(values)) for values in (one, other)]
        rho = float(np.corrcoef(ranks[0], ranks[1])[0, 1])
        signs = [
            np.sign(values[:, None] - values)[np.triu_indices(9, 1)] for values in (one, other)
        ]
        found[f"ρ of designs {number}"] = same(spearman(one, other), rho, 1e-9)
        found[f"τ of designs {number}"] = same(
            kendall(one, other), float(np.mean(signs[0] * signs[1])), 1e-9
        )
    return found
