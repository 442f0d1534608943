"""What a matrix says of every model, quantity by quantity: errors, and measured values."""

from collections.abc import Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np

from lumped.acceptance.quantities import UNIT_LOADS, Quantity, QuantityKind
from lumped.arrays import Array
from validation.drawing.chart import Chart, Column, Panel, Series, few_ticks, percent, side_by_side
from validation.verdicts import Entry, Matrix

_POSE = "pose"
# The deflections, and the frequencies where there are any: what is read off first.
_DEFLECTIONS = tuple(quantity for quantity in UNIT_LOADS if not quantity.rotational)
_MODES = 2
_COLUMNS = 3


def error_curves(matrix: Matrix) -> Chart | None:
    """A panel for each deflection and the first frequencies; None where nothing is known.

    Errors within the limit lie in the shaded band, on a linear scale; beyond it the scale is
    logarithmic.
    """
    modes = [one for one in matrix.quantities if one.kind is QuantityKind.FREQUENCY][:_MODES]
    shown = [one for one in (*_DEFLECTIONS, *modes) if any(_known(matrix, one))]
    if not shown:
        return None
    panels = [_panel(matrix, q, leftmost=not i % _COLUMNS) for i, q in enumerate(shown)]
    return _chart(panels, matrix, _table(matrix)).captioned(
        "Error of the whole displacement of the loaded point (never negative) and of frequencies; "
        "bars: from the lowest to the highest error that the reference leaves open. Shaded: the "
        "accepted error, beyond which the scale is logarithmic.",
        title="Relative error of the models",
    )


def measured_curves(matrix: Matrix) -> Chart | None:
    """A panel for each measured quantity: measured with its 95 % interval, models beside it."""
    if not matrix.quantities:
        return None
    found = {
        quantity: [entry for entry in matrix.entries if entry.quantity == quantity]
        for quantity in matrix.quantities
    }
    panels = []
    for place, (quantity, entries) in enumerate(found.items()):
        label = "" if place % 3 else "value / measured value"
        named = {"title": quantity.loading or quantity.label, "y_label": label}
        shape: dict[str, Any] = {**named, "levels": (1.0,), "staggered": False}
        if any(sum(error is not None for error in entry.errors) > 1 for entry in entries):
            panels.append(Panel(_over_poses(matrix, entries), **shape))
        else:
            panels.append(Panel(_one_pose(entries), scale=side_by_side, x_label="", **shape))
    data: dict[str, Column] = {
        "model": [entry.model for entry in matrix.entries],
        "quantity": [entry.quantity.name for entry in matrix.entries],
        "value": [entry.value for entry in matrix.entries],
        "measured": [entry.expected for entry in matrix.entries],
        "95 % of the measurement": [_part(e, "measurement") for e in matrix.entries],
        "95 % of numerics and inputs": [_of_model(e) for e in matrix.entries],
    }
    return _chart(panels, matrix, data).captioned(
        "All values divided by the measured one. Black: measured, with its 95 % interval. Models: "
        "with the 95 % interval of numerics and uncertain inputs; where there are several poses, "
        "of the measurement, too.",
        title="Measured values, and what the models say",
    )


def _chart(panels: Sequence[Panel], matrix: Matrix, table: Mapping[str, Column]) -> Chart:
    """Panels of a matrix, a quantity each, over its poses, and its numbers."""
    _, label = _abscissa(matrix)
    ticks = partial(few_ticks, count=5, whole=label == _POSE)
    return Chart(panels, label, min(len(panels), _COLUMNS), 1.9, table, ticks)


def _abscissa(matrix: Matrix) -> tuple[Array, str]:
    """The poses' only coordinate, or their number along the path; entries of legs have no pose."""
    poses = np.reshape(matrix.poses, (len(matrix.poses), len(matrix.coordinates)))
    if len(matrix.coordinates) == 1:
        return poses[:, 0], matrix.coordinates[0].axis
    return np.arange(1.0, len(poses) + 1.0), _POSE


def _numbers(values: Sequence[float | None]) -> Array:
    """Values with NaN where there is none."""
    return np.array([np.nan if value is None else value for value in values])


def _left_open(entry: Entry) -> Array:
    """By how much errors may be lower and higher at each pose (2×p)."""
    errors, lows, highs = map(_numbers, (entry.errors, entry.lows, entry.highs))
    # Differences of numbers that are one up to rounding are never negative.
    return np.maximum([errors - lows, highs - errors], 0.0)


def _known(matrix: Matrix, quantity: Quantity) -> list[Entry]:
    """What is known of a quantity, a model each."""
    entries = (entry for entry in matrix.entries if entry.quantity == quantity)
    return [entry for entry in entries if np.isfinite(_numbers(entry.errors)).any()]


def _panel(matrix: Matrix, quantity: Quantity, *, leftmost: bool) -> Panel:
    x, _ = _abscissa(matrix)
    entries, series = _known(matrix, quantity), []
    limit = 100.0 * max(entry.limit for entry in entries)
    signed = any(entry.signed for entry in entries)
    for entry in entries:
        left_open = 100.0 * _left_open(entry)
        bars = left_open if np.nanmax(left_open, initial=0.0) > 0.02 * limit else None
        series.append(Series(entry.model, x, 100.0 * _numbers(entry.errors), bars=bars))
    return Panel(
        series,
        quantity.loading or quantity.label,
        "relative error (%)" if leftmost else "",
        partial(percent, limit=limit, steps=(1.0, 3.0)),
        band=(-limit if signed else 0.0, limit),
    )


def _table(matrix: Matrix) -> Mapping[str, Column]:
    columns: dict[str, Column] = {
        str(coordinate): [pose[place] for pose in matrix.poses]
        for place, coordinate in enumerate(matrix.coordinates)
    }
    for entry in matrix.entries:
        for what, errors in (
            ("error", entry.errors),
            ("lowest error", entry.lows),
            ("highest error", entry.highs),
            ("error along the load", entry.alongs),
        ):
            if len(errors) == len(matrix.poses):
                columns[f"{entry.model}: {what} of {entry.quantity}"] = errors
    return columns


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
    x, _ = _abscissa(matrix)
    series = []
    for entry in entries:
        errors = _numbers(entry.errors)
        known = np.isfinite(errors)
        bars = _left_open(entry)[:, known]
        series.append(Series(entry.model, x[known], 1.0 + errors[known], bars=bars))
    at = series[-1].x
    return [*series, Series("measured", at, np.ones(len(at)))]


def _part(entry: Entry, name: str) -> float:
    return float(entry.uncertainties.get(name, 0.0))


def _of_model(entry: Entry) -> float:
    return float(np.hypot(_part(entry, "numerics"), _part(entry, "inputs")))
