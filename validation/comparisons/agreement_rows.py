"""Comparisons with solids as rows of one table, with explained and unexplained difference.

Input: outcomes of comparisons. Output: `AgreementRow` records and a `ResultTable`: values,
difference, explained and unexplained part, half-width, tolerance and verdict.
"""

from collections.abc import Iterable, Mapping
from math import isnan, nan
from typing import Annotated, Literal

import msgspec

from validation.case import UnjudgedValue
from validation.drawing.text import quantity_name
from validation.record_fields import COLUMN, Column, columns_of
from validation.run.outcome import Outcome, Verdict
from validation.tables import Cell, ResultTable

# Decimals of percentages. Smaller digits are round-off.
_DECIMALS = 6


def _percentage(name: str) -> Column:
    """Column of the table, headed `name`, with numbers in per cent of the solid's value."""
    return Column(f"{name} (%)", percent=True)


class AgreementRow(msgspec.Struct, frozen=True, kw_only=True):
    """A formulation compared with the solid of the same leg or robot.

    The fields with a `Column` are the columns of the table and of CSV, in this order. Numbers are
    NaN if the comparison was skipped or failed.
    """

    # Name of the leg, "robot" for the whole robot.
    body: Annotated[str, COLUMN]
    model: Annotated[str, COLUMN]
    # Quantity by its name in typed input: "phi_x".
    quantity: Annotated[str, COLUMN]
    unit: Annotated[str, COLUMN]
    # Numbers of the formulation and of the solid, in `unit`.
    value: Annotated[float, COLUMN] = nan
    reference: Annotated[float, Column("solid")] = nan
    # Difference value − reference, the part of it with named causes, and the rest. All three are
    # relative to |reference|.
    difference: Annotated[float, _percentage("difference")] = nan
    explained: Annotated[float, _percentage("explained")] = nan
    unexplained: Annotated[float, _percentage("unexplained")] = nan
    # Half-width of `unexplained`, and the largest accepted size of `unexplained`. Both are relative
    # to |reference|.
    half_width: Annotated[float, _percentage("half-width")] = nan
    tolerance: Annotated[float, _percentage("tolerance")] = nan
    verdict: Annotated[Verdict | Literal["not judged"], COLUMN]
    # Named causes with the parts that they explain, relative to |reference|.
    causes: Mapping[str, float] = {}

    @property
    def detail(self) -> str:
        """Text with all numbers of the comparison."""
        causes = ", ".join(f"{cause} {percent(share)}" for cause, share in self.causes.items())
        return (
            f"{self.value:.6g} against {self.reference:.6g} {self.unit}, "
            f"{percent(self.difference)}; "
            f"explained: {causes or 'nothing'}; unexplained {percent(self.unexplained)} "
            f"± {percent(self.half_width).lstrip('+')}"
        )


def agreement_row(outcome: Outcome) -> AgreementRow:
    """Row of a comparison, without numbers if it was skipped or failed."""
    case, measurement = outcome.case, outcome.measurement
    row = AgreementRow(
        body=case.body or "robot",
        model=case.model,
        quantity=quantity_name(case.label),
        unit=case.unit,
        verdict=outcome.verdict,
    )
    if measurement is None:
        return row
    scale = abs(measurement.reference)
    difference, unexplained = measurement.difference / scale, measurement.unexplained / scale
    return msgspec.structs.replace(
        row,
        value=measurement.value,
        reference=measurement.reference,
        difference=difference,
        explained=difference - unexplained,
        unexplained=unexplained,
        half_width=(measurement.numerical_uncertainty or 0.0) / scale,
        tolerance=outcome.tolerance / scale,
        causes={allowance.cause: allowance.amount / scale for allowance in measurement.allowances},
    )


def agreement_rows(outcomes: Iterable[Outcome]) -> ResultTable:
    """Table with a row for each comparison of a formulation with a solid.

    The columns are those of `AgreementRow`. The last rows contain values by models of CAD parts,
    which are not judged and have no tolerance.
    """
    outcomes = tuple(outcomes)
    judged = [agreement_row(outcome) for outcome in outcomes if outcome.case.kind == "agreement"]
    unjudged = [
        _unjudged_row(outcome.case.body, value)
        for outcome in outcomes
        if outcome.measurement is not None
        for value in outcome.measurement.shown
    ]
    columns = columns_of(AgreementRow)
    return ResultTable(
        tuple(column.heading for column in columns.values()),
        tuple(
            tuple(_cell(getattr(row, name), column) for name, column in columns.items())
            for row in (*judged, *unjudged)
        ),
    )


def percent(share: float) -> str:
    """Text of the ratio `share` in per cent, with its sign and three digits."""
    return f"{100.0 * share:+.3g} %"


def _unjudged_row(body: str, value: UnjudgedValue) -> AgreementRow:
    return AgreementRow(
        body=body,
        model=value.model,
        quantity=quantity_name(value.label),
        unit=value.unit,
        value=value.value,
        reference=value.reference,
        difference=value.share,
        explained=0.0,
        unexplained=value.share,
        half_width=abs((value.half_width or 0.0) / value.reference),
        verdict="not judged",
    )


def _cell(value: str | float, column: Column) -> Cell:
    if isinstance(value, str):
        return value
    if isnan(value):
        return None
    return round(100.0 * value, _DECIMALS) if column.percent else value
