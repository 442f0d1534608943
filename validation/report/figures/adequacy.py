"""Relative error of every model over the poses, quantity by quantity, with what is accepted."""

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator, NullLocator

from lumped.arrays import Array
from validation.adequacy.matrix import Entry, Matrix
from validation.drawing.style import (
    BLUE,
    MODELS,
    OTHERS,
    Look,
    canvas,
    csv_of,
    marked,
    plot_style,
    svg_of,
)
from validation.exhibits import Figure
from validation.report.figures.curves.lines import legend_above

_POSE = "pose"
# The deflections, and the frequencies where there are any: what is read off first.
_STATIC, _MODES = ("x", "y", "z"), 3
_MEANINGS = {axis: f"deflection along {axis}" for axis in _STATIC}
_COLUMNS = 3
_TITLE = "Relative error of the models"
_LOOKS = {
    "simplified": MODELS["simplified"],
    "vjm": Look(BLUE, "o", "--"),
    "vjm-equivalent": MODELS["vjm"],
    "segments": MODELS["segments"],
    "beam": MODELS["beam"],
    "segments-euler-bernoulli": Look(MODELS["segments"].colour, "v", ":"),
    "beam-euler-bernoulli": Look(MODELS["beam"].colour, "P", ":"),
}


def error_figure(matrix: Matrix) -> Figure | None:
    """A panel for each deflection and the first frequencies; None where nothing is known.

    Errors within the limit lie in the shaded band, on a linear scale; beyond it the scale is
    logarithmic.
    """
    modes = tuple(q for q in matrix.quantities if q[:1] == "f" and q[1:].isdecimal())[:_MODES]
    shown = [q for q in (*_STATIC, *modes) if any(_curve(e) is not None for e in _of(matrix, q))]
    if not shown:
        return None
    rows = -(-len(shown) // _COLUMNS)
    with plot_style():
        picture, panels = canvas(rows, min(len(shown), _COLUMNS), 0.7 + 2.1 * rows)
        for axes, quantity in zip(panels, shown, strict=False):
            _draw(axes, matrix, quantity)
        for axes in panels[len(shown) :]:
            axes.set_axis_off()
        for axes in panels[:: min(len(shown), _COLUMNS)]:
            axes.set_ylabel("relative error (%)")
        legend_above(picture, columns=_COLUMNS)
        svg = svg_of(picture)
    return Figure(
        id="adequacy.errors",
        title=_TITLE,
        caption=(
            "Deflection of the loaded point along its own force, and frequencies; bars: what the "
            "reference leaves open. Shaded: what is accepted, beyond it the scale is logarithmic."
        ),
        section="adequacy",
        svg=svg,
        data=_table(matrix),
    )


def look_of_model(model: str) -> Look | None:
    """How a model of the matrix is drawn, None where it has no look of its own."""
    return _LOOKS.get(model)


def _of(matrix: Matrix, quantity: str) -> Sequence[Entry]:
    return [entry for entry in matrix.entries if entry.quantity == quantity]


def _curve(entry: Entry) -> Array | None:
    """Errors (%) over the poses, NaN where there is none."""
    values = np.array([np.nan if error is None else 100.0 * error for error in entry.errors])
    return values if np.isfinite(values).any() else None


def _draw(axes: Axes, matrix: Matrix, quantity: str) -> None:
    x, label = _abscissa(matrix)
    entries = [
        (entry, curve) for entry in _of(matrix, quantity) if (curve := _curve(entry)) is not None
    ]
    limit = 100.0 * max((entry.limit for entry, _ in entries), default=0.05)
    axes.axhspan(-limit, limit, color="#009E73", alpha=0.12, linewidth=0.0)
    axes.axhline(0.0, color="#999999", linewidth=0.8)
    others = cycle(OTHERS)
    for rank, (entry, curve) in enumerate(entries):
        look = look_of_model(entry.model) or next(others)
        width = 3.0 - 2.0 * rank / max(len(entries) - 1, 1)
        axes.plot(
            x,
            curve,
            label=entry.model,
            linewidth=width,
            markevery=marked(len(x), rank, len(entries)),
            **look.options(),
        )
        spreads = [np.nan if one is None else 100.0 * one for one in entry.spreads]
        if spreads and np.nanmax(spreads) > 0.02 * limit:
            axes.errorbar(x, curve, spreads, fmt="none", ecolor=look.colour, capsize=2, alpha=0.6)
    axes.set_yscale("symlog", linthresh=limit, linscale=0.6)
    axes.yaxis.set_major_locator(FixedLocator(_ticks(limit, *axes.get_ylim())))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda value, _: f"{value:+g}" if value else "0"))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_title(_MEANINGS.get(quantity, quantity))
    axes.xaxis.set_major_locator(MaxNLocator(nbins=5, integer=label == _POSE))
    axes.set_xlabel(label)


def _ticks(limit: float, low: float, high: float) -> list[float]:
    """Zero, the limit (%), and 1, 3, 10, … beyond it, as far as the axis goes."""
    beyond = [step * 10.0**power for power in range(-6, 7) for step in (1.0, 3.0)]
    sizes = [limit, *(size for size in beyond if size >= 1.9 * limit)]
    return [0.0, *(s for size in sizes for s in (size, -size) if 1.001 * low <= s <= 1.001 * high)]


def _abscissa(matrix: Matrix) -> tuple[Array, str]:
    """The poses' only coordinate, or their number along the path."""
    poses = np.array(matrix.poses)
    if len(matrix.coordinates) == 1:
        return poses[:, 0], matrix.coordinates[0]
    return np.arange(1.0, len(poses) + 1.0), _POSE


def _table(matrix: Matrix) -> str:
    columns: dict[str, list[float | str]] = {
        name: [pose[place] for pose in matrix.poses]
        for place, name in enumerate(matrix.coordinates)
    }
    for entry in matrix.entries:
        if len(entry.errors) == len(matrix.poses):
            columns[f"{entry.model}: error of {entry.quantity}"] = [
                "" if error is None else error for error in entry.errors
            ]
    return csv_of(columns)
