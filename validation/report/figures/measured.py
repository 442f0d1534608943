"""Measured values as points with bars, and what the models say there."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from validation.adequacy.matrix import Entry, Matrix
from validation.drawing.charts.chart import Column, Panel, Series
from validation.drawing.charts.scales import side_by_side
from validation.report.figures.adequacy import abscissa, matrix_chart, numbers
from validation.report.figures.declared import Shown, curves


def measured_curves(matrix: Matrix) -> Shown | None:
    """A panel for each measured quantity: measured with its 95 % interval, models beside it."""
    if not matrix.quantities:
        return None
    found = {
        quantity: [entry for entry in matrix.entries if entry.quantity == quantity]
        for quantity in matrix.quantities
    }
    panels = []
    for place, (quantity, entries) in enumerate(found.items()):
        named = {"title": quantity, "y_label": "" if place % 3 else "value / measured value"}
        shape: dict[str, Any] = {**named, "levels": (1.0,), "staggered": False}
        if any(sum(error is not None for error in entry.errors) > 1 for entry in entries):
            panels.append(Panel(_over_poses(matrix, entries), **shape))
        else:
            panels.append(Panel(_one_pose(entries), scale=side_by_side, x_label="", **shape))
    data: dict[str, Column] = {
        "model": [entry.model for entry in matrix.entries],
        "quantity": [entry.quantity for entry in matrix.entries],
        "value": [entry.value for entry in matrix.entries],
        "measured": [entry.expected for entry in matrix.entries],
        "95 % of the measurement": [_part(e, "measurement") for e in matrix.entries],
        "95 % of numerics and inputs": [_of_model(e) for e in matrix.entries],
    }
    return curves(
        matrix_chart(panels, abscissa(matrix)[1], data),
        "Black: measured, with the 95 % interval of its own uncertainty. Models with that of "
        "numerics and uncertain inputs. Each divided by what was measured there; over the "
        "poses where there are several, with the 95 % interval of all three.",
        title="Measured values, and what the models say",
    )


def _one_pose(entries: Sequence[Entry]) -> list[Series]:
    """In one pose: what was measured, then the models."""
    bar = max((_part(entry, "measurement") for entry in entries), default=0.0)
    series = [_point("measured", 0, 1.0, bar)]
    for place, entry in enumerate(entries, start=1):
        if entry.value is not None and entry.expected:
            ratio = entry.value / entry.expected
            series.append(_point(entry.model, place, ratio, _of_model(entry)))
    return series


def _point(label: str, place: int, value: float, bar: float) -> Series:
    x, y, bars = (np.array([number]) for number in (float(place), value, bar))
    return Series(label, x, y, bars=bars)


def _over_poses(matrix: Matrix, entries: Sequence[Entry]) -> list[Series]:
    """Over the poses where it was measured: the models, and one for what was measured."""
    x, _ = abscissa(matrix)
    series = []
    for entry in entries:
        errors, spreads = numbers(entry.errors), numbers(entry.spreads)
        known = np.isfinite(errors)
        series.append(Series(entry.model, x[known], 1.0 + errors[known], bars=spreads[known]))
    at = series[-1].x
    return [*series, Series("measured", at, np.ones(len(at)))]


def _part(entry: Entry, name: str) -> float:
    return float(entry.uncertainties.get(name, 0.0))


def _of_model(entry: Entry) -> float:
    return float(np.hypot(_part(entry, "numerics"), _part(entry, "inputs")))
