"""Charts of a matrix of verdicts, with one panel for each quantity.

Input: a matrix. Output: errors of all models over the poses, or their values and measured values.
"""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from lumped.acceptance.quantities import UNIT_LOADS, Quantity, QuantityKind
from lumped.arrays import Array
from validation.drawing.chart import Chart, Column, Panel, Series, few_ticks, percent, side_by_side
from validation.verdicts import Entry, Matrix

_POSE = "pose"
# Error panels: deflections, and the first frequencies if the matrix contains any.
_DEFLECTIONS = tuple(quantity for quantity in UNIT_LOADS if not quantity.rotational)
_MODES = 2
_COLUMNS = 3


def error_curves(matrix: Matrix) -> Chart | None:
    """Chart of the errors of deflections and first frequencies. None if no error is known.

    The shaded band contains errors within the limit. The scale is linear in the band and
    logarithmic beyond it.
    """
    modes = [quantity for quantity in matrix.quantities if quantity.kind is QuantityKind.FREQUENCY][
        :_MODES
    ]
    plotted = [
        quantity
        for quantity in (*_DEFLECTIONS, *modes)
        if any(_entries_with_errors(matrix, quantity))
    ]
    if not plotted:
        return None
    panels = [_panel(matrix, q, leftmost=not i % _COLUMNS) for i, q in enumerate(plotted)]
    return _chart(panels, matrix, _table(matrix)).captioned(
        "Relative error of each model, (model − reference)/reference, at every pose of "
        "the path. Deflections: distance between the two displacement vectors of the "
        "loaded point, over the length of the reference's vector, hence never negative. "
        "Frequencies: with sign. Bars: range of the error due to the uncertainty of the "
        "reference and to data that the robot file leaves open. Shaded band: accepted "
        "error. A model is adequate if its whole bar lies in the band, inadequate if the "
        "whole bar lies outside, else undecided. The scale is linear in the band and "
        "logarithmic beyond it.",
        title="Relative error of each model against its reference",
    )


def measured_curves(matrix: Matrix) -> Chart | None:
    """Chart of measured values with their 95 % intervals, and of all models, by quantity.

    None if nothing was measured.
    """
    if not matrix.quantities:
        return None
    entries_by_quantity = {
        quantity: [entry for entry in matrix.entries if entry.quantity == quantity]
        for quantity in matrix.quantities
    }
    panels = []
    for index, (quantity, entries) in enumerate(entries_by_quantity.items()):
        label = "" if index % 3 else "value / measured value"
        texts = {"title": quantity.loading or quantity.label, "y_label": label}
        options: dict[str, Any] = {**texts, "levels": (1.0,), "staggered": False}
        if any(sum(error is not None for error in entry.errors) > 1 for entry in entries):
            panels.append(Panel(_path_series(matrix, entries), **options))
        else:
            panels.append(
                Panel(_single_pose_series(entries), scale=side_by_side, x_label="", **options)
            )
    data: dict[str, Column] = {
        "model": [entry.model for entry in matrix.entries],
        "quantity": [entry.quantity.name for entry in matrix.entries],
        "value": [entry.value for entry in matrix.entries],
        "measured": [entry.expected for entry in matrix.entries],
        "95 % of the measurement": [_uncertainty(e, "measurement") for e in matrix.entries],
        "95 % of numerics and inputs": [_model_uncertainty(e) for e in matrix.entries],
    }
    return _chart(panels, matrix, data).captioned(
        "Prediction of each model divided by the measured value; 1 is exact agreement. "
        "Black: the measurement with its 95 % interval. Bars of the models: 95 % "
        "interval due to numerical error and uncertain inputs; with several poses, it "
        "includes the uncertainty of the measurement. A model differs significantly from "
        "the measurement if their intervals do not overlap.",
        title="Measured values and predictions of each model",
    )


def _chart(panels: Sequence[Panel], matrix: Matrix, table: Mapping[str, Column]) -> Chart:
    """Chart of panels over the poses of a matrix, with `table` as its data."""
    _, label = _abscissa(matrix)
    ticks = partial(few_ticks, count=5, whole=label == _POSE)
    return Chart(panels, label, min(len(panels), _COLUMNS), 1.9, table, ticks)


