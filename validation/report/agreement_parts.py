"""Comparisons with solids of the same legs as one table, each difference in its parts."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from validation.case import UnjudgedValue
from validation.run.outcome import Outcome
from validation.tables import Cell, ResultTable

# Names of rotations as they are typed, by the labels of comparisons.
_TYPED: Mapping[str, str] = {"φx": "phi_x", "φy": "phi_y", "φz": "phi_z"}
# Decimals of percentages: smaller parts are round-off.
_DECIMALS = 6
HEADINGS = (
    *("body", "model", "quantity", "unit", "value", "solid"),
    *("difference (%)", "explained (%)", "unexplained (%)", "half-width (%)", "tolerance (%)"),
    "verdict",
)


@dataclass(frozen=True)
class DifferenceParts:
    """Value and reference of a comparison in `unit`; parts relative to the reference."""

    value: float
    reference: float
    unit: str
    difference: float
    explained: Mapping[str, float]
    unexplained: float
    half_width: float
    tolerance: float

    @property
    def whole_and_rest(self) -> tuple[float, float, float, float]:
        """Whole difference, unexplained part, half-width and tolerance."""
        return self.difference, self.unexplained, self.half_width, self.tolerance

    @property
    def detail(self) -> str:
        """The comparison in words."""
        causes = ", ".join(f"{cause} {percent(share)}" for cause, share in self.explained.items())
        return (
            f"{self.value:.6g} against {self.reference:.6g} {self.unit}, "
            f"{percent(self.difference)}; "
            f"explained: {causes or 'nothing'}; unexplained {percent(self.unexplained)} "
            f"± {percent(self.half_width).lstrip('+')}"
        )


def difference_parts(outcome: Outcome) -> DifferenceParts | None:
    """Relative parts of a comparison; None if it was skipped or failed."""
    measurement = outcome.measurement
    if measurement is None:
        return None
    scale = abs(measurement.reference)
    return DifferenceParts(
        measurement.value,
        measurement.reference,
        outcome.case.unit,
        measurement.difference / scale,
        {one.cause: one.amount / scale for one in measurement.allowances},
        measurement.unexplained / scale,
        (measurement.numerical_uncertainty or 0.0) / scale,
        outcome.tolerance / scale,
    )


def agreement_rows(outcomes: Iterable[Outcome]) -> ResultTable:
    """A row for each comparison of formulations: values, difference and its parts, verdict.

    Forms of CAD parts that are shown beside their solids follow, without tolerance and verdict.
    """
    outcomes = tuple(outcomes)
    judged = [_row(outcome) for outcome in outcomes if outcome.case.kind == "agreement"]
    shown = [
        _shown_row(outcome.case.body, value)
        for outcome in outcomes
        if outcome.measurement is not None
        for value in outcome.measurement.shown
    ]
    return ResultTable(HEADINGS, (*judged, *shown))


def quantity_name(label: str) -> str:
    """The quantity as it is typed: "phi_x" for "φx"."""
    return _TYPED.get(label, label)


def percent(share: float) -> str:
    """A share in percent with its sign and three digits."""
    return f"{100.0 * share:+.3g} %"


def _row(outcome: Outcome) -> tuple[Cell, ...]:
    case, parts = outcome.case, difference_parts(outcome)
    names = case.body or "robot", case.model, quantity_name(case.label), case.unit
    if parts is None:
        return (*names, *[None] * 7, outcome.verdict)
    explained = parts.difference - parts.unexplained
    difference, *rest = parts.whole_and_rest
    shares = _percentages((difference, explained, *rest))
    return (*names, parts.value, parts.reference, *shares, outcome.verdict)


def _shown_row(body: str, value: UnjudgedValue) -> tuple[Cell, ...]:
    half_width = abs((value.half_width or 0.0) / value.reference)
    shares = _percentages((value.share, 0.0, value.share, half_width))
    names = body, value.model, quantity_name(value.label), value.unit
    return (*names, value.value, value.reference, *shares, None, "not judged")


def _percentages(shares: Sequence[float]) -> list[float]:
    return [round(100.0 * share, _DECIMALS) for share in shares]
