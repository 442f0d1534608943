"""Verdicts of comparisons whose reference is shifted: a valid comparison then disagrees."""

from dataclasses import replace
from math import isfinite

from validation.case import Relation
from validation.run.outcome import Outcome, Verdict, verdict


def perturbed(outcome: Outcome, factor: float) -> Verdict:
    """Verdict for a reference that is shifted by `factor` tolerances so that the difference grows.

    The tolerance keeps its absolute value. A valid comparison disagrees for a factor of three.
    """
    measurement, relation = outcome.measurement, outcome.case.relation
    if measurement is None:
        return outcome.verdict
    below = relation is Relation.AT_MOST or measurement.unexplained >= 0.0
    down = relation is not Relation.AT_LEAST and below
    shift = (-factor if down else factor) * outcome.tolerance
    shifted = replace(measurement, reference=measurement.reference + shift)
    return verdict(
        shifted.unexplained, relation, outcome.tolerance, measurement.numerical_uncertainty
    )


def assert_agrees_and_can_disagree(outcome: Outcome) -> None:
    """Assert that a comparison agrees, has an uncertainty, and disagrees if shifted.

    The shift of the reference is three tolerances.
    """
    details = outcome.case.id, outcome.measurement, outcome.message
    assert outcome.verdict == "agree", details
    assert outcome.measurement is not None
    assert outcome.share is not None
    # Where one side alone is claimed, from where the claim on its first number would just hold.
    excess = outcome.case.relation.excess(outcome.measurement.unexplained) / outcome.tolerance
    assert perturbed(outcome, max(0.0, -excess) + 3.0) == "disagree", details
    assert outcome.measurement.exact or isfinite(outcome.measurement.numerical_uncertainty), details