def _abscissa(matrix: Matrix) -> tuple[Array, str]:
    """Abscissa (p) of charts over the poses, with its label.

    If the poses have only one coordinate, it is the abscissa, otherwise the number of each pose
    along the path, from 1. Shapes: p poses.
    """
    poses = np.reshape(matrix.poses, (len(matrix.poses), len(matrix.coordinates)))
    if len(matrix.coordinates) == 1:
        return poses[:, 0], matrix.coordinates[0].axis
    return np.arange(1.0, len(poses) + 1.0), _POSE


def _numbers(values: Sequence[float | None]) -> Array:
    """Values as an array. NaN for each None."""
    return np.array([np.nan if value is None else value for value in values])


def _error_ranges(entry: Entry) -> Array:
    """Distances (2×p) from the error in each pose to both ends of its uncertainty interval.

    The first row is the distance down to `lows` of the entry, the second row that up to `highs`.
    Shapes: p poses.
    """
    errors, lows, highs = map(_numbers, (entry.errors, entry.lows, entry.highs))
    # Negative differences are round-off.
    return np.maximum([errors - lows, highs - errors], 0.0)


def _entries_with_errors(matrix: Matrix, quantity: Quantity) -> list[Entry]:
    """Entries of a quantity, one for each model, that have an error in at least one pose."""
    entries = (entry for entry in matrix.entries if entry.quantity == quantity)
    return [entry for entry in entries if np.isfinite(_numbers(entry.errors)).any()]


def _panel(matrix: Matrix, quantity: Quantity, *, leftmost: bool) -> Panel:
    x, _ = _abscissa(matrix)
    entries, series = _entries_with_errors(matrix, quantity), []
    limit = 100.0 * max(entry.limit for entry in entries)
    signed = any(entry.signed for entry in entries)
    for entry in entries:
        half_widths = 100.0 * _error_ranges(entry)
        error_bars = half_widths if np.nanmax(half_widths, initial=0.0) > 0.02 * limit else None
        series.append(Series(entry.model, x, 100.0 * _numbers(entry.errors), bars=error_bars))
    return Panel(
        series,
        quantity.loading or quantity.label,
        "relative error (%)" if leftmost else "",
        partial(percent, limit=limit, steps=(1.0, 3.0)),
        band=(-limit if signed else 0.0, limit),
    )


def _table(matrix: Matrix) -> Mapping[str, Column]:
    columns: dict[str, Column] = {
        str(coordinate): [pose[column] for pose in matrix.poses]
        for column, coordinate in enumerate(matrix.coordinates)
    }
    for entry in matrix.entries:
        for kind, errors in (
            ("error", entry.errors),
            ("lowest error", entry.lows),
            ("highest error", entry.highs),
            ("error along the load", entry.alongs),
        ):
            if len(errors) == len(matrix.poses):
                columns[f"{entry.model}: {kind} of {entry.quantity}"] = errors
    return columns


def _single_pose_series(entries: Sequence[Entry]) -> list[Series]:
    """Points of a single pose: the measurement, then the models.

    All values are ratios to the measured value.
    """
    bar = max((_uncertainty(entry, "measurement") for entry in entries), default=0.0)
    series = [_point("measured", 0, 1.0, bar)]
    for row, entry in enumerate(entries, start=1):
        if entry.value is not None and entry.expected:
            ratio = entry.value / entry.expected
            series.append(_point(entry.model, row, ratio, _model_uncertainty(entry)))
    return series


def _point(label: str, row: int, value: float, bar: float) -> Series:
    x, y, bars = (np.array([number]) for number in (float(row), value, bar))
    return Series(label, x, y, bars=bars)


def _path_series(matrix: Matrix, entries: Sequence[Entry]) -> list[Series]:
    """Curves over the measured poses: the models, then the measurement.

    All values are ratios to the measured value.
    """
    x, _ = _abscissa(matrix)
    series = []
    for entry in entries:
        errors = _numbers(entry.errors)
        finite = np.isfinite(errors)
        bars = _error_ranges(entry)[:, finite]
        series.append(Series(entry.model, x[finite], 1.0 + errors[finite], bars=bars))
    measured_x = series[-1].x
    return [*series, Series("measured", measured_x, np.ones(len(measured_x)))]


def _uncertainty(entry: Entry, name: str) -> float:
    return float(entry.uncertainties.get(name, 0.0))


def _model_uncertainty(entry: Entry) -> float:
    return float(np.hypot(_uncertainty(entry, "numerics"), _uncertainty(entry, "inputs")))
