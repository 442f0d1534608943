"""What the figures of the paper's room are made of: a line for each model, and their axes."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from lumped.arrays import Array
from validation.drawing.charts.chart import Chart, Note, Panel, Series, lettered
from validation.drawing.charts.scales import Scale, plain_log
from validation.models.options import DEFAULT_OPTIONS, ModelName, ModelOptions
from validation.paper.robot import ALPHAS, FIGURE_POINTS

_PLACES = {"centre": "centre of the stroke", "left": "left end", "right": "right end"}


@dataclass(frozen=True)
class Line:
    """One model in a figure."""

    label: str
    model: ModelName
    options: ModelOptions = DEFAULT_OPTIONS


SIMPLIFIED = Line("simplified", "simplified")
GIVEN = Line("VJM, legs as given", "vjm")
EQUIVALENT = Line("VJM, equivalent legs", "vjm", ModelOptions(legs="equivalent"))
SEGMENTS = Line("segments", "segments")
PRINTED = Line("segments, eq. (25) as printed", "segments", ModelOptions(release="printed"))
BEAM = Line("beam FE", "beam")
ONE_FORMULATION = (EQUIVALENT, SEGMENTS, BEAM)
DYNAMIC = (SIMPLIFIED, SEGMENTS, BEAM)


def cosine_spaced(first: float, last: float, count: int) -> Array:
    """`count` positions x of B (m) over the stroke, both ends included, cosine-spaced.

    Curves go like √(L² − x²) at the ends of the stroke, which is smooth in the angle.
    """
    angles = np.linspace(0.0, np.pi, count)
    return np.clip(first + 0.5 * (last - first) * (1.0 - np.cos(angles)), first, last)


def stroke_chart(x: Array, panels: Sequence[Panel], *, high: float = 2.0) -> Chart:
    """Panels over the postures x (m) of B, side by side."""
    return Chart(panels, "x of B (m)", len(panels), high, {"x (m)": x.tolist()})


def family_chart(panels: Sequence[Panel], high: float = 2.5) -> Chart:
    """Panels over α, a column for each point of the stroke, which the first row names."""
    columns = len(FIGURE_POINTS)
    rest = [replace(panel, title="") for panel in panels[columns:]]
    shown = [*lettered(panels[:columns]), *rest]
    return Chart(shown, "relative leg length α", columns, high, {"alpha": ALPHAS})


def family_panel(
    point: str, series: Sequence[Series], y_label: str, scale: Scale, notes: Sequence[Note] = ()
) -> Panel:
    """A panel of curves over α at a point of the stroke; the leftmost names the axis."""
    label = y_label if point == next(iter(FIGURE_POINTS)) else ""
    return Panel(series, _PLACES[point], label, scale, notes=notes, place=point)


def hertz(series: Sequence[Series]) -> Scale:
    """Logarithmic frequencies around the curves."""
    low = 0.8 * min(float(one.y.min()) for one in series)
    return partial(plain_log, low=low, high=1.25 * max(float(one.y.max()) for one in series))


def spread(curves_of_one: Sequence[Array]) -> float:
    """Largest difference between curves on the same points, relative to the largest value."""
    stacked = np.array(curves_of_one)
    return float(np.max(np.ptp(stacked, axis=0)) / np.max(np.abs(stacked)))
