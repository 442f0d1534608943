"""Relative error of every model over the poses, quantity by quantity, with what is accepted."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from lumped.acceptance.requirement import ANY_FORCE, AXES
from lumped.arrays import Array
from validation.adequacy.matrix import Entry, Matrix
from validation.drawing.charts.chart import Chart, Column, Panel, Series
from validation.drawing.charts.scales import few_ticks, percent
from validation.report.figures.declared import Shown, curves

_POSE = "pose"
# The deflections, and the frequencies where there are any: what is read off first.
_STATIC, _MODES = (*AXES[:3], ANY_FORCE), 2
_MEANINGS = {
    **{axis: f"force along {axis}" for axis in AXES[:3]},
    ANY_FORCE: "worst direction of force",
}
_COLUMNS = 3


def error_curves(matrix: Matrix) -> Shown | None:
    """A panel for each deflection and the first frequencies; None where nothing is known.

    Errors within the limit lie in the shaded band, on a linear scale; beyond it the scale is
    logarithmic.
    """
    modes = tuple(q for q in matrix.quantities if q[:1] == "f" and q[1:].isdecimal())[:_MODES]
    shown = [q for q in (*_STATIC, *modes) if any(_known(matrix, q))]
    if not shown:
        return None
    panels = [_panel(matrix, q, leftmost=not i % _COLUMNS) for i, q in enumerate(shown)]
    return curves(
        matrix_chart(panels, abscissa(matrix)[1], _table(matrix)),
        "Error of the whole displacement of the loaded point, never negative, and of frequencies; "
        "bars: what the reference leaves open. Shaded: what is accepted, beyond it the scale is "
        "logarithmic.",
        title="Relative error of the models",
    )


def matrix_chart(panels: Sequence[Panel], label: str, table: Mapping[str, Column]) -> Chart:
    """Panels of a matrix, a quantity each, over its poses, and its numbers."""
    ticks = partial(few_ticks, count=5, whole=label == _POSE)
    return Chart(panels, label, min(len(panels), _COLUMNS), 1.9, table, ticks)


def abscissa(matrix: Matrix) -> tuple[Array, str]:
    """The poses' only coordinate, or their number along the path."""
    poses = np.array(matrix.poses)
    if len(matrix.coordinates) == 1:
        return poses[:, 0], str(matrix.coordinates[0])
    return np.arange(1.0, len(poses) + 1.0), _POSE


def numbers(values: Sequence[float | None]) -> Array:
    """Values with NaN where there is none."""
    return np.array([np.nan if value is None else value for value in values])


def _known(matrix: Matrix, quantity: str) -> list[Entry]:
    """What is known of a quantity, a model each."""
    entries = (entry for entry in matrix.entries if entry.quantity == quantity)
    return [entry for entry in entries if np.isfinite(numbers(entry.errors)).any()]


def _panel(matrix: Matrix, quantity: str, *, leftmost: bool) -> Panel:
    x, _ = abscissa(matrix)
    entries, series = _known(matrix, quantity), []
    limit = 100.0 * max(entry.limit for entry in entries)
    signed = any(entry.signed for entry in entries)
    for entry in entries:
        spreads = 100.0 * numbers(entry.spreads)
        bars = spreads if len(spreads) and np.nanmax(spreads, initial=0.0) > 0.02 * limit else None
        series.append(Series(entry.model, x, 100.0 * numbers(entry.errors), bars=bars))
    return Panel(
        series,
        _MEANINGS.get(quantity, quantity),
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
        for what, errors in (("error", entry.errors), ("error along the load", entry.alongs)):
            if len(errors) == len(matrix.poses):
                columns[f"{entry.model}: {what} of {entry.quantity}"] = errors
    return columns
