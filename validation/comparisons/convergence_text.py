"""Text and plain data of one convergence series, for the terminal and for results.json.

Input: a `ConvergenceSeries` and the column of a quantity. Output: lines of text or a dictionary.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from lumped.text import aligned
from validation.comparisons.convergence_series import ROUND_OFF, TARGETS, ConvergenceSeries
from validation.drawing.text import number, percent


def series_rows(series: ConvergenceSeries, column: int, refined: str, unit: str) -> str:
    """Table of values, errors, half-widths and orders of a quantity by count, with its limit."""
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
    """Text with the error at the `stated` count and the smallest counts: "+0.009 % (2, 6, 19)"."""
    needed = [str(count or f"over {series.counts[-1]}") for count in series.needed[:, column]]
    return f"{_stated_error(series, column, stated)} ({', '.join(needed)})".strip()


def summary(series: ConvergenceSeries, column: int, stated: int | None) -> str:
    """Text with the error at the `stated` count, and the smallest counts for 1 %, 0.1 % and 0.01 %.

    The error is omitted if `stated` is None or was not computed.
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


def series_record(
    series: ConvergenceSeries, quantities: Sequence[str], refined: str
) -> dict[str, Any]:
    """Plain data of the series by quantity. A missing order or half-width is None."""
    by_quantity = dict(enumerate(quantities))
    return {
        "model": series.discretisation.model,
        "layout": series.discretisation.layout,
        "theory": series.discretisation.theory,
        "formal_order": series.formal_order,
        refined: list(series.counts),
        "values": {q: series.values[:, k].tolist() for k, q in by_quantity.items()},
        "errors": {q: series.errors[:, k].tolist() for k, q in by_quantity.items()},
        # The first count has no half-width, because it has no coarser count.
        "half_widths": {
            q: [None, *series.half_widths[1:, k].tolist()] for k, q in by_quantity.items()
        },
        "orders": {
            q: None if np.isnan(series.orders[k]) else float(series.orders[k])
            for k, q in by_quantity.items()
        },
        "limits": {q: float(series.limits[k]) for k, q in by_quantity.items()},
        "limit_half_widths": {
            q: float(series.limit_half_widths[k]) for k, q in by_quantity.items()
        },
        "needed": {
            f"{target:g}": {q: int(row[k]) or None for k, q in by_quantity.items()}
            for target, row in zip(TARGETS, series.needed, strict=True)
        },
    }


def size_text(error: float) -> str:
    """Relative error in per cent, without sign."""
    return percent(error, signed=False)


def _percent(error: float) -> str:
    """Relative error in per cent. Below the round-off, the bound "below …" instead."""
    if abs(error) < ROUND_OFF["timoshenko"]:
        return f"below {number(100.0 * ROUND_OFF['timoshenko'])}\N{NO-BREAK SPACE}%"
    return percent(error)
