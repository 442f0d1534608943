"""Curves of several models over the stroke and along the family: gathered, drawn and tabulated."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from matplotlib.axes import Axes

from lumped.arrays import Array
from validation.context import Context
from validation.drawing.style import canvas, csv_of, plot_style, svg_of
from validation.report.figures.curves.lines import (
    ALPHA_LABEL,
    PLACES,
    POSTURES,
    Gathered,
    Line,
    draw_lines,
    from_zero,
    gather,
    legend_above,
    percent_scale,
)
from validation.report.figures.curves.sweeps import stations
from validation.studies.quantities import ALPHAS, FIGURE_POINTS

T = TypeVar("T")
Stack = Mapping[Line, Array]
Columns = Mapping[str, Sequence[float]]
STROKE_LABEL = "x of B (m)"
_LETTERS = "abc"
_BELOW = 1.7  # in, of a row of differences


@dataclass(frozen=True)
class Panel:
    """One pair of axes; each of its `stacks` has a curve of every model (one stack a mode, say)."""

    title: str
    stacks: Sequence[Stack]
    y_label: str = ""


def over_the_stroke(
    context: Context, lines: Sequence[Line], compute: Callable[[Line, Array], T]
) -> tuple[Array, Gathered[T]]:
    """Postures x (m) of the preset, and what each line's model computes there."""
    x = stations(context.robot, POSTURES[context.preset])
    return x, gather(lines, lambda line: compute(line, x))


def along_the_family(
    lines: Sequence[Line], compute: Callable[[Line, float], T]
) -> tuple[dict[str, Mapping[Line, T]], tuple[str, ...]]:
    """What each line's model computes along α, by point of the stroke, and notes on failures.

    `compute` gets the line and the point as a fraction of the stroke.
    """
    found: dict[str, Mapping[Line, T]] = {}
    notes: dict[str, None] = {}
    for point, fraction in FIGURE_POINTS.items():
        gathered = _at(lines, compute, fraction)
        found[point] = gathered.values
        notes |= dict.fromkeys(gathered.notes)
    return found, tuple(notes)


def _at(lines: Sequence[Line], compute: Callable[[Line, float], T], fraction: float) -> Gathered[T]:
    return gather(lines, lambda line: compute(line, fraction))


def panels_svg(
    x: Array,
    x_label: str,
    panels: Sequence[Panel],
    finish: Callable[[Sequence[Axes]], None],
    *,
    columns: int,
    height: float = 3.3,
    legend_columns: int = 0,
    against: Line | None = None,
) -> str:
    """The panels row by row as SVG, titled in the first row; `finish` sets scales and notes.

    With `against`, the panels of one row have below them what every other line differs from that
    one, in percent.
    """
    below = [_differences(panel, against) for panel in panels] if against else []
    shown = [*panels, *below]
    with plot_style():
        picture, drawn = canvas(
            rows=len(shown) // columns, columns=columns, height=height + (_BELOW if below else 0.0)
        )
        for place, (axes, panel) in enumerate(zip(drawn, shown, strict=True)):
            for stack in panel.stacks:
                draw_lines(axes, x, stack)
            axes.set_ylabel(panel.y_label)
            if place < columns and panel.title:
                axes.set_title(f"({_LETTERS[place]}) {panel.title}")
            if place >= len(shown) - columns:
                axes.set_xlabel(x_label)
        finish(drawn[: len(panels)])
        for axes in drawn[len(panels) :]:
            percent_scale(axes)
        legend_above(picture, legend_columns)
        return svg_of(picture)


def _differences(panel: Panel, against: Line) -> Panel:
    """The same panel in percent of one of its lines; nothing where that line has nothing."""
    label = f"difference from\n{against.label} (%)" if panel.y_label else ""
    return Panel("", [_relative(stack, against) for stack in panel.stacks], label)


def _relative(stack: Stack, against: Line) -> Stack:
    reference = stack.get(against)
    if reference is None:
        return {}
    known = np.where(np.isfinite(reference) & (reference != 0.0), reference, np.nan)
    return {
        line: 100.0 * (values / known - 1.0) for line, values in stack.items() if line != against
    }


def family_panels(
    found: Mapping[str, Mapping[Line, T]],
    stacks: Callable[[Mapping[Line, T]], Sequence[Stack]],
    y_label: str,
) -> list[Panel]:
    """A panel for each point of the stroke, the first one with the label of the axis."""
    return [
        Panel(PLACES[point], stacks(gathered), "" if place else y_label)
        for place, (point, gathered) in enumerate(found.items())
    ]


def family_svg(
    panels: Sequence[Panel], finish: Callable[[Sequence[Axes]], None], height: float = 3.3
) -> str:
    """Panels over α, a column for each point of the stroke."""
    alphas = np.array(ALPHAS)
    columns = len(FIGURE_POINTS)
    return panels_svg(alphas, ALPHA_LABEL, panels, finish, columns=columns, height=height)


def all_from_zero(panels: Sequence[Axes]) -> None:
    """Let every panel start at zero, each with its own height."""
    for axes in panels:
        from_zero(axes)


def common_top(panels: Sequence[Axes]) -> None:
    """Let all panels go from zero to the same height."""
    top = max(axes.get_ylim()[1] for axes in panels)
    for axes in panels:
        axes.set_ylim(0.0, 1.1 * top)


def stroke_table(x: Array, columns: Columns) -> str:
    """Curves over the stroke as CSV."""
    return csv_of({"x (m)": x.tolist(), **columns})


def family_table(by_point: Mapping[str, Columns]) -> str:
    """Curves along the family as CSV, those of each point of the stroke under its name."""
    named = {
        f"{point}: {heading}": column
        for point, columns in by_point.items()
        for heading, column in columns.items()
    }
    return csv_of({"alpha": ALPHAS, **named})
