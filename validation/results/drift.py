"""Drift: how far a value has moved from the one this project found earlier.

References come from outside and decide the verdict; a frozen value is the project's own earlier
result and decides nothing. A change of it is drift, never disagreement.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite

from validation.case import Outcome

# Rounding differs between machines and library versions; far above it, far below any tolerance.
_ROUNDING = 1e-9
# A value held against zero has no size of its own to be relative to, only its tolerance.
_OF_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Frozen:
    """A value that was found earlier, with its numerical uncertainty then (None: not known).

    `pose` is the one it belongs to, empty where there is none or nobody noted it.
    """

    value: float
    uncertainty: float | None = None
    pose: tuple[float, ...] = ()


@dataclass(frozen=True)
class Drift:
    """From `frozen` to `value`; up to `allowed` (half-width, same unit) the two are the same."""

    frozen: float
    value: float
    allowed: float

    @property
    def amount(self) -> float:
        """Value less frozen value."""
        return self.value - self.frozen

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
    frozen: Frozen,
    value: float,
    *,
    uncertainty: float | None = None,
    reference: float | None = None,
    tolerance: float | None = None,
) -> Drift:
    """Drift of a value whose numerical `uncertainty` is known, or of one that only rounds.

    The larger uncertainty of then and now is allowed, and a relative 1e-9 in any case. Where
    `reference` is zero, a thousandth of the `tolerance` counts as rounding.
    """
    known = [u for u in (frozen.uncertainty, uncertainty) if u is not None]
    allowed = max([*known, _ROUNDING * max(abs(frozen.value), abs(value))])
    if reference == 0.0 and tolerance is not None:
        allowed = max(allowed, _OF_TOLERANCE * tolerance)
    return Drift(frozen.value, value, allowed)


def drifts(outcomes: Sequence[Outcome], frozen: Mapping[str, Frozen]) -> dict[str, Drift]:
    """Drift by case id, of the outcomes that have a value and a frozen one of the same pose."""
    return {
        outcome.case.id: drift(
            frozen[outcome.case.id],
            outcome.measurement.value,
            uncertainty=outcome.measurement.numerical_uncertainty,
            reference=outcome.measurement.reference,
            tolerance=outcome.tolerance,
        )
        for outcome in outcomes
        if outcome.measurement
        and outcome.case.id in frozen
        and isfinite(outcome.measurement.value)
        and same_pose(frozen[outcome.case.id].pose, outcome.measurement.pose)
    }
