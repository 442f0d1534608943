"""Every number of the matrix recomputed from the raw responses by a second, plain rule."""

from functools import cache

import numpy as np
import pytest
from plain_judgement import Rule
from random_subjects import MODES, subject

from lumped.acceptance.requirement import Requirement
from validation.adequacy.judgement import REST, judged

LIMITS = (0.02, 0.2)
SEEDS = range(3)


@cache
def entries(seed):
    """Entries of the matrices of a random subject, each with the plain rule for it."""
    found, pairs = subject(seed), []
    models = {one.model: one for one in found.candidates}
    for limit in LIMITS:
        matrix = judged(found, Requirement(deflection=limit, frequency=limit, modes=MODES))
        pairs += [(e, Rule(found, models[e.model], e.quantity, MODES)) for e in matrix.entries]
    return pairs


def same(found, expected):
    """Whether words are the same, numbers up to rounding, and None where there is none."""
    if isinstance(expected, str):
        return found == expected
    if isinstance(expected, dict):
        return found == pytest.approx(expected, abs=1e-12)
    both = np.array(found, float), np.array(expected, float)
    return np.allclose(*both, rtol=1e-9, atol=1e-12, equal_nan=True)


@pytest.mark.parametrize("seed", SEEDS)
def test_verdict_pose_interval_causes_and_remedy(seed):
    for entry, rule in entries(seed):
        expected = rule.entry(entry.limit)
        shares = expected.pop("causes", None)
        for name, value in expected.items():
            said = f"{name} of {entry.model} {entry.quantity} {entry.limit}"
            assert same(getattr(entry, name), value), said
        if entry.signed:
            assert entry.along is None
        if shares is not None:
            explained(entry, shares)


def explained(entry, shares):
    """Causes are the plain ones of half a percent and more, the largest first."""
    named = {name.replace("rest", REST): s for name, s in shares.items() if abs(s) >= 0.005}
    assert {one.cause: one.share for one in entry.causes} == pytest.approx(named)
    sizes = [abs(one.share) for one in entry.causes]
    assert sizes == sorted(sizes, reverse=True)
    for one in entry.causes:
        source = "the error minus" if one.cause == REST else f"from {one.cause}"
        assert one.source.startswith(source)


def test_all_that_can_be_said_comes_up():
    """Verdicts of every kind, modes that lack, another order, remedies that help and do not."""
    seen = [entry for seed in SEEDS for entry, _ in entries(seed)]
    assert {entry.verdict for entry in seen} == {"adequate", "inadequate", "undecided"}
    assert any(entry.error is None for entry in seen)
    assert any(entry.quantity == "order" and entry.error for entry in seen)
    off = [entry for entry in seen if entry.verdict == "inadequate"]
    assert {bool(entry.remedy) for entry in off} == {True, False}
    assert any((entry.error_with_remedy or 0.0) > entry.limit for entry in off)
    assert len({len(entry.causes) for entry in off}) > 2
