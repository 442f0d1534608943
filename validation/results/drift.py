"""Drift: how far a value has moved from that of an earlier run.

References come from outside and decide the verdict; an earlier value is only our own and decides
nothing. A change of it is drift, never disagreement.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

import msgspec

from validation.results.outcome import Outcome
from validation.results.records import CaseRecord, RunRecord

# Rounding differs between machines and library versions; far above it, far below any tolerance.
_ROUNDING = 1e-9
# A value held against zero has no size of its own to be relative to, only its tolerance.
_OF_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Drift:
    """From `earlier` to `value`; up to `allowed` (half-width, same unit) the two are the same."""

    earlier: float
    value: float
    allowed: float

    @property
    def amount(self) -> float:
        """Value less frozen value."""
        return self.value - self.earlier

    @property
    def beyond(self) -> bool:
        """Whether the value has moved by more than is allowed."""
        return abs(self.amount) > self.allowed


def same_pose(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    """Whether two poses are the same up to rounding, or one of them is not known."""
    if not (one and other):
        return True
    return len(one) == len(other) and all(
        abs(a - b) <= _ROUNDING * max(abs(a), abs(b), 1.0) for a, b in zip(one, other, strict=True)
    )


def drift(
    earlier: float,
    value: float,
    *,
    uncertainties: Sequence[float | None] = (),
    reference: float | None = None,
    tolerance: float | None = None,
) -> Drift:
    """Drift of a value from the one that was found earlier.

    The larger one of the known `uncertainties` of then and now is allowed, and a relative 1e-9 in
    any case. Where `reference` is zero, a thousandth of the `tolerance` counts as rounding.
    """
    known = [u for u in uncertainties if u is not None]
    allowed = max([*known, _ROUNDING * max(abs(earlier), abs(value))])
    if reference == 0.0 and tolerance is not None:
        allowed = max(allowed, _OF_TOLERANCE * tolerance)
    return Drift(earlier, value, allowed)


def drifts(outcomes: Sequence[Outcome], baseline: RunRecord) -> dict[str, Drift]:
    """Drift by case id, of the outcomes that have a value and an earlier one of the same pose."""
    earlier = baseline.by_id
    found = {}
    for outcome in outcomes:
        now, then = outcome.measurement, earlier.get(outcome.case.id)
        if now is None or then is None or then.value is None:
            continue
        if isfinite(now.value) and same_pose(then.pose, now.pose):
            found[outcome.case.id] = drift(
                then.value,
                now.value,
                uncertainties=(then.numerical_uncertainty, now.numerical_uncertainty),
                reference=now.reference,
                tolerance=outcome.tolerance,
            )
    return found


def no_longer_compared(outcomes: Sequence[Outcome], earlier: RunRecord | None) -> dict[str, str]:
    """By case id: why a comparison that agreed earlier is skipped now, and protects nothing."""
    agreed = {case.id for case in earlier.cases if case.verdict == "agree"} if earlier else set()
    return {
        outcome.case.id: outcome.result.message
        for outcome in outcomes
        if outcome.verdict == "skipped" and outcome.case.id in agreed
    }


def with_drift(record: CaseRecord, drift: Drift | None) -> CaseRecord:
    """The record of a case with what it has drifted, if that is known."""
    if drift is None:
        return record
    return msgspec.structs.replace(
        record,
        earlier=drift.earlier,
        drift=drift.amount,
        drift_allowed=drift.allowed,
        drifted=drift.beyond,
    )
