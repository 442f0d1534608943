"""The error budget as stacked bars: what is measured, what explains it, and what is left.

Vocabulary of ASME V&V 20: comparison error E = value − reference; allowances for named model
differences; the rest is unexplained and stands against numerical uncertainty and tolerance.
"""

from collections.abc import Mapping, Sequence
from itertools import cycle
from textwrap import fill

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from lumped.arrays import Array
from validation.case import Measurement
from validation.drawing.style import (
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    YELLOW,
    Frame,
    csv_of,
    framed_canvas,
    framed_legend,
    plot_style,
    svg_of,
)
from validation.drawing.text import function_name
from validation.exhibits import Figure
from validation.results.outcome import Outcome

# Colour and hatch of the causes: the hatch tells them apart in black and white.
_LOOKS = (
    (BLUE, ""),
    (ORANGE, "//"),
    (GREEN, ".."),
    (PURPLE, "\\\\"),
    (SKY, "xx"),
    ("#666666", "++"),
    (YELLOW, "--"),
)
_BAND = "#d9dde2"
_ROW_HEIGHT, _CHARACTER = 0.23, 0.066  # in, the mean width of a character in a row's name
# What the legend explains beside the causes.
_UNEXPLAINED, _MEASURED = "unexplained", "measured difference E"
_UNCERTAINTY, _TOLERANCE = "numerical uncertainty of both sides", "tolerance"
_FURTHER = (_UNEXPLAINED, _MEASURED, _UNCERTAINTY, _TOLERANCE)
# How many characters a row's name, and an entry of the legend, have room for in one line.
_NAME_WIDTH, _CAUSE_WIDTH = 38, 56


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
    names = [fill(name, _NAME_WIDTH) for name in _names(outcomes)]
    # A row is as high as its name: one unit, more from the second line on.
    heights = np.array([max(1.0, 0.2 + 0.55 * (name.count("\n") + 1)) for name in names])
    bottom = float(heights.sum())
    rows = np.cumsum(heights) - 0.5 * heights
    allowances = (one for outcome in outcomes for one in _measured(outcome).allowances)
    causes = {one.cause: fill(one.cause, _CAUSE_WIDTH) for one in allowances}
    entries = [*causes.values(), *_FURTHER]
    first = entries[: -(-len(entries) // 2)]
    longest = max(len(line) for name in names for line in name.split("\n"))
    frame = Frame(
        left=0.25 + _CHARACTER * longest,
        between=0.25,
        bottom=0.7,
        entries=sum(text.count("\n") + 1 for text in first),
    )
    with plot_style():
        picture, (whole, rest) = framed_canvas(frame, columns=2, height=_ROW_HEIGHT * bottom)
        handles = _causes(whole, rows, outcomes, causes)
        handles += _rest(rest, rows, outcomes)
        # Markers at the longest bars keep clear of the edge.
        whole.use_sticky_edges = False
        whole.margins(x=0.06)
        whole.set_yticks(rows, names, fontsize=8.5, linespacing=0.95)
        rest.set_yticks(rows, [])
        for axes in (whole, rest):
            axes.set_ylim(bottom + 0.1, -0.1)
            axes.axvline(0.0, color="#666666", linewidth=0.8)
            axes.grid(visible=False, axis="y")
        whole.set_xlabel("value − reference\n(% of the reference)")
        rest.set_xlabel("unexplained\n(% of the tolerance)")
        labels = [str(handle.get_label()) for handle in handles]
        framed_legend(picture, frame, handles, labels, columns=2)
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
        computed_by=tuple(dict.fromkeys(function_name(o.case.compute) for o in outcomes)),
    )


def _causes(
    axes: Axes, rows: Array, outcomes: Sequence[Outcome], causes: Mapping[str, str]
) -> list[Patch | Line2D]:
    """Stacked bars; `causes` by the text of their entry in the legend."""
    # Positive parts to the right of zero, negative ones to its left.
    right, left = np.zeros(len(rows)), np.zeros(len(rows))
    handles: list[Patch | Line2D] = []
    looks = cycle(_LOOKS)
    for cause, label in causes.items():
        colour, hatch = next(looks)
        amounts = np.array([_amount(outcome, cause) for outcome in outcomes])
        start = np.where(amounts >= 0.0, right, left)
        axes.barh(
            rows, amounts, left=start, height=0.62, color=colour, hatch=hatch, edgecolor="white"
        )
        right, left = right + np.maximum(amounts, 0.0), left + np.minimum(amounts, 0.0)
        handles.append(Patch(facecolor=colour, hatch=hatch, edgecolor="white", label=label))
    unexplained = np.array([_percent(_measured(o), _measured(o).unexplained) for o in outcomes])
    axes.barh(
        rows,
        unexplained,
        left=np.where(unexplained >= 0.0, right, left),
        height=0.62,
        color=VERMILLION,
    )
    handles.append(Patch(facecolor=VERMILLION, label=_UNEXPLAINED))
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
    handles.append(Line2D([], [], linestyle="", marker="D", color="black", label=_MEASURED))
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
        Line2D([], [], color="black", marker="|", label=_UNCERTAINTY),
        Patch(facecolor=_BAND, label=_TOLERANCE),
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


def _names(outcomes: Sequence[Outcome]) -> list[str]:
    """A name for each row: its label or quantity, or its title where two rows share it."""
    names = [_name(outcome) for outcome in outcomes]
    return [
        outcome.case.title if names.count(name) > 1 else name
        for outcome, name in zip(outcomes, names, strict=True)
    ]


def _name(outcome: Outcome) -> str:
    return outcome.case.label or outcome.case.quantity


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
