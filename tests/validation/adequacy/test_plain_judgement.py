"""Every number of the matrix recomputed from the raw responses by a second, plain rule."""

from functools import cache

import numpy as np
import pytest
from plain_judgement import Rule
from random_subjects import MODES, subject

from lumped.acceptance.requirement import Requirement
from validation.adequacy.judgement import REST, judged
from validation.adequacy.matrix import Entry

LIMITS = (0.01, 0.05, 0.3)
SEEDS = range(3)


@cache
def entries(seed: int, limit: float) -> list[tuple[Entry, Rule]]:
    """Every entry of the matrix of a random subject with the plain rule for it."""
    found = subject(seed)
    matrix = judged(found, Requirement(deflection=limit, frequency=limit, modes=MODES))
    models = {one.model: one for one in found.candidates}
    return [(one, Rule(found, models[one.model], one.quantity, MODES)) for one in matrix.entries]


def same(found: list[float | None], expected: list[float | None]) -> bool:
    """Whether numbers are the same up to rounding, and None where None is expected."""
    both = list(zip(found, expected, strict=True))
    if any((one is None) != (other is None) for one, other in both):
        return False
    return all(
        one is None or one == pytest.approx(other, rel=1e-9, abs=1e-12) for one, other in both
    )


@pytest.mark.parametrize("seed", SEEDS)
def test_verdict_pose_interval_causes_and_remedy(seed: int) -> None:
    found = subject(seed)
    for limit in LIMITS:
        for entry, rule in entries(seed, limit):
            said = f"{entry.model} {entry.quantity} {limit}"
            verdict, pose, path = rule.answer(limit)
            assert entry.verdict == verdict, said
            assert entry.pose == tuple(found.poses[pose]), said
            if entry.error is None:
                assert path[pose].missing, said
                continue
            assert [entry.error, entry.uncertainty] == pytest.approx(
                [path[pose].middle, path[pose].half], rel=1e-9, abs=1e-12
            ), said
            for p, one in enumerate(path):
                known = [entry.errors[p], entry.spreads[p]]
                assert same(known, [None] * 2 if one.missing else [one.middle, one.half]), said
            alone = [rule.numbers(one, k, pose) for k, one in enumerate(rule.model)]
            if entry.signed:
                assert entry.along is None
            elif entry.quantity != "any_force":
                assert entry.along == pytest.approx(np.mean([one["along"] for one in alone]))
                assert entry.value == pytest.approx(alone[0]["value"])
            spreads = [rule.spread(one, k, pose) for k, one in enumerate(alone)]
            parts = {"meshes": max(spreads)}
            if entry.quantity == "order":
                parts = {"meshes": path[pose].half}
            elif rule.reference.open:
                errors = [one["error"] for one in alone]
                parts[rule.reference.open] = 0.5 * (max(errors) - min(errors))
            assert entry.uncertainties == pytest.approx(parts, abs=1e-12), said
            for p, value in enumerate(entry.values):
                of_pose = rule.numbers(rule.candidate.response, 0, p)["value"]
                assert value is None or value == pytest.approx(of_pose), said
            explain(entry, rule, pose, said)
            if verdict == "inadequate":
                remedy, left = rule.remedy(limit, pose)
                assert entry.remedy == remedy, said
                assert same([entry.error_with_remedy], [left]), said
            else:
                assert (entry.remedy, entry.error_with_remedy) == ("", None)


def explain(entry: Entry, rule: Rule, pose: int, said: str) -> None:
    """Causes are the plain ones of half a percent and more, the largest first."""
    if entry.verdict == "adequate":
        assert entry.causes == (), said
        return
    shares = rule.causes(pose)
    expected = {name.replace("rest", REST): s for name, s in shares.items() if abs(s) >= 0.005}
    assert {one.cause: one.share for one in entry.causes} == pytest.approx(expected), said
    sizes = [abs(one.share) for one in entry.causes]
    assert sizes == sorted(sizes, reverse=True), said
    assert sum(shares.values()) == pytest.approx(1.0)
    for one in entry.causes:
        assert one.source.startswith(
            "the error minus" if one.cause == REST else f"from {one.cause}"
        )


def test_all_that_can_be_said_comes_up() -> None:
    """Verdicts of every kind, modes that lack, another order, remedies that help and do not."""
    seen = [entry for seed in SEEDS for limit in LIMITS for entry, _ in entries(seed, limit)]
    assert {entry.verdict for entry in seen} == {"adequate", "inadequate", "undecided"}
    assert any(entry.error is None for entry in seen)
    assert any(entry.quantity == "order" and entry.error for entry in seen)
    off = [entry for entry in seen if entry.verdict == "inadequate"]
    assert {bool(entry.remedy) for entry in off} == {True, False}
    assert any((entry.error_with_remedy or 0.0) > entry.limit for entry in off)
    assert len({len(entry.causes) for entry in off}) > 2
