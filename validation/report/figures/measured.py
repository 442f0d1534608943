"""Measured values as points with bars, and what the models say there."""

from itertools import cycle

import numpy as np
from matplotlib.axes import Axes

from validation.adequacy.matrix import Entry, Matrix
from validation.drawing.style import BLACK, OTHERS, canvas, csv_of, plot_style, svg_of
from validation.exhibits import Figure
from validation.report.figures.adequacy import look_of_model
from validation.report.figures.curves.lines import legend_above

_COLUMNS = 3


def measured_figure(matrix: Matrix) -> Figure | None:
    """A panel for each measured quantity: measured with its 95 % interval, models beside it."""
    shown = matrix.quantities
    if not shown:
        return None
    rows, columns = -(-len(shown) // _COLUMNS), min(len(shown), _COLUMNS)
    with plot_style():
        picture, panels = canvas(rows, columns, 0.7 + 2.1 * rows)
        for axes, quantity in zip(panels, shown, strict=False):
            entries = [entry for entry in matrix.entries if entry.quantity == quantity]
            if any(sum(error is not None for error in entry.errors) > 1 for entry in entries):
                _draw_over_poses(axes, matrix, entries)
            else:
                _draw(axes, entries)
        for axes in panels[len(shown) :]:
            axes.set_axis_off()
        for axes in panels[::columns]:
            axes.set_ylabel("value / measured value")
        legend_above(picture, columns=_COLUMNS)
        svg = svg_of(picture)
    return Figure(
        id="measured.values",
        title="Measured values, and what the models say",
        caption=(
            "Black: measured, with the 95 % interval of its own uncertainty. Models with that of "
            "numerics and uncertain inputs. Each divided by what was measured there; over the "
            "poses where there are several, with the 95 % interval of all three."
        ),
        section="measured",
        svg=svg,
        data=csv_of(
            {
                "model": [entry.model for entry in matrix.entries],
                "quantity": [entry.quantity for entry in matrix.entries],
                "value": [_or_empty(entry.value) for entry in matrix.entries],
                "measured": [_or_empty(entry.expected) for entry in matrix.entries],
                "95 % of the measurement": [_part(e, "measurement") for e in matrix.entries],
                "95 % of numerics and inputs": [_of_model(e) for e in matrix.entries],
            }
        ),
    )


def _draw(axes: Axes, entries: list[Entry]) -> None:
    others = cycle(OTHERS)
    bars = [_part(entry, "measurement") for entry in entries]
    axes.errorbar(
        0, 1.0, max(bars, default=0.0), color=BLACK, marker="o", capsize=4, label="measured"
    )
    for place, entry in enumerate(entries, start=1):
        if entry.value is None or not entry.expected:
            continue
        look = look_of_model(entry.model) or next(others)
        axes.errorbar(
            place,
            entry.value / entry.expected,
            _of_model(entry),
            color=look.colour,
            marker=look.marker,
            linestyle="none",
            capsize=3,
            label=entry.model,
        )
    axes.axhline(1.0, color="#999999", linewidth=0.8)
    axes.set_xticks([])
    axes.set_title(entries[0].quantity if entries else "")


def _draw_over_poses(axes: Axes, matrix: Matrix, entries: list[Entry]) -> None:
    others = cycle(OTHERS)
    single = len(matrix.coordinates) == 1
    places = [pose[0] if single else number for number, pose in enumerate(matrix.poses, start=1)]
    for entry in entries:
        found = [
            (place, 1.0 + error, spread)
            for place, error, spread in zip(places, entry.errors, entry.spreads, strict=True)
            if error is not None
        ]
        look = look_of_model(entry.model) or next(others)
        axes.errorbar(
            *np.array(found).T,
            color=look.colour,
            marker=look.marker,
            linestyle=look.line,
            capsize=3,
            label=entry.model,
        )
    known = [place for place, _, _ in found]
    axes.plot(known, np.ones(len(known)), color=BLACK, marker="o", linestyle="", label="measured")
    axes.axhline(1.0, color="#999999", linewidth=0.8)
    axes.set_xlabel(matrix.coordinates[0] if single else "pose")
    axes.set_title(entries[0].quantity)


def _part(entry: Entry, name: str) -> float:
    return float(entry.uncertainties.get(name, 0.0))


def _of_model(entry: Entry) -> float:
    return float(np.hypot(_part(entry, "numerics"), _part(entry, "inputs")))


def _or_empty(value: float | None) -> float | str:
    return "" if value is None else value
