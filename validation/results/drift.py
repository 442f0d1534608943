"""Drift: how far a value has moved from that of an earlier run.

References come from outside and decide the verdict; an earlier value is only our own and decides
nothing. A change of it is drift, never disagreement.
"""

from dataclasses import dataclass
from math import isfinite
from typing import Literal

import msgspec

from validation.results.records import CaseRecord

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
        """Value less earlier value."""
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
    before: CaseRecord, after: CaseRecord, what: Literal["value", "reference"] = "value"
) -> Drift | None:
    """Drift of a case's value or reference; None where one is not known, or is of another pose.

    The larger one of the known uncertainties of then and now is allowed, and a relative 1e-9 in any
    case. Where the reference is zero, a thousandth of the tolerance counts as rounding.
    """
    earlier, value = getattr(before, what), getattr(after, what)
    comparable = earlier is not None and value is not None and isfinite(value)
    if not comparable or not same_pose(before.pose, after.pose):
        return None
    known = [
        u for u in (before.numerical_uncertainty, after.numerical_uncertainty) if u is not None
    ]
    allowed = max([*known, _ROUNDING * max(abs(earlier), abs(value))])
    if after.reference == 0.0 and after.tolerance is not None:
        allowed = max(allowed, _OF_TOLERANCE * after.tolerance)
    return Drift(earlier, value, allowed)


def with_drift(record: CaseRecord, earlier: CaseRecord | None) -> CaseRecord:
    """The record of a case with what it has drifted from an earlier one, if that is known."""
    moved = drift(earlier, record) if earlier else None
    if moved is None:
        return record
    return msgspec.structs.replace(
        record,
        earlier=moved.earlier,
        drift=moved.amount,
        drift_allowed=moved.allowed,
        drifted=moved.beyond,
    )
