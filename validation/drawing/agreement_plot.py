"""Plot of the differences of formulations from the solid of the same legs."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.figure import Figure

from validation.drawing.chart import percent
from validation.drawing.style import WIDTH, looks_of, plot_style

# % around zero in which the scale is linear; in, of a panel; share of a column that markers take.
_LINEAR, _HIGH, _SPREAD = 0.1, 2.2, 0.6
_GREY, _BAND = "#999999", "#009E73"


@dataclass(frozen=True)
class Difference:
    """A formulation and the solid in one quantity; all numbers in per cent of the solid's value."""

    quantity: str
    model: str
    whole: float
    unexplained: float
    half_width: float
    tolerance: float


def agreement_plot(panels: Mapping[str, Sequence[Difference]]) -> Figure:
    """One panel for each title: quantities side by side, a marker for each formulation."""
    models = list(dict.fromkeys(one.model for found in panels.values() for one in found))
    looks = looks_of(models)
    with plot_style():
        figure = Figure(figsize=(WIDTH, 0.5 + _HIGH * max(len(panels), 1)), layout="constrained")
        grid = figure.subplots(max(len(panels), 1), 1, squeeze=False)[:, 0]
        for axes, (title, found) in zip(grid, panels.items(), strict=False):
            quantities = list(dict.fromkeys(one.quantity for one in found))
            for place, quantity in enumerate(quantities):
                of_quantity = [one for one in found if one.quantity == quantity]
                tolerance = max(one.tolerance for one in of_quantity)
                axes.fill_between(
                    [place - 0.45, place + 0.45],
                    -tolerance,
                    tolerance,
                    color=_BAND,
                    alpha=0.12,
                    linewidth=0.0,
                    label="tolerance",
                )
            for rank, model in enumerate(models):
                of_model = [one for one in found if one.model == model]
                if not of_model:
                    continue
                offset = _SPREAD * ((rank + 0.5) / len(models) - 0.5)
                x = np.array([quantities.index(one.quantity) for one in of_model]) + offset
                whole = [one.whole for one in of_model]
                axes.plot(x, whole, "D", color=_GREY, markersize=3.0, label="whole difference")
                axes.errorbar(
                    x,
                    [one.unexplained for one in of_model],
                    [one.half_width for one in of_model],
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
