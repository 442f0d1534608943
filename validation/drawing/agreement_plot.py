"""Plot of the differences between formulations and the solid of the same legs.

Input: differences in per cent, by panel. Output: a matplotlib figure.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from validation.drawing.chart import percent
from validation.drawing.style import WIDTH, looks_of, plot_style

# Range around zero (%) in which the scale is linear; height of a panel (inches); fraction of a
# column's width over which markers are spread.
_LINEAR, _PANEL_HEIGHT, _SPREAD = 0.1, 2.2, 0.6
_GREY, _BAND = "#999999", "#009E73"


@dataclass(frozen=True)
class Difference:
    """Difference of a formulation from the solid in one quantity, in % of the solid's value.

    `whole`: total difference. `unexplained`: total difference without the effects of named causes,
    which are computed separately. `half_width`: half-width of the uncertainty of `unexplained`.
    `tolerance`: largest accepted magnitude of `unexplained`.
    """

    quantity: str
    model: str
    whole: float
    unexplained: float
    half_width: float
    tolerance: float


def agreement_plot(panels: Mapping[str, Sequence[Difference]]) -> Figure:
    """Plot of differences: one panel for each title, one column for each quantity.

    Each model has a marker, with an error bar at its unexplained difference. Diamonds are total
    differences. Bands are the tolerances.
    """
    models = list(
        dict.fromkeys(difference.model for panel in panels.values() for difference in panel)
    )
    looks = looks_of(models)
    height = 0.5 + _PANEL_HEIGHT * max(len(panels), 1)
    with plot_style():
        figure = Figure(figsize=(WIDTH, height), layout="constrained")
        grid = figure.subplots(max(len(panels), 1), 1, squeeze=False)[:, 0]
        for axes, (title, differences) in zip(grid, panels.items(), strict=False):
            quantities = list(dict.fromkeys(difference.quantity for difference in differences))
            for column, quantity in enumerate(quantities):
                tolerance = max(
                    difference.tolerance
                    for difference in differences
                    if difference.quantity == quantity
                )
                axes.fill_between(
                    [column - 0.45, column + 0.45],
                    -tolerance,
                    tolerance,
                    color=_BAND,
                    alpha=0.12,
                    linewidth=0.0,
                    label="tolerance",
                )
            for rank, model in enumerate(models):
                of_model = [difference for difference in differences if difference.model == model]
                if not of_model:
                    continue
                offset = _SPREAD * ((rank + 0.5) / len(models) - 0.5)
                x = (
                    np.array([quantities.index(difference.quantity) for difference in of_model])
                    + offset
                )
                whole_differences = [difference.whole for difference in of_model]
                axes.plot(
                    x, whole_differences, "D", color=_GREY, markersize=3.0, label="total difference"
                )
                axes.errorbar(
                    x,
                    [difference.unexplained for difference in of_model],
                    [difference.half_width for difference in of_model],
                    fmt=looks[model].marker,
                    color=looks[model].colour,
                    capsize=2.5,
                    label=f"{model}, unexplained",
                )
            percent(axes, limit=_LINEAR)
            axes.set_xticks(range(len(quantities)), quantities)
            axes.set_xlim(-0.5, len(quantities) - 0.5)
            axes.set_ylabel("difference from\nthe solid (%)")
            axes.set_title(title)
            axes.grid(visible=False, axis="x")
        handles = {
            label: handle
            for axes in grid
            for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)
        }
        figure.legend(
            list(handles.values()),
            list(handles),
            loc="outside upper left",
            ncols=min(len(handles), 3),
        )
    return figure
