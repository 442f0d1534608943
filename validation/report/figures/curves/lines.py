"""A line per model, and how lines that coincide are drawn so that each stays visible.

A further model joins every figure by its entry in `STATIC_LINES` or `DYNAMIC_LINES`.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Generic, TypeVar

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure as Canvas

from lumped.arrays import Array
from lumped.errors import ComputationError
from validation.context import Preset
from validation.drawing.style import BLUE, MODELS, PURPLE, Look, marked
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions

ALPHA_LABEL = "relative leg length α"
PLACES = {"centre": "centre of the stroke", "left": "left end", "right": "right end"}
T = TypeVar("T")
POSTURES: Mapping[Preset, int] = {"quick": 21, "standard": 41, "fine": 81}


@dataclass(frozen=True)
class Line:
    """One model in a figure; `width` (pt) shrinks from the bottom of a stack to its top.

    `fill` is the colour inside its markers.
    """

    label: str
    model: ModelName
    look: Look
    options: ModelOptions = DEFAULT_OPTIONS
    width: float = 1.6
    fill: str = "white"


SIMPLIFIED = Line("simplified", "simplified", MODELS["simplified"])
VJM_GIVEN = Line("VJM, legs as given", "vjm", Look(BLUE, "o", "--"), fill=BLUE)
VJM_EQUIVALENT = Line(
    "VJM, equivalent legs", "vjm", MODELS["vjm"], ModelOptions(legs="equivalent"), width=3.6
)
SEGMENTS = Line("segments", "segments", MODELS["segments"], width=2.4)
SEGMENTS_PRINTED = Line(
    "segments, eq. (25) as printed",
    "segments",
    Look(PURPLE, "X", ":"),
    ModelOptions(release="printed"),
    fill=PURPLE,
)
BEAM = Line("beam FE", "beam", MODELS["beam"], width=1.2)

# From the bottom of the stack to its top.
STATIC_LINES = (SIMPLIFIED, VJM_GIVEN, VJM_EQUIVALENT, SEGMENTS, BEAM)
DYNAMIC_LINES = (SIMPLIFIED, SEGMENTS, BEAM)


@dataclass(frozen=True)
class Gathered(Generic[T]):
    """What each line's model computed; `notes` name the models that could not."""

    values: Mapping[Line, T]
    notes: tuple[str, ...] = ()


def gather(lines: Sequence[Line], compute: Callable[[Line], T]) -> Gathered[T]:
    """`compute(line)` of every line; a model that fails is left out with a note.

    Raises ComputationError where every model fails.
    """
    values, notes = {}, []
    for line in lines:
        try:
            values[line] = compute(line)
        except ComputationError as error:
            notes.append(f"Left out: {line.label} ({error}).")
    if not values:
        raise ComputationError(" ".join(notes))
    return Gathered(values, tuple(notes))


def draw_lines(axes: Axes, x: Array, curves: Mapping[Line, Array]) -> None:
    """Draw the curves in order, markers staggered, lines from wide below to thin above.

    Values that are not finite leave a gap; a curve without any is left out.
    """
    for rank, (line, values) in enumerate(curves.items()):
        if not np.any(np.isfinite(values)):
            continue
        axes.plot(
            x,
            values,
            label=line.label,
            linewidth=line.width,
            markerfacecolor=line.fill,
            markevery=marked(len(x), rank, len(curves)),
            **line.look.options(),
        )


def legend_above(picture: Canvas, columns: int = 0) -> None:
    """One legend for all axes above them, where it covers nothing; `columns` 0: all in a row."""
    found: dict[str, Any] = {}
    for axes in picture.axes:
        for handle, label in zip(*axes.get_legend_handles_labels(), strict=True):
            found.setdefault(label, handle)
    options: dict[str, Any] = {"handlelength": 3.2, "columnspacing": 1.6}
    picture.legend(
        list(found.values()),
        list(found),
        loc="outside upper left",
        ncols=columns or len(found),
        **options,
    )


def as_in_paper(*numbers: int) -> str:
    """The end of a title: the curves of this robot that the paper draws of its own."""
    figures = " and ".join(str(number) for number in numbers)
    return f"(as the paper's {'Fig.' if len(numbers) == 1 else 'Figs'} {figures})"


def from_zero(axes: Axes) -> None:
    """Let the y axis start at zero and leave room above the curves."""
    axes.set_ylim(0.0, 1.08 * axes.get_ylim()[1])


def plain_log(axes: Axes, low: float, high: float) -> None:
    """Logarithmic y axis from `low` to `high` with ticks 1, 2, 5 and plain numbers."""
    axes.set(yscale="log", ylim=(low, high))
    axes.yaxis.set_major_locator(mpl.ticker.LogLocator(10.0, subs=(1.0, 2.0, 5.0)))
    axes.yaxis.set_major_formatter(mpl.ticker.FuncFormatter(lambda value, _: f"{value:g}"))
    axes.yaxis.set_minor_locator(mpl.ticker.NullLocator())


def percent_scale(axes: Axes) -> None:
    """Linear within one percent, logarithmic beyond: curves that agree and such that do not."""
    axes.axhline(0.0, color="#999999", linewidth=0.8)
    drawn = np.concatenate([[0.0], *(np.asarray(line.get_ydata()) for line in axes.get_lines())])
    low, high = float(np.nanmin(drawn)), float(np.nanmax(drawn))
    axes.set_yscale("symlog", linthresh=1.0, linscale=0.6)
    ticks = [1.0, 10.0, 100.0, 1000.0]
    axes.set_yticks([0.0, *(sign * tick for tick in ticks for sign in (1.0, -1.0))])
    axes.yaxis.set_major_formatter(
        mpl.ticker.FuncFormatter(lambda value, _: f"{value:+g}" if value else "0")
    )
    axes.yaxis.set_minor_locator(mpl.ticker.NullLocator())
    # Nothing of note on one side of zero needs no room there.
    axes.set_ylim(1.6 * min(low, -1.0), 1.6 * max(high, 1.0))


def course(curve: Array) -> str:
    """What a curve does throughout: "rises", "falls", or without a fixed direction "goes"."""
    steps = np.diff(curve)
    if np.all(steps > 0.0):
        return "rises"
    return "falls" if np.all(steps < 0.0) else "goes"


def spread(curves: Sequence[Array]) -> float:
    """Largest difference between curves on the same points, relative to the largest value."""
    stacked = np.array(curves)
    return float(np.max(np.ptp(stacked, axis=0)) / np.max(np.abs(stacked)))


def accuracy(difference: float) -> str:
    """A relative difference in words: percent, or its power of ten below 0.01 %."""
    if difference >= 1e-4:
        return f"{100.0 * difference:.2g} %"
    if difference < 1e-8:
        return "less than 1e-8"
    return f"{difference:.0e}"
