"""Text and JSON of one convergence series.

Input: a `ConvergenceSeries` and the column of a quantity. Output: lines of text or a record.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import msgspec
import numpy as np
from msgspec import UNSET, UnsetType

from lumped.arrays import Array
from lumped.text import aligned
from validation.comparisons.convergence_series import ROUND_OFF, TARGETS, ConvergenceSeries
from validation.drawing.text import number, percent
from validation.record_fields import finite_items


class SeriesRecord(msgspec.Struct, frozen=True, omit_defaults=True, kw_only=True):
    """JSON object of a `ConvergenceSeries`. The key of each mapping is the name of a quantity.

    A missing order or half-width is None. `needed`: smallest element count for each of several
    accepted relative errors, by this error as text. It is None if the error at the highest count
    is larger.
    """

    model: str
    layout: str
    theory: str
    formal_order: float
    elements: Sequence[int] | UnsetType = UNSET
    divisions: Sequence[int] | UnsetType = UNSET
    values: Mapping[str, Any]
    errors: Mapping[str, Any]
    half_widths: Mapping[str, Any]
    orders: Mapping[str, float | None]
    limits: Mapping[str, float | None]
    limit_half_widths: Mapping[str, float | None]
    needed: Mapping[str, Mapping[str, int | None]]


def series_rows(series: ConvergenceSeries, column: int, refined: str, unit: str) -> str:
    """Table of values, errors, half-widths and orders of a quantity by count, with its limit.

    `refined` heads the column of counts, `unit` that of values.
    """
    rows = [
        (
            str(count),
            f"{value:.8g}",
            f"{error:+.3g}",
            "" if half_width is None else f"{half_width:.2g}",
            "" if order is None else f"{order:.2f}",
        )
        for count, value, error, half_width, order in series_cells(series, column)
    ]
    limit = (
        f"{series.limits[column]:.8g}",
        "",
        f"{100.0 * series.limit_half_widths[column]:.2g}",
    )
    headings = (refined, unit, "error (%)", "half-width (%)", "order")
    return aligned(headings, [*rows, ("limit", *limit, "")])


def series_cells(
    series: ConvergenceSeries, column: int
) -> list[tuple[int, float, float, float | None, float | None]]:
    """Count, value, error (%), half-width (%) and order of a quantity, for each count.

    Half-width and order are None if they are unknown, as for the first count.
    """
    return [
        (
            count,
            float(value),
            100.0 * float(error),
            None if np.isnan(half_width) else 100.0 * float(half_width),
            None if np.isnan(order) else float(order),
        )
        for count, value, error, half_width, order in zip(
            series.counts,
            series.values[:, column],
            series.errors[:, column],
            series.half_widths[:, column],
            series.pairwise_orders(column),
            strict=True,
        )
    ]


def short_summary(series: ConvergenceSeries, column: int, stated: int | None) -> str:
    """Text: error at the `stated` count; smallest counts for errors of 1, 0.1 and 0.01 %.

    The text is about the quantity in `column`. Example: "+0.009 % (2, 6, 19)".
    """
    needed = [str(count or f"over {series.counts[-1]}") for count in series.needed[:, column]]
    return f"{_stated_error(series, column, stated)} ({', '.join(needed)})".strip()


def summary(series: ConvergenceSeries, column: int, stated: int | None) -> str:
    """Error at the `stated` count and smallest counts for errors of 1, 0.1 and 0.01 %, in words.

    The text is about the quantity in `column`. The error is omitted if `stated` is None or was not
    computed.
    """
    needed = [
        f"{100.0 * target:g} % needs {count or f'more than {series.counts[-1]}'}"
        for target, count in zip(TARGETS, series.needed[:, column], strict=True)
    ]
    error = _stated_error(series, column, stated)
    return (f"{stated} elements: {error}; " if error else "") + ", ".join(needed)


def _stated_error(series: ConvergenceSeries, column: int, stated: int | None) -> str:
    if stated not in series.counts:
        return ""
    return _percent(series.errors[series.counts.index(stated), column])


def series_record(series: ConvergenceSeries, quantities: Sequence[str]) -> SeriesRecord:
    """JSON object of the series.

    `quantities` are the names of the q quantities of the series, in order. The JSON key of the
    counts is the refined parameter: elements of a leg, or divisions of a solid's mesh.
    """
    discretisation = series.discretisation
    counts: dict[str, Any] = {discretisation.refined: series.counts}

    def by_quantity(values: Array) -> dict[str, Any]:
        return dict(zip(quantities, finite_items(values.T), strict=True))

    # The first count has no half-width, because it has no coarser count.
    half_widths = {
        quantity: [None, *finer]
        for quantity, (_, *finer) in by_quantity(series.half_widths).items()
    }
    return SeriesRecord(
        model=discretisation.model,
        layout=discretisation.layout,
        theory=discretisation.theory,
        formal_order=series.formal_order,
        **counts,
        values=by_quantity(series.values),
        errors=by_quantity(series.errors),
        half_widths=half_widths,
        orders=by_quantity(series.orders),
        limits=by_quantity(series.limits),
        limit_half_widths=by_quantity(series.limit_half_widths),
        needed={
            f"{target:g}": {
                quantity: count or None for quantity, count in by_quantity(counts).items()
            }
            for target, counts in zip(TARGETS, series.needed, strict=True)
        },
    )


def size_text(error: float) -> str:
    """Relative error in per cent, without sign."""
    return percent(error, signed=False)


def _percent(error: float) -> str:
    """Relative error in per cent with its sign. "below …" if it is smaller than the round-off."""
    if abs(error) < ROUND_OFF["timoshenko"]:
        return f"below {number(100.0 * ROUND_OFF['timoshenko'])}\N{NO-BREAK SPACE}%"
    return percent(error)
