"""What every model computes over the stroke and along the family, as the series of a chart.

Postures lie closer together towards the ends of the stroke.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from lumped.arrays import Array
from lumped.biglide import Biglide
from validation.context import Context, Preset
from validation.drawing.chart import Chart, Note, Panel, Series, lettered
from validation.drawing.scales import Scale
from validation.models.biglide import robot_compliance, robot_frequencies
from validation.models.options import ModelName, ModelOptions
from validation.report.figures.curves.lines import ALPHA_LABEL, PLACES, Gathered, Line, gather
from validation.studies.quantities import ALPHAS, FIGURE_POINTS, Deflections, deflections_of

T = TypeVar("T")
STROKE_LABEL = "x of B (m)"
FAMILY_SAID = "Legs α times as long, stroke and sections unchanged."
_POSTURES: Mapping[Preset, int] = {"quick": 21, "standard": 41, "fine": 81}


def over_the_stroke(
    context: Context, lines: Sequence[Line], compute: Callable[[Line, Array], T]
) -> tuple[Array, Gathered[T]]:
    """Postures x (m) of the preset, and what each line's model computes there."""
    x = stations(context.robot, _POSTURES[context.preset])
    return x, gather(lines, lambda line: compute(line, x))


def along_the_family(
    lines: Sequence[Line], compute: Callable[[Line, float], T]
) -> tuple[dict[str, Mapping[Line, T]], str]:
    """What each line's model computes along α, by point of the stroke, and notes on failures.

    `compute` gets the line and the point as a fraction of the stroke.
    """
    found: dict[str, Mapping[Line, T]] = {}
    notes: dict[str, None] = {}
    for point, fraction in FIGURE_POINTS.items():
        gathered = _at(lines, compute, fraction)
        found[point] = gathered.values
        notes |= dict.fromkeys(gathered.notes)
    return found, " ".join(notes)


def _at(lines: Sequence[Line], compute: Callable[[Line, float], T], fraction: float) -> Gathered[T]:
    return gather(lines, lambda line: compute(line, fraction))


def stroke_chart(
    x: Array, panels: Sequence[Panel], *, legend_columns: int = 0, high: float = 2.0
) -> Chart:
    """Panels over the postures x (m) of B, side by side."""
    table = {"x (m)": x.tolist()}
    return Chart(panels, STROKE_LABEL, len(panels), high, legend_columns, table)


def family_chart(panels: Sequence[Panel], high: float = 2.5) -> Chart:
    """Panels over α, a column for each point of the stroke, which the first row names."""
    columns = len(FIGURE_POINTS)
    rest = [replace(panel, title="") for panel in panels[columns:]]
    panels = [*lettered(panels[:columns]), *rest]
    return Chart(panels, ALPHA_LABEL, columns, high, abscissa={"alpha": ALPHAS})


def family_panel(
    point: str, series: Sequence[Series], y_label: str, scale: Scale, notes: Sequence[Note] = ()
) -> Panel:
    """A panel of curves over α at a point of the stroke; the leftmost names the axis."""
    first = point == next(iter(FIGURE_POINTS))
    label = y_label if first else ""
    return Panel(series, PLACES[point], label, scale, notes=notes, place=point)


def stations(robot: Biglide, count: int) -> Array:
    """`count` positions x of B (m) over the stroke, both ends included, cosine-spaced.

    Curves go like √(L² − x²) at the ends of the stroke, which is smooth in the angle.
    """
    first, last = robot.stroke
    angles = np.linspace(0.0, np.pi, count)
    x: Array = first + 0.5 * (last - first) * (1.0 - np.cos(angles))
    return np.clip(x, first, last)


def deflections_at(
    model: ModelName, robot: Biglide, x: Array, options: ModelOptions
) -> Deflections:
    """Deflections (µm) with B at each `x` (m)."""
    return deflections_of(
        np.array([robot_compliance(model, robot, float(value), options) for value in x])
    )


def frequencies_at(
    model: ModelName, robot: Biglide, x: Array, count: int, options: ModelOptions
) -> Array:
    """First `count` frequencies (Hz, len(x) × count) with B at each `x` (m)."""
    return np.array([robot_frequencies(model, robot, float(value), count, options) for value in x])
