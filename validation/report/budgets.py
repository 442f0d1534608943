"""The error budget as stacked bars: what is measured, what explains it, and what is left.

Vocabulary of ASME V&V 20: comparison error E = value − reference; allowances for named model
differences; the rest is unexplained and stands against numerical uncertainty and tolerance.
"""

from collections.abc import Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from lumped.arrays import Array
from validation.case import Measurement, Outcome
from validation.exhibits import Figure
from validation.report.style import (
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    canvas,
    csv_of,
    plot_style,
    svg_of,
)

# Colour and hatch of the causes: the hatch tells them apart in black and white.
_LOOKS = (
    (BLUE, ""),
    (ORANGE, "//"),
    (GREEN, ".."),
    (PURPLE, "\\\\"),
    (SKY, "xx"),
)
_BAND = "#d9dde2"
_LINE_HEIGHT, _FRAME_HEIGHT = 0.21, 1.25  # in
_CAUSE_WIDTH = 62


def budgeted(outcomes: Sequence[Outcome]) -> tuple[Outcome, ...]:
    """The comparisons that can be drawn: with allowances, and a reference to be relative to."""
    return tuple(
        outcome
        for outcome in outcomes
        if outcome.measurement
        and outcome.measurement.allowances
        and outcome.measurement.reference
        and np.isfinite(outcome.measurement.unexplained)
    )


def budget_figure(identifier: str, title: str, outcomes: Sequence[Outcome]) -> Figure:
    """Left the difference and its named causes, right what is left over the tolerance.

    `outcomes` are `budgeted`, at least one.
    """
    names = [_name(outcome) for outcome in outcomes]
    rows = np.arange(len(outcomes), dtype=float)
    with plot_style():
        picture, (whole, rest) = canvas(
            columns=2, height=_FRAME_HEIGHT + _LINE_HEIGHT * len(outcomes)
        )
        handles = _causes(whole, rows, outcomes)
        handles += _rest(rest, rows, outcomes)
        whole.set_yticks(rows, names, fontsize=8.5)
        rest.set_yticks(rows, [])
        for axes in (whole, rest):
            axes.set_ylim(len(outcomes) - 0.4, -0.6)
            axes.axvline(0.0, color="#666666", linewidth=0.8)
            axes.grid(visible=False, axis="y")
        whole.set_xlabel("value − reference (% of the reference)")
        rest.set_xlabel("unexplained (% of the tolerance)")
        picture.legend(handles=handles, loc="outside upper left", ncols=2, fontsize=8.0)
        svg = svg_of(picture)
    return Figure(
        id=identifier,
        title=title,
        caption=(
            "Left: the measured difference (diamond) and the named causes that explain it, each "
            "computed on its own. Right: what no cause explains, with the numerical uncertainty "
            "of both sides; the grey band is the tolerance."
        ),
        section="budgets",
        svg=svg,
        data=_table(outcomes),
    )


def _causes(axes: Axes, rows: Array, outcomes: Sequence[Outcome]) -> list[Patch | Line2D]:
    causes = dict.fromkeys(a.cause for o in outcomes for a in _measured(o).allowances)
    # Positive parts to the right of zero, negative ones to its left.
    right, left = np.zeros(len(rows)), np.zeros(len(rows))
    handles: list[Patch | Line2D] = []
    looks = cycle(_LOOKS)
    for cause in causes:
        colour, hatch = next(looks)
        amounts = np.array([_amount(outcome, cause) for outcome in outcomes])
        start = np.where(amounts >= 0.0, right, left)
        axes.barh(
            rows, amounts, left=start, height=0.62, color=colour, hatch=hatch, edgecolor="white"
        )
        right, left = right + np.maximum(amounts, 0.0), left + np.minimum(amounts, 0.0)
        label = cause if len(cause) <= _CAUSE_WIDTH else f"{cause[: _CAUSE_WIDTH - 1]}…"
        handles.append(Patch(facecolor=colour, hatch=hatch, edgecolor="white", label=label))
    unexplained = np.array([_percent(_measured(o), _measured(o).unexplained) for o in outcomes])
    axes.barh(
        rows,
        unexplained,
        left=np.where(unexplained >= 0.0, right, left),
        height=0.62,
        color=VERMILLION,
    )
    handles.append(Patch(facecolor=VERMILLION, label="unexplained"))
    differences = [_percent(_measured(o), _measured(o).difference) for o in outcomes]
    axes.plot(
        differences,
        rows,
        linestyle="",
        marker="D",
        color="black",
        markerfacecolor="white",
        zorder=5,
    )
    handles.append(
        Line2D([], [], linestyle="", marker="D", color="black", label="measured difference E")
    )
    return handles


def _rest(axes: Axes, rows: Array, outcomes: Sequence[Outcome]) -> list[Patch | Line2D]:
    axes.axvspan(-100.0, 100.0, color=_BAND, linewidth=0.0)
    values = np.array([100.0 * _measured(o).unexplained / o.tolerance for o in outcomes])
    bars = np.array(
        [100.0 * (_measured(o).numerical_uncertainty or 0.0) / o.tolerance for o in outcomes]
    )
    axes.barh(rows, values, height=0.62, color=VERMILLION, alpha=0.55)
    axes.errorbar(
        values,
        rows,
        xerr=bars,
        linestyle="",
        marker="o",
        color="black",
        markerfacecolor="white",
        capsize=3,
    )
    limit = max(115.0, 1.1 * float(np.max(np.abs(values))))
    axes.set_xlim(-limit, limit)
    return [
        Line2D([], [], color="black", marker="|", label="numerical uncertainty of both sides"),
        Patch(facecolor=_BAND, label="tolerance"),
    ]


def _measured(outcome: Outcome) -> Measurement:
    assert outcome.measurement is not None  # noqa: S101  budgeted outcomes were measured
    return outcome.measurement


def _amount(outcome: Outcome, cause: str) -> float:
    measurement = _measured(outcome)
    total = sum(a.amount for a in measurement.allowances if a.cause == cause)
    return _percent(measurement, total)


def _percent(measurement: Measurement, amount: float) -> float:
    return 100.0 * amount / abs(measurement.reference)


def _name(outcome: Outcome) -> str:
    """The quantity, cut to what fits beside a bar."""
    name = outcome.case.quantity.partition(", worst")[0].removeprefix("compliance ")
    name = name.replace("natural frequency", "frequency").replace(", clamped-free", "")
    return name if len(name) <= 34 else f"{name[:33]}…"


def _table(outcomes: Sequence[Outcome]) -> str:
    causes = list(dict.fromkeys(a.cause for o in outcomes for a in _measured(o).allowances))
    columns: dict[str, list[float | str]] = {
        "case": [outcome.case.id for outcome in outcomes],
        "difference (% of the reference)": [
            _percent(_measured(o), _measured(o).difference) for o in outcomes
        ],
    }
    columns |= {
        f"{cause} (% of the reference)": [_amount(outcome, cause) for outcome in outcomes]
        for cause in causes
    }
    columns |= {
        "unexplained (% of the reference)": [
            _percent(_measured(o), _measured(o).unexplained) for o in outcomes
        ],
        "numerical uncertainty (% of the reference)": [
            _percent(_measured(o), _measured(o).numerical_uncertainty or 0.0) for o in outcomes
        ],
        "tolerance (% of the reference)": [_percent(_measured(o), o.tolerance) for o in outcomes],
    }
    return csv_of(columns)
